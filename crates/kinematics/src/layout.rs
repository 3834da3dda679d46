//! Which entry of a vector of generalised coordinates belongs to which body and member.

use std::ops::Range;

/// Number of rigid coordinates of a body: X, Y and theta.
pub const RIGID: usize = 3;

/// What a coordinate of a body moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// X of o_R.
    X,
    /// Y of o_R.
    Y,
    /// The angle.
    Theta,
    /// A mode of a member.
    Mode {
        /// Index of the member on its body.
        member: usize,
        /// Index of the mode on its member.
        mode: usize,
    },
}

/// A coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Coordinate {
    /// Index of the body.
    pub body: usize,
    /// What of it moves.
    pub part: Part,
}

/// The coordinates of bodies one after the other: X, Y and theta of a body, then the modes of its members.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CoordinateLayout {
    /// Modes of each member, body by body.
    modes: Vec<Vec<usize>>,
}

impl CoordinateLayout {
    /// For bodies whose members have these numbers of modes.
    pub fn new(modes: Vec<Vec<usize>>) -> Self {
        Self { modes }
    }

    /// For one body with one member.
    pub fn single(modes: usize) -> Self {
        Self::new(vec![vec![modes]])
    }

    /// Number of coordinates.
    pub fn size(&self) -> usize {
        (0..self.bodies()).map(|body| self.length(body)).sum()
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.modes.len()
    }

    /// Number of members of a body.
    pub fn members(&self, body: usize) -> usize {
        self.modes[body].len()
    }

    fn length(&self, body: usize) -> usize {
        RIGID + self.modes[body].iter().sum::<usize>()
    }

    /// The coordinates of a body.
    pub fn body(&self, body: usize) -> Range<usize> {
        let start = (0..body).map(|earlier| self.length(earlier)).sum::<usize>();
        start..start + self.length(body)
    }

    /// X, Y and theta of a body.
    pub fn rigid(&self, body: usize) -> Range<usize> {
        let start = self.body(body).start;
        start..start + RIGID
    }

    /// The modes of a member.
    pub fn member(&self, body: usize, member: usize) -> Range<usize> {
        let start = self.rigid(body).end + self.modes[body][..member].iter().sum::<usize>();
        start..start + self.modes[body][member]
    }

    /// What each entry is, in order.
    pub fn coordinates(&self) -> impl Iterator<Item = Coordinate> {
        self.modes.iter().enumerate().flat_map(|(body, members)| {
            let modes = members.iter().enumerate();
            let modes = modes.flat_map(|(member, &count)| (0..count).map(move |mode| Part::Mode { member, mode }));
            [Part::X, Part::Y, Part::Theta].into_iter().chain(modes).map(move |part| Coordinate { body, part })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_has_its_place() {
        let layout = CoordinateLayout::new(vec![vec![2, 1], vec![], vec![3]]);
        assert_eq!((layout.size(), layout.bodies(), layout.members(0), layout.members(1)), (15, 3, 2, 0));
        assert_eq!((layout.body(0), layout.body(1), layout.body(2)), (0..6, 6..9, 9..15));
        assert_eq!((layout.member(0, 0), layout.member(0, 1), layout.member(2, 0)), (3..5, 5..6, 12..15));
        let all: Vec<Coordinate> = layout.coordinates().collect();
        assert_eq!(all.len(), layout.size());
        assert_eq!(all[5], Coordinate { body: 0, part: Part::Mode { member: 1, mode: 0 } });
        assert_eq!((all[6].part, all[11].part), (Part::X, Part::Theta));
        assert_eq!(all[14], Coordinate { body: 2, part: Part::Mode { member: 0, mode: 2 } });
    }
}
