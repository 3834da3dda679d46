//! Filling polygons of water with particles.

use crate::Error;
use crate::setup::outline::{is_simple, winding};
use nalgebra::Vector2;

/// Particles at the start and the spacing that makes their cells add up to the area of the water.
pub struct Filling {
    /// Centres of the particles \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Particles of each body of water, in order.
    pub counts: Vec<usize>,
    /// Lattice cell of the largest body of water \[m\]: the particles start with exactly its number density.
    pub cell: Vector2<f64>,
    /// Side of a square of the mean cell area \[m\]; within a few per cent of the spacing asked for.
    pub effective_spacing: f64,
}

/// Whether a point lies in a closed polygon (even-odd rule).
pub fn contains(polygon: &[Vector2<f64>], point: &Vector2<f64>) -> bool {
    let mut inside = false;
    for (k, a) in polygon.iter().enumerate() {
        let b = &polygon[(k + 1) % polygon.len()];
        if (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// Area of a closed polygon \[m2\].
pub fn area(polygon: &[Vector2<f64>]) -> f64 {
    signed_area(polygon).abs()
}

/// Area of a closed polygon, negative when its corners run clockwise \[m2\].
pub fn signed_area(polygon: &[Vector2<f64>]) -> f64 {
    let twice: f64 = polygon.iter().enumerate().map(|(k, a)| a.perp(&polygon[(k + 1) % polygon.len()])).sum();
    0.5 * twice
}

/// Fills every polygon with a lattice that fits its bounding box: a box keeps exactly its volume and its outermost
/// particles stand half a spacing from its sides.
pub fn fill(water: &[Vec<Vector2<f64>>], spacing: f64) -> Result<Filling, Error> {
    let mut positions = Vec::new();
    let mut counts = Vec::new();
    let (mut total_area, mut largest, mut cell) = (0.0, 0.0, Vector2::zeros());
    for (number, polygon) in water.iter().enumerate() {
        is_simple(number, polygon, spacing)?;
        let sense = if signed_area(polygon) < 0.0 { -1 } else { 1 };
        let (low, high) = crate::grid::bounding_box(polygon);
        let size = high - low;
        let fits = |length: f64| (length / spacing).round();
        if fits(size.x) < 2.0 || fits(size.y) < 2.0 {
            return Err(Error::Geometry {
                what: format!("water {number} is too small for the particle spacing"),
                got: format!("{} x {} m with spacing {spacing} m", size.x, size.y),
                expected: "at least 2 spacings in each direction; reduce fluid.spacing".to_string(),
            });
        }
        let step = Vector2::new(size.x / fits(size.x), size.y / fits(size.y));
        for row in 0..fits(size.y) as usize {
            for column in 0..fits(size.x) as usize {
                let point = low + Vector2::new((column as f64 + 0.5) * step.x, (row as f64 + 0.5) * step.y);
                if is_water(winding(polygon, &point) * sense, number, &point)? {
                    positions.push(point);
                }
            }
        }
        counts.push(positions.len() - counts.iter().sum::<usize>());
        total_area += area(polygon);
        if area(polygon) > largest {
            (largest, cell) = (area(polygon), step);
        }
    }
    if positions.is_empty() {
        return Err(Error::Geometry {
            what: "water".to_string(),
            got: "no particle".to_string(),
            expected: "at least one polygon that encloses an area".to_string(),
        });
    }
    let effective_spacing = (total_area / positions.len() as f64).sqrt();
    let scale = effective_spacing / (cell.x * cell.y).sqrt();
    Ok(Filling { positions, counts, cell: cell * scale, effective_spacing })
}

/// Whether a point lies in a polygon of water that walks so many times around it, counted in the direction of its area.
/// Refuses one that walks around it twice, or the other way round: it crosses itself, if only at a corner.
fn is_water(turns: i32, number: usize, point: &Vector2<f64>) -> Result<bool, Error> {
    if turns == 0 || turns == 1 {
        return Ok(turns == 1);
    }
    Err(Error::Geometry {
        what: format!("water {number} crosses itself at a corner near {}", crate::error::place(point)),
        got: format!("a polygon that walks {turns} times around that place, counted in the direction of its area"),
        expected: "a polygon that walks once around its water; change the order of the corners, or split it in two"
            .to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::outline::tests::keyhole;

    #[test]
    fn box_keeps_its_area_and_stays_half_a_spacing_from_its_sides() {
        let corners = [(0.0, 0.0), (0.146, 0.0), (0.146, 0.292), (0.0, 0.292)];
        let polygon: Vec<_> = corners.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
        let filling = fill(std::slice::from_ref(&polygon), 0.004).unwrap();
        let covered = filling.positions.len() as f64 * filling.effective_spacing.powi(2);
        assert!((covered - 0.146 * 0.292).abs() < 1e-12);
        assert!((filling.effective_spacing - 0.004).abs() < 0.0001);
        assert!((filling.positions[0].x - 0.146 / 74.0).abs() < 1e-12, "37 columns fit: {}", filling.positions[0].x);
    }

    #[test]
    fn spacing_larger_than_the_column_is_refused_with_numbers() {
        let polygon: Vec<_> = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)].iter().map(|&(x, y)| Vector2::new(x, y)).collect();
        let message = fill(&[polygon], 0.2).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(message.contains("0.1 x 0.1") && message.contains("0.2"), "{message}");
    }

    /// Particles stand on both sides of the slit that joins a hole to the outside, and none in the hole.
    #[test]
    fn a_hole_joined_by_a_slit_stays_empty() {
        let polygon = keyhole();
        let filling = fill(std::slice::from_ref(&polygon), 0.05).unwrap();
        assert_eq!(filling.positions.len(), 384, "0.96 m2 in squares of 0.05 m");
        let in_hole = |place: &&Vector2<f64>| (place.x - 0.5).abs() < 0.1 && (place.y - 0.5).abs() < 0.1;
        assert_eq!(filling.positions.iter().find(in_hole), None);
        let mirrored: Vec<_> = polygon.iter().rev().copied().collect();
        assert_eq!(fill(&[mirrored], 0.05).unwrap().positions.len(), 384, "whatever the direction");
    }

    #[test]
    fn a_polygon_that_crosses_itself_is_refused_with_the_place() {
        let refused = |corners: &[(f64, f64)]| {
            let polygon: Vec<_> = corners.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
            fill(&[polygon], 0.05).err().map(|error| error.to_string()).unwrap_or_default()
        };
        let message = refused(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.8)]);
        assert!(message.contains("water 0 crosses itself at (0.4444"), "{message}");
        // The same with a corner where it crosses: the triangle on the right is walked clockwise.
        let message = refused(&[(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (1.0, 0.0), (0.5, 0.5), (0.0, 1.2)]);
        assert!(
            message.contains("water 0 crosses itself at a corner near (") && message.contains("-1 times"),
            "{message}"
        );
    }
}
