//! Gaps between a solid's corner and the wall that it points at, too narrow for a particle: they are closed.
//!
//! A gap narrower than a particle cannot be flown through, and if it is left open the cells beside it end there in a
//! free surface: without pressure, so that water beside it never comes to rest. Faces are therefore prolonged up to the
//! wall that they point at. Faces of a body carry their prolongation with them: what closes a gap at the start leaves it
//! open once the body has moved away.

use crate::walls::{SMOOTH, Segment, WallLayout, Walls};
use nalgebra::Vector2;

/// Width in spacings below which a gap is closed: half a spacing is where no neighbour can stand in it any more, the
/// rest is for the bodies' small motions.
pub const NARROW: f64 = 0.6;
/// Width in spacings up to which faces touch.
const TOUCHING: f64 = 1e-3;
/// Sine of the least angle between a face and the wall that it points at.
const STEEP: f64 = 0.3;

/// A face that is prolonged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedGap {
    /// Number of the segment, as [`Walls::place`] counts them.
    pub segment: usize,
    /// Whether it is prolonged at its end, not at its start.
    pub at_end: bool,
    /// Width of the gap along the face \[m\].
    pub width: f64,
    /// The corner \[m\].
    pub corner: Vector2<f64>,
}

/// Gaps narrower than [`NARROW`] spacings between the ends of faces and the walls in front of them, for the body as it
/// stands in the scene.
pub fn find(walls: &Walls, spacing: f64) -> Vec<ClosedGap> {
    let ends = walls.chains.iter().flat_map(|chain| [(chain.first, false), (chain.last - 1, true)]);
    ends.filter_map(|(segment, at_end)| {
        let face = &walls.segments[segment];
        let (corner, away) = if at_end { (face.end(), face.tangent) } else { (face.start, -face.tangent) };
        let width = gap(walls, segment, &corner, &away, spacing)?;
        Some(ClosedGap { segment, at_end, width, corner })
    })
    .collect()
}

/// Way from a face's end to the wall in front of it \[m\], when it is narrow and not yet closed.
fn gap(walls: &Walls, face: usize, corner: &Vector2<f64>, away: &Vector2<f64>, spacing: f64) -> Option<f64> {
    let others = walls.segments.iter().enumerate().filter(|(index, _)| *index != face).map(|(_, other)| other);
    let goes_on = |other: &Segment| {
        let near = (TOUCHING * spacing).powi(2);
        let starts = (other.start - corner).norm_squared() < near && other.tangent.dot(away) > SMOOTH;
        starts || (other.end() - corner).norm_squared() < near && -other.tangent.dot(away) > SMOOTH
    };
    if others.clone().any(goes_on) {
        return None;
    }
    let nearest = others.filter_map(|other| hit(other, corner, away, spacing)).fold(f64::INFINITY, f64::min);
    (TOUCHING * spacing..NARROW * spacing).contains(&nearest).then_some(nearest)
}

/// Way along `away` from a corner to the wet side of a wall \[m\].
fn hit(wall: &Segment, corner: &Vector2<f64>, away: &Vector2<f64>, spacing: f64) -> Option<f64> {
    let steepness = wall.normal.dot(away);
    if steepness < STEEP {
        return None;
    }
    let way = wall.local(corner).0 / steepness;
    let along = wall.local(&(corner + away * way)).1;
    let slack = TOUCHING * spacing;
    (way > -slack && (-slack..=wall.length + slack).contains(&along)).then_some(way)
}

/// Closes the gaps of a layout in which nothing is prolonged yet.
pub fn close(layout: &WallLayout, walls: &Walls, spacing: f64) -> (WallLayout, Vec<ClosedGap>) {
    let gaps = find(walls, spacing);
    let mut closed = layout.clone();
    for gap in &gaps {
        closed.prolong(gap.segment, gap.at_end, 1.0 + gap.width / walls.segments[gap.segment].length);
    }
    (closed, gaps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Geometry;

    const SPACING: f64 = 0.02;

    /// Gaps of walls given corner by corner, and the segments after they were closed.
    fn closed(walls: &[&[(f64, f64)]]) -> (Vec<ClosedGap>, Vec<Segment>) {
        let points = |wall: &&[(f64, f64)]| wall.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
        let geometry = Geometry { fixed_walls: walls.iter().map(points).collect(), ..Geometry::default() };
        let layout = WallLayout::new(&geometry, SPACING);
        let mut placed = Walls::default();
        placed.place(&layout, None, 2.0 * SPACING, SPACING);
        let (closed, gaps) = close(&layout, &placed, SPACING);
        placed.place(&closed, None, 2.0 * SPACING, SPACING);
        (gaps, placed.segments)
    }

    const TANK: &[(f64, f64)] = &[(0.0, 0.8), (0.0, 0.0), (1.0, 0.0), (1.0, 0.8)];

    #[test]
    fn a_block_just_over_the_floor_stands_on_it_and_one_a_spacing_above_does_not() {
        let block = |low: f64| [(0.4, low), (0.4, 0.2), (0.5, 0.2), (0.5, low), (0.4, low)];
        for low in [0.001, 0.005, 0.0119] {
            let (gaps, segments) = closed(&[TANK, &block(low)]);
            assert_eq!(gaps.len(), 2, "{gaps:?}");
            let face = |x: f64| segments.iter().find(|segment| segment.start.x == x && segment.end().x == x).unwrap();
            assert!(face(0.4).start.y.abs() < 1e-15 && (face(0.4).end().y - 0.2).abs() < 1e-15);
            assert!(face(0.5).end().y.abs() < 1e-15 && (face(0.5).start.y - 0.2).abs() < 1e-15);
        }
        for low in [0.0, 1e-6, 0.013, -0.01] {
            assert_eq!(closed(&[TANK, &block(low)]).0, [], "{low}");
        }
    }

    #[test]
    fn walls_drawn_apart_meet_and_smooth_joints_and_concave_corners_stay() {
        // A floor that ends 3 mm short of the wall beside it.
        let (gaps, segments) = closed(&[&[(0.0, 0.8), (0.0, 0.0), (0.997, 0.0)], &[(1.0, -0.1), (1.0, 0.8)]]);
        assert_eq!((gaps.len(), gaps[0].at_end), (1, true));
        assert!((segments[1].end() - Vector2::new(1.0, 0.0)).norm() < 1e-15);
        // The same floor in two walls; a loop that begins in the middle of a face.
        assert_eq!(closed(&[&[(0.0, 0.8), (0.0, 0.0), (0.5, 0.0)], &[(0.5, 0.0), (1.0, 0.0), (1.0, 0.8)]]).0, []);
        let block = [(0.4, 0.006), (0.4, 0.2), (0.5, 0.2), (0.5, 0.0), (0.4, 0.0), (0.4, 0.006)];
        assert_eq!(closed(&[TANK, &block]).0, []);
    }
}
