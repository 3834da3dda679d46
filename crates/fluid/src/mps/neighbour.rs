//! A particle seen from another.

/// A neighbour within the effective radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Index of the particle.
    pub index: u32,
    /// Weight w of its distance.
    pub weight: f64,
}
