//! A facet of a cell.

use nalgebra::Vector2;

/// Distances in spacings of two particles over which the facet between them vanishes, if both its ends lie in empty
/// space.
const PARTING: [f64; 2] = [1.3, 1.6];
/// An end that lies in empty space altogether.
const EMPTY: f64 = u16::MAX as f64;

/// A facet between two particles, or of a particle on a wall, seen from the particle. Places along it count from the
/// foot of the perpendicular from the particle, counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// The other particle; for a wall the index of its plane.
    pub neighbour: u32,
    /// How far start and end lie in empty space, where the free surface cuts them off.
    empty: [u16; 2],
    /// Unit vector to the neighbour or into the wall.
    pub normal: Vector2<f64>,
    /// Distance of the facet's line from the particle, half the distance to the neighbour \[m\].
    pub height: f64,
    /// Start along the line \[m\].
    pub from: f64,
    /// End along the line \[m\].
    pub to: f64,
}

impl Facet {
    /// The facet on the line with this unit normal at this distance, between two places along it.
    #[inline]
    pub fn new(neighbour: u32, normal: Vector2<f64>, height: f64, [from, to]: [f64; 2]) -> Self {
        Self { neighbour, empty: [0; 2], normal, height, from, to }
    }

    /// The same facet with ends that lie in empty space by these shares, 0 to 1.
    pub fn with_empty_ends(self, shares: [f64; 2]) -> Self {
        Self { empty: shares.map(|share| (share * EMPTY).round() as u16), ..self }
    }

    /// Length \[m\].
    #[inline]
    pub fn length(&self) -> f64 {
        self.to - self.from
    }

    /// Length over the distance of the two particles.
    #[inline]
    pub fn weight(&self) -> f64 {
        (self.to - self.from) / (2.0 * self.height)
    }

    /// From the particle to the middle \[m\].
    #[inline]
    pub fn middle(&self) -> Vector2<f64> {
        self.normal * self.height + turn(&self.normal) * (0.5 * (self.from + self.to))
    }

    /// From the particle to start and end \[m\].
    pub fn ends(&self) -> [Vector2<f64>; 2] {
        [self.from, self.to].map(|place| self.normal * self.height + turn(&self.normal) * place)
    }

    /// From the middle to the neighbour \[m\].
    #[inline]
    pub fn beyond(&self) -> Vector2<f64> {
        self.normal * self.height - turn(&self.normal) * (0.5 * (self.from + self.to))
    }

    /// The part of the facet between two places along it.
    pub fn part(&self, [from, to]: [f64; 2]) -> Self {
        Self { from, to, ..*self }
    }

    /// The part of the facet that the neighbour sees in its facet `seen` too.
    pub fn common(&self, seen: &Self) -> Option<Self> {
        let (from, to) = (self.from.max(-seen.to), self.to.min(-seen.from));
        (to > from).then(|| self.part([from, to]))
    }

    /// Whether the free surface crosses the facet at all.
    pub fn meets_surface(&self) -> bool {
        self.empty != [0; 2]
    }

    /// Start and end of the facet where they lie in empty space rather than in water: there the free surface begins.
    pub fn surface_ends(&self) -> [Option<f64>; 2] {
        let empty = self.empty.map(|share| 2 * u32::from(share) > u32::from(u16::MAX));
        [empty[0].then_some(self.from), empty[1].then_some(self.to)]
    }

    /// Places along the facet where the free surface ends it, each with how far it does.
    pub fn surface_shares(&self) -> impl Iterator<Item = (f64, f64)> {
        [self.from, self.to].into_iter().zip(self.empty.map(|share| f64::from(share) / EMPTY))
    }

    /// Part of the integral of the place along the facet over it, from its foot \[m2\]: length times the mean place.
    #[inline]
    pub fn moment_along(&self) -> f64 {
        0.5 * (self.to * self.to - self.from * self.from)
    }

    /// Ends the facet where the free surface crosses it, `depth` outside the foot, by as much as its ends lie in empty
    /// space. Between two particles that part, with empty space at both ends, it vanishes.
    pub fn end_at(&mut self, depth: f64, spacing: f64) {
        let [start, end] = self.empty.map(|share| f64::from(share) / EMPTY);
        let reach = depth * (1.0 - start.min(end) * (1.0 - held(2.0 * self.height / spacing)));
        let (from, to) = (self.from, self.to.max(self.from));
        self.from += start * ((-reach).clamp(from, to) - from);
        self.to += end * (reach.clamp(from, to) - to);
        self.to = self.to.max(self.from);
    }
}

/// Share by which two particles at a distance in spacings hold together if there is empty space on both sides.
pub fn held(distance: f64) -> f64 {
    ((PARTING[1] - distance) / (PARTING[1] - PARTING[0])).clamp(0.0, 1.0)
}

/// A vector turned counter-clockwise by a right angle.
#[inline]
pub fn turn(vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}
