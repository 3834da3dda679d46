//! Whether walls make sense as drawn: each with one wet side, and the water on it.

use crate::Error;
use crate::error::place;
use crate::parameters::Geometry;
use crate::setup::fill::signed_area;
use crate::setup::outline::{crossing, overlap};
use crate::walls::sides::{SLACK, is_closed, placed_walls};
use crate::walls::{FIXED, Segment, Walls};
use digits::six;
use nalgebra::Vector2;

/// Smallest angle between two pieces of a wall in degrees: less is a wall that turns back on itself.
const LEAST_ANGLE: f64 = 1.0;
/// Distance in spacings within which two walls run along each other.
const DOUBLED: f64 = 1e-3;
/// Places in the water from which walls are looked at, and the lines of sight that are followed for them.
const MOST_VIEWS: usize = 64;
const MOST_SIGHTS: usize = 30_000_000;
/// Shares of a piece of wall at which one looks.
const TARGETS: [f64; 3] = [0.2, 0.5, 0.8];

/// A wall and what it is called.
struct Named {
    name: String,
    points: Vec<Vector2<f64>>,
}

type Piece = [Vector2<f64>; 2];

impl Named {
    fn pieces(&self) -> impl Iterator<Item = Piece> + Clone {
        self.points.windows(2).map(|pair| [pair[0], pair[1]])
    }

    /// A closed wall with the water around it.
    fn is_solid(&self) -> bool {
        is_closed(&self.points) && signed_area(&self.points) < 0.0
    }
}

fn refuse(what: String, got: String, expected: &str) -> Error {
    Error::Geometry { what, got, expected: expected.to_string() }
}

/// Refuses walls that turn back on themselves, cross themselves, run along another without anything between them, or
/// meet another that has the water on its other side.
pub fn are_consistent(geometry: &Geometry, spacing: f64) -> Result<(), Error> {
    let name = |what: &str, number: usize| format!("{what} {number}");
    let fixed = geometry.fixed_walls.iter().cloned().enumerate();
    let fixed = fixed.map(|(number, points)| Named { name: name("fixed wall", number), points }).collect();
    let body = placed_walls(geometry).into_iter().enumerate();
    let body = body.map(|(number, points)| Named { name: name("the structure's wall", number), points }).collect();
    for family in [fixed, body] {
        let family: Vec<Named> = family;
        family.iter().try_for_each(turns_back)?;
        family.iter().try_for_each(|wall| crosses_itself(wall, spacing))?;
        have_thickness(&family, spacing)?;
        agree_where_they_meet(&family, spacing)?;
    }
    Ok(())
}

/// Refuses corners so sharp that the wall is walked back along itself.
fn turns_back(wall: &Named) -> Result<(), Error> {
    let corner = |before: &Piece, after: &Piece| {
        let (back, away) = (before[0] - before[1], after[1] - after[0]);
        let angle = back.perp(&away).abs().atan2(back.dot(&away)).to_degrees();
        (angle, before[1])
    };
    let pieces: Vec<Piece> = wall.pieces().collect();
    let closing = pieces.last().zip(pieces.first()).filter(|_| is_closed(&wall.points));
    let joints = pieces.windows(2).map(|pair| (&pair[0], &pair[1])).chain(closing);
    match joints.map(|(before, after)| corner(before, after)).find(|(angle, _)| *angle < LEAST_ANGLE) {
        None => Ok(()),
        Some((angle, corner)) => Err(refuse(
            format!("{} turns back on itself at {}", wall.name, place(&corner)),
            format!("a corner of {} degrees", six(angle)),
            "corners of at least 1 degree: a wall has water on its left only; draw a plate as a closed wall with a thickness",
        )),
    }
}

fn crosses_itself(wall: &Named, spacing: f64) -> Result<(), Error> {
    let pieces: Vec<Piece> = wall.pieces().collect();
    for (k, one) in pieces.iter().enumerate() {
        let found = pieces[k + 1..].iter().find_map(|other| crossing(one, other, SLACK * spacing));
        if let Some(found) = found {
            return Err(refuse(
                format!("{} crosses itself at {}", wall.name, place(&found)),
                "a wall with the water on both sides".to_string(),
                "a wall whose pieces meet at their ends only; change the order of its points, or draw two walls",
            ));
        }
    }
    Ok(())
}

/// Refuses walls back to back with no solid between them. Two coincident pieces are right where one of them is a side
/// of a closed solid and the other is not: a block on the floor.
fn have_thickness(walls: &[Named], spacing: f64) -> Result<(), Error> {
    for (k, one) in walls.iter().enumerate() {
        for (l, other) in walls.iter().enumerate().skip(k) {
            if k != l && (one.is_solid() || other.is_solid()) {
                continue;
            }
            for (m, a) in one.pieces().enumerate() {
                let rest = other.pieces().skip(if k == l { m + 1 } else { 0 });
                let doubled = |b: &Piece| Some((overlap(&a, &[b[1], b[0]], DOUBLED * spacing)?, *b));
                if let Some(([from, to], b)) = rest.clone().find_map(|b| doubled(&b)) {
                    let at = |share: f64| place(&(a[0] + (a[1] - a[0]) * share));
                    let walls = if k == l { one.name.clone() } else { format!("{} and {}", one.name, other.name) };
                    return Err(refuse(
                        format!("{walls}: back to back from {} to {}", at(from), at(to)),
                        format!("nothing between them, the other way there from {} to {}", place(&b[0]), place(&b[1])),
                        "walls with a thickness; draw a plate as a closed wall, walked clockwise",
                    ));
                }
            }
        }
    }
    Ok(())
}

/// Refuses two walls of which one begins where the other begins, or ends where it ends: one of them has the water on
/// its other side. Where more than two walls meet they may do so.
fn agree_where_they_meet(walls: &[Named], spacing: f64) -> Result<(), Error> {
    let open = walls.iter().filter(|wall| !is_closed(&wall.points));
    let both = |wall: &'_ Named| Some([(*wall.points.first()?, false), (*wall.points.last()?, true)]);
    let ends: Vec<_> =
        open.filter_map(|wall| Some(both(wall)?.map(|(place, last)| (wall, place, last)))).flatten().collect();
    for (k, (wall, joint, last)) in ends.iter().enumerate() {
        let here = |(_, other, _): &&(&Named, Vector2<f64>, bool)| (other - joint).norm() < SLACK * spacing;
        let mut others = ends.iter().enumerate().filter(|(l, end)| *l != k && here(end)).map(|(_, end)| end);
        if let (Some((other, _, other_last)), None) = (others.next(), others.next())
            && last == other_last
        {
            let verb = if *last { "end" } else { "begin" };
            return Err(refuse(
                format!("{} and {} both {verb} at {}", wall.name, other.name, place(joint)),
                "the water on different sides of them".to_string(),
                "walls with the water on the left when walked along; reverse the points of one of them",
            ));
        }
    }
    Ok(())
}

/// Refuses walls that water sees from behind, as far as straight lines between walls tell. Faces of a beam, which may
/// stand open at their ends, are not asked.
pub fn are_seen_from_the_front(walls: &Walls, water: &[Vector2<f64>], spacing: f64) -> Result<(), Error> {
    let count = walls.segments.len();
    let views = (MOST_SIGHTS / (TARGETS.len() * count * count).max(1)).clamp(4, MOST_VIEWS);
    let stride = water.len().div_ceil(views).max(1);
    let views: Vec<_> = water.iter().skip(stride / 2).step_by(stride).collect();
    for (index, segment) in walls.segments.iter().enumerate() {
        if walls.chains[segment.chain as usize].depth.is_finite() {
            continue;
        }
        for target in TARGETS.map(|share| segment.start + segment.tangent * (share * segment.length)) {
            let mut seen = views.iter().filter(|view| sees_back(walls, index, view, &target, spacing));
            // A single line of sight may slip through the joint of two walls.
            if let (Some(view), Some(_)) = (seen.next(), seen.next()) {
                return Err(seen_from_behind(segment, view, &target));
            }
        }
    }
    Ok(())
}

fn sees_back(walls: &Walls, index: usize, view: &Vector2<f64>, target: &Vector2<f64>, spacing: f64) -> bool {
    let hides = |(k, other): (usize, &Segment)| k != index && other.is_crossed(view, target);
    walls.segments[index].local(view).0 < -SLACK * spacing && !walls.segments.iter().enumerate().any(hides)
}

fn seen_from_behind(segment: &Segment, view: &Vector2<f64>, target: &Vector2<f64>) -> Error {
    let whose = if segment.panel == FIXED { "a fixed wall" } else { "the structure's wall" };
    refuse(
        format!("{whose} from {} to {}", place(&segment.start), place(&segment.end())),
        format!("water at {} that sees its solid side at {}", place(view), place(target)),
        "walls with the water on the left when walked along; reverse the order of its points, or close the gap in front \
         of it",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(walls: &[&[(f64, f64)]]) -> Result<(), String> {
        let points = |wall: &&[(f64, f64)]| wall.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
        let geometry = Geometry { fixed_walls: walls.iter().map(points).collect(), ..Geometry::default() };
        are_consistent(&geometry, 0.02).map_err(|error| error.to_string())
    }

    fn refused(walls: &[&[(f64, f64)]], words: &[&str]) {
        let message = checked(walls).unwrap_err();
        assert!(words.iter().all(|word| message.contains(word)), "{message}: expected {words:?}");
    }

    const TANK: &[(f64, f64)] = &[(0.0, 0.8), (0.0, 0.0), (1.0, 0.0), (1.0, 0.8)];

    #[test]
    fn walls_without_thickness_are_refused() {
        let back = [(0.0, 0.8), (0.0, 0.0), (1.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.0, 0.8)];
        refused(
            &[&back],
            &["fixed wall 0 turns back on itself at (1, 0)", "0 degrees", "closed wall with a thickness"],
        );
        let divider = [(0.0, 0.8), (0.0, 0.0), (0.5, 0.0), (0.5, 0.6), (0.5, 0.0), (1.0, 0.0), (1.0, 0.8)];
        refused(&[&divider], &["turns back on itself at (0.5, 0.6)"]);
        refused(&[TANK, &[(0.5, 0.0), (0.5, 0.6), (0.5, 0.0)]], &["fixed wall 1 turns back", "(0.5, 0.6)"]);
        let faces: [&[(f64, f64)]; 3] = [TANK, &[(0.5, 0.0), (0.5, 0.6)], &[(0.5, 0.5), (0.5, 0.1)]];
        refused(&faces, &["fixed wall 1 and fixed wall 2: back to back from (0.5, 0.1) to (0.5, 0.5)", "thickness"]);
        // Two tanks with one wall between them.
        let left = [(0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0), (0.0, 0.0)];
        let right = [(0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0), (0.5, 0.0)];
        refused(&[&left, &right], &["back to back from (0.5, 0) to (0.5, 1)"]);
    }

    #[test]
    fn walls_that_cross_themselves_or_disagree_are_refused() {
        let itself = [(0.0, 0.8), (0.0, 0.0), (1.0, 0.0), (1.0, 0.8), (0.5, -0.3)];
        // The last piece falls by 1.1 m over 0.5 m: it passes y = 0 at 1 - 0.8 / 1.1 * 0.5.
        refused(&[&itself], &["fixed wall 0 crosses itself at (0.63636", ", 0)", "order of its points"]);
        let apart: [&[(f64, f64)]; 3] =
            [&[(0.0, 0.8), (0.0, 0.0)], &[(0.0, 0.0), (1.0, 0.0)], &[(1.0, 0.8), (1.0, 0.0)]];
        refused(&apart, &["fixed wall 1 and fixed wall 2 both end at (1, 0)", "reverse the points"]);
        let begin: [&[(f64, f64)]; 2] = [&[(0.0, 0.0), (0.0, 0.8)], &[(0.0, 0.0), (1.0, 0.0)]];
        refused(&begin, &["both begin at (0, 0)"]);
    }

    /// A block on the floor, sunk into it, or of which only the faces over the floor are drawn; two blocks side by
    /// side; a spike of 5 degrees; walls drawn apart.
    #[test]
    fn walls_that_make_sense_are_accepted() {
        let block = |x: f64, low: f64| [(x, low), (x, 0.2), (x + 0.1, 0.2), (x + 0.1, low), (x, low)];
        for low in [0.0, -0.01, 0.03] {
            checked(&[TANK, &block(0.4, low)]).unwrap();
        }
        checked(&[TANK, &block(0.4, 0.0), &block(0.5, 0.0)]).unwrap();
        checked(&[TANK, &[(0.5, 0.0), (0.5, 0.1), (0.6, 0.1), (0.6, 0.0)]]).unwrap();
        let spike = [(0.0, 0.8), (0.0, 0.0), (0.5, 0.0), (0.515, 0.3), (0.541, 0.0), (1.0, 0.0), (1.0, 0.8)];
        checked(&[&spike]).unwrap();
        checked(&[&[(0.0, 0.8), (0.0, 0.0)], &[(0.0, 0.0), (1.0, 0.0)], &[(1.0, 0.0), (1.0, 0.8)]]).unwrap();
    }
}
