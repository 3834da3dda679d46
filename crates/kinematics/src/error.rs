//! What can be wrong with the geometry of a body.

use digits::six;

/// A geometry that cannot be used. Raised once, when a part is built or validated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A length, density or thickness that is not positive and finite.
    #[error("{what} is {} {unit}, but has to be positive and finite", six(*value))]
    NotPositive {
        /// The quantity.
        what: &'static str,
        /// What was given.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A place or an angle that is not a finite number.
    #[error("{what} is {}, but has to be finite", six(*value))]
    NotFinite {
        /// The quantity.
        what: String,
        /// What was given.
        value: f64,
    },
    /// A wall polyline with fewer than two points.
    #[error("wall {wall} of the body has {points} point(s), but a polyline needs at least 2")]
    ShortWall {
        /// Index of the polyline, from 0.
        wall: usize,
        /// Its number of points.
        points: usize,
    },
    /// Two consecutive points of a wall polyline that coincide.
    #[error(
        "points {point} and {} of wall {wall} of the body coincide at ({}, {}) m; remove one of them",
        point + 1, six(*x), six(*y)
    )]
    EmptySegment {
        /// Index of the polyline, from 0.
        wall: usize,
        /// Index of the first of the two points, from 0.
        point: usize,
        /// Its place in the body frame, m.
        x: f64,
        /// Its place in the body frame, m.
        y: f64,
    },
}
