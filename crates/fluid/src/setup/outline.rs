//! Outlines of polygons of water: pieces that are walked there and back, and crossings.

use crate::Error;
use crate::error;
use crate::grid::bounding_box;
use nalgebra::Vector2;

/// Distance in spacings within which two edges run along each other.
const DOUBLED: f64 = 1e-3;
/// Distance, over the size of the polygon, by which edges that cross reach beyond each other.
const BEYOND: f64 = 1e-9;

type Line = Vec<Vector2<f64>>;

/// The outline of a polygon in lines, without the pieces that are walked there and back: the slit that joins a hole to
/// the outside is no edge of the water. A polygon without such pieces is one line that comes back to its first corner.
pub fn outline(polygon: &[Vector2<f64>], spacing: f64) -> Vec<Line> {
    let edges = edges(polygon);
    let mut lines: Vec<Line> = Vec::new();
    for (k, &[start, end]) in edges.iter().enumerate() {
        let mut open = lines.last().is_some_and(|line| line.last() == Some(&start));
        for [from, to] in kept(&edges, k, DOUBLED * spacing) {
            let place = |share: f64| if share == 1.0 { end } else { start + (end - start) * share };
            match lines.last_mut().filter(|_| open && from == 0.0) {
                Some(line) => line.push(place(to)),
                None => lines.push(vec![place(from), place(to)]),
            }
            open = false;
        }
    }
    if lines.len() > 1 && lines[0].first() == lines[lines.len() - 1].last() {
        let mut last = lines.pop().unwrap_or_default();
        last.extend(lines[0].iter().skip(1));
        lines[0] = last;
    }
    lines
}

/// The edges of a polygon that have a length.
fn edges(polygon: &[Vector2<f64>]) -> Vec<[Vector2<f64>; 2]> {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).filter(|(start, end)| start != end).map(|(start, end)| [*start, *end]).collect()
}

/// The parts of edge `k` that no other edge walks back along, as shares of its length from and to.
fn kept(edges: &[[Vector2<f64>; 2]], k: usize, slack: f64) -> Vec<[f64; 2]> {
    let others = edges.iter().enumerate().filter(|(other, _)| *other != k);
    let mut gone: Vec<_> = others.filter_map(|(_, other)| overlap(&edges[k], &[other[1], other[0]], slack)).collect();
    gone.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut kept, mut from) = (Vec::new(), 0.0);
    for [begin, end] in gone {
        if begin > from {
            kept.push([from, begin]);
        }
        from = end.max(from);
    }
    if from < 1.0 {
        kept.push([from, 1.0]);
    }
    kept
}

/// The part of an edge along which another one runs in the same direction, as shares of its length from and to.
pub fn overlap(edge: &[Vector2<f64>; 2], other: &[Vector2<f64>; 2], slack: f64) -> Option<[f64; 2]> {
    let side = edge[1] - edge[0];
    let length = side.norm();
    let along = side / length;
    let local = |point: &Vector2<f64>| (along.dot(&(point - edge[0])), along.perp(&(point - edge[0])));
    let ((begin, off_begin), (end, off_end)) = (local(&other[0]), local(&other[1]));
    if end - begin <= slack {
        return None;
    }
    let off = |place: f64| off_begin + (off_end - off_begin) * (place - begin) / (end - begin);
    let snap = |place: f64| match place {
        _ if place <= slack => 0.0,
        _ if place >= length - slack => length,
        _ => place,
    };
    let (from, to) = (snap(begin.max(0.0)), snap(end.min(length)));
    let doubled = to - from > slack && off(from).abs() <= slack && off(to).abs() <= slack;
    doubled.then(|| [from / length, if to == length { 1.0 } else { to / length }])
}

/// Where two pieces cross, each with both ends more than `slack` off the other; none where they only touch.
pub fn crossing(a: &[Vector2<f64>; 2], b: &[Vector2<f64>; 2], slack: f64) -> Option<Vector2<f64>> {
    let off = |line: &[Vector2<f64>; 2], point: &Vector2<f64>| {
        let side = line[1] - line[0];
        side.perp(&(point - line[0])) / side.norm()
    };
    let apart = |line: &[Vector2<f64>; 2], other: &[Vector2<f64>; 2]| {
        let (start, end) = (off(line, &other[0]), off(line, &other[1]));
        (start.min(end) < -slack && start.max(end) > slack).then_some(start / (start - end))
    };
    apart(b, a)?;
    apart(a, b).map(|share| b[0] + (b[1] - b[0]) * share)
}

/// Refuses a polygon of water that crosses itself, or walks a piece twice in the same direction.
pub fn is_simple(number: usize, polygon: &[Vector2<f64>], spacing: f64) -> Result<(), Error> {
    let edges = edges(polygon);
    let (low, high) = bounding_box(polygon);
    let slack = BEYOND * (high - low).max();
    let fail = |place: Vector2<f64>, a: &[Vector2<f64>; 2], b: &[Vector2<f64>; 2], what: &str| {
        let edge = |[start, end]: &[Vector2<f64>; 2]| format!("{} to {}", error::place(start), error::place(end));
        Err(Error::Geometry {
            what: format!("water {number} {what} at {}", error::place(&place)),
            got: format!("the edges {} and {}", edge(a), edge(b)),
            expected:
                "edges that meet at their ends only; change the order of the corners, or split the polygon in two"
                    .to_string(),
        })
    };
    for (k, a) in edges.iter().enumerate() {
        for b in &edges[k + 1..] {
            if let Some(place) = crossing(a, b, slack) {
                return fail(place, a, b, "crosses itself");
            }
            if let Some([from, _]) = overlap(a, b, DOUBLED * spacing) {
                return fail(a[0] + (a[1] - a[0]) * from, a, b, "walks twice in the same direction");
            }
        }
    }
    Ok(())
}

/// How often a closed polygon walks around a point, counter-clockwise counted positive.
pub fn winding(polygon: &[Vector2<f64>], point: &Vector2<f64>) -> i32 {
    let mut turns = 0;
    for (k, a) in polygon.iter().enumerate() {
        let b = &polygon[(k + 1) % polygon.len()];
        if (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            turns += if b.y > a.y { 1 } else { -1 };
        }
    }
    turns
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::setup::fill::signed_area;

    fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
        list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
    }

    /// A square with a square hole in it, and a slit from the hole to the middle of the upper edge.
    const KEYHOLE: [(f64, f64); 11] = [
        (0.0, 0.0),
        (1.0, 0.0),
        (1.0, 1.0),
        (0.5, 1.0),
        (0.5, 0.6),
        (0.6, 0.6),
        (0.6, 0.4),
        (0.4, 0.4),
        (0.4, 0.6),
        (0.5, 0.6),
        (0.5, 1.0),
    ];

    /// The same with its last corner.
    pub fn keyhole() -> Vec<Vector2<f64>> {
        points(&KEYHOLE).into_iter().chain([Vector2::new(0.0, 1.0)]).collect()
    }

    fn length(lines: &[Line]) -> f64 {
        lines.iter().flat_map(|line| line.windows(2)).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    #[test]
    fn a_slit_is_no_edge() {
        let lines = outline(&keyhole(), 0.05);
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!((length(&lines) - 4.8).abs() < 1e-12, "four sides of 1 and four of 0.2: {lines:?}");
        assert!(lines.iter().all(|line| line.first() == line.last()), "both close: {lines:?}");
        let area: f64 = lines.iter().map(|line| signed_area(line)).sum();
        assert!((area - 0.96).abs() < 1e-12, "{area}");
        is_simple(0, &keyhole(), 0.05).unwrap();
    }

    /// A slit whose sides have corners at different places, and one that is walked from a corner.
    #[test]
    fn slits_cancel_piece_by_piece() {
        let mut divided = keyhole();
        divided.insert(4, Vector2::new(0.5, 0.87));
        divided.insert(11, Vector2::new(0.5, 0.71));
        assert!((length(&outline(&divided, 0.05)) - 4.8).abs() < 1e-12, "{:?}", outline(&divided, 0.05));
        let start_in_slit: Vec<_> = divided[4..].iter().chain(&divided[..4]).copied().collect();
        assert!((length(&outline(&start_in_slit, 0.05)) - 4.8).abs() < 1e-12);
        // A spike out of the water, walked back: a unit square is left.
        let spike = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.7, 1.0), (0.7, 1.5), (0.7, 1.0), (0.0, 1.0)]);
        assert!((length(&outline(&spike, 0.05)) - 4.0).abs() < 1e-12, "{:?}", outline(&spike, 0.05));
        // The two halves of a square, joined along a part of an edge that the other walks back further.
        let over = points(&[
            (0.0, 0.0),
            (1.0, 0.0),
            (1.0, 1.0),
            (0.5, 1.0),
            (0.5, 0.2),
            (0.5, 1.2),
            (0.4, 1.2),
            (0.4, 1.0),
            (0.0, 1.0),
        ]);
        assert!((length(&outline(&over, 0.05)) - (1.0 + 1.0 + 0.5 + 0.2 + 0.1 + 0.2 + 0.4 + 1.0)).abs() < 1e-12);
    }

    #[test]
    fn an_ordinary_polygon_stays_as_it_is() {
        let polygon = points(&[(0.0, 0.0), (1.0, 0.1), (0.8, 0.9), (0.1, 0.7)]);
        let closed: Vec<_> = polygon.iter().chain(&polygon[..1]).copied().collect();
        assert_eq!(outline(&polygon, 0.05), std::slice::from_ref(&closed));
        assert_eq!(outline(&closed, 0.05), [closed], "a corner that is repeated at the end makes no edge");
    }

    #[test]
    fn crossings_are_refused_with_their_place() {
        let bow = points(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
        let message = is_simple(3, &bow, 0.05).unwrap_err().to_string();
        assert!(message.contains("water 3 crosses itself at (0.5, 0.5)"), "{message}");
        assert!(message.contains("(0, 0) to (1, 1)") && message.contains("order of the corners"), "{message}");
        let mut twice = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        twice.extend(twice.clone());
        let message = is_simple(0, &twice, 0.05).unwrap_err().to_string();
        assert!(message.contains("water 0 walks twice in the same direction at (0, 0)"), "{message}");
        // Corners that touch an edge or each other do not cross.
        let touching = points(&[(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)]);
        is_simple(0, &touching, 0.05).unwrap();
    }

    #[test]
    fn winding_counts_turns() {
        let bow = points(&[(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (1.0, 0.0), (0.5, 0.5), (0.0, 1.0)]);
        assert_eq!(winding(&bow, &Vector2::new(0.1, 0.5)), 1);
        assert_eq!(winding(&bow, &Vector2::new(0.9, 0.5)), -1);
        assert_eq!(winding(&bow, &Vector2::new(0.5, 0.9)), 0);
    }
}
