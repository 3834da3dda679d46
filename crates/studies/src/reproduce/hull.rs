//! The cabin's walls with openings in other places, and the cabin held: changes of the scene damaged_cabin.

/// Half the width, height of the keel and of the deck above the centre of gravity, and thickness of the walls \[m\]: as
/// in the scene damaged_cabin.
const HALF: f64 = 0.35;
const KEEL: f64 = -0.266792;
const DECK: f64 = 0.253208;
const WALL: f64 = 0.04;

/// Where the damage is, or how the cabin is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Variant {
    /// The opening in the left side, as in the scene.
    Side,
    /// The opening in the bottom of the same compartment.
    Bottom,
    /// Two openings of 0.08 m in the left side.
    TwoOpenings,
    /// The bulkhead 0.1 m nearer to the damaged side.
    BulkheadForward,
    /// The cabin held fixed.
    Fixed,
    /// Roll only.
    RollOnly,
}

/// A side of the cabin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The left wall; openings are counted from the keel up.
    Left,
    /// The bottom; openings are counted from the left side.
    Bottom,
}

/// An opening from `from` to `to` \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Where it is.
    pub side: Side,
    /// Beginning \[m\].
    pub from: f64,
    /// End \[m\].
    pub to: f64,
}

impl Variant {
    /// Changes of the scene as `key=value`.
    pub fn changes(self) -> Vec<String> {
        let opening = |side, from, to| Opening { side, from, to };
        match self {
            Self::Side => Vec::new(),
            Self::Bottom => vec![walls(&[opening(Side::Bottom, 0.115, 0.275)])],
            Self::TwoOpenings => vec![walls(&[opening(Side::Left, 0.06, 0.14), opening(Side::Left, 0.2, 0.28)])],
            Self::BulkheadForward => bulkhead_at(-0.1),
            Self::Fixed => vec!["body.cabin.free=[]".to_string()],
            Self::RollOnly => vec!["body.cabin.free=[\"theta\"]".to_string()],
        }
    }
}

/// The bulkhead at `x` from mid-width, with its stations and compartments.
fn bulkhead_at(x: f64) -> Vec<String> {
    let face = 0.5 * 0.01796;
    let (middle, low, high) = (2.0 + x, 0.4938, 0.9338);
    let stations = |index: usize, at: f64| {
        [
            format!("fluid.probe.{index}.from=[{at}, {}]", low + 0.005),
            format!("fluid.probe.{index}.to=[{at}, {}]", high - 0.005),
        ]
    };
    let region = |index: usize, left: f64, right: f64| {
        format!("fluid.region.{index}.polygon=[[{left}, {low}], [{right}, {low}], [{right}, {high}], [{left}, {high}]]")
    };
    let mut changes = vec![format!("body.cabin.member.bulkhead.middle=[{x}, -0.006792]")];
    changes.extend(stations(2, middle - face));
    changes.extend(stations(3, middle + face));
    changes.extend([region(0, 1.69, middle), region(1, middle, 2.31)]);
    changes
}

/// The walls with these openings, each as one closed piece of solid between two openings, as a change of the scene.
pub fn walls(openings: &[Opening]) -> String {
    let lines: Vec<String> = pieces(openings).iter().map(|piece| wall(piece)).collect();
    format!("body.cabin.wall=[{}]", lines.join(", "))
}

fn wall(points: &[[f64; 2]]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("[{x:.6}, {y:.6}]")).collect();
    format!("{{ points = [{}], closed = true }}", points.join(", "))
}

/// Outlines of the solid between openings, which are sorted along the outside from the deck's left corner down the left
/// side and along the bottom; water is on the left when walked along.
fn pieces(openings: &[Opening]) -> Vec<Vec<[f64; 2]>> {
    let mut cuts: Vec<[f64; 2]> = openings.iter().map(cut).collect();
    cuts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let total = perimeter();
    let pairs = cuts.iter().enumerate().map(|(k, cut)| {
        let next = cuts.get(k + 1).map_or(cuts[0][0] + total, |next| next[0]);
        (cut[1], next)
    });
    pairs.map(|(from, to)| piece(from, to)).collect()
}

/// Corners of the outside from the deck's left corner down the left side and round, and of the inside beside them.
fn corners() -> [[[f64; 2]; 2]; 4] {
    let (left, right) = (-HALF, HALF);
    [
        [[left, DECK], [left + WALL, DECK - WALL]],
        [[left, KEEL], [left + WALL, KEEL + WALL]],
        [[right, KEEL], [right - WALL, KEEL + WALL]],
        [[right, DECK], [right - WALL, DECK - WALL]],
    ]
}

fn perimeter() -> f64 {
    2.0 * (2.0 * HALF + DECK - KEEL)
}

/// Beginning and end of an opening along the outside.
fn cut(opening: &Opening) -> [f64; 2] {
    let height = DECK - KEEL;
    match opening.side {
        Side::Left => [height - opening.to, height - opening.from],
        Side::Bottom => [height + opening.from, height + opening.to],
    }
}

/// Place on the outside at `along` it, and beside it on the inside.
fn at(along: f64) -> [[f64; 2]; 2] {
    let (height, width) = (DECK - KEEL, 2.0 * HALF);
    let along = along % perimeter();
    if along < height {
        [[-HALF, DECK - along], [-HALF + WALL, DECK - along]]
    } else if along < height + width {
        let x = -HALF + along - height;
        [[x, KEEL], [x, KEEL + WALL]]
    } else {
        [[HALF, KEEL], [HALF - WALL, KEEL + WALL]]
    }
}

/// The solid from `from` to `to` along the outside: back along the outside, then forth along the inside.
fn piece(from: f64, to: f64) -> Vec<[f64; 2]> {
    let (height, width) = (DECK - KEEL, 2.0 * HALF);
    let places = [0.0, height, height + width, 2.0 * height + width];
    let turns = (0..8).map(|k| (places[k % 4] + (k / 4) as f64 * perimeter(), corners()[k % 4]));
    let between: Vec<[[f64; 2]; 2]> =
        turns.filter(|(along, _)| (from..to).contains(along)).map(|(_, corner)| corner).collect();
    let all: Vec<[[f64; 2]; 2]> = std::iter::once(at(from)).chain(between).chain(std::iter::once(at(to))).collect();
    all.iter().rev().map(|pair| pair[0]).chain(all.iter().map(|pair| pair[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[[f64; 2]]) -> f64 {
        let next = points.iter().cycle().skip(1);
        0.5 * points.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    }

    #[test]
    fn the_opening_of_the_scene_gives_its_walls() {
        let opening = Opening { side: Side::Left, from: 0.09, to: 0.25 };
        let piece = &pieces(&[opening])[0];
        // The same twelve corners as in the scene, from another first one, with the water outside on the left.
        assert_eq!(piece.len(), 12);
        let has = |x: f64, y: f64| piece.iter().any(|it| (it[0] - x).abs() < 1e-9 && (it[1] - y).abs() < 1e-9);
        assert!(has(-0.35, -0.016792) && has(-0.31, -0.176792) && has(0.31, 0.213208) && has(0.35, -0.266792));
        let solid = 0.70 * 0.52 - 0.62 * 0.44 - 0.16 * 0.04;
        assert!((area(piece) + solid).abs() < 1e-9, "{} against {solid}", area(piece));
    }

    #[test]
    fn two_openings_leave_two_pieces() {
        let side = |from, to| Opening { side: Side::Left, from, to };
        let all = pieces(&[side(0.06, 0.14), side(0.2, 0.28)]);
        let solid = 0.70 * 0.52 - 0.62 * 0.44 - 0.16 * 0.04;
        assert_eq!(all.len(), 2);
        assert!((all.iter().map(|it| area(it)).sum::<f64>() + solid).abs() < 1e-9);
        let bottom = pieces(&[Opening { side: Side::Bottom, from: 0.115, to: 0.275 }]);
        assert!((area(&bottom[0]) + solid).abs() < 1e-9 && bottom[0].len() == 12);
    }
}
