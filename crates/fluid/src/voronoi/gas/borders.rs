//! Which gas the free surfaces of cells border on.

use super::GasCells;
use crate::gas::{NOTHING, OPEN, Space};
use crate::parallel;
use crate::voronoi::system::PressureSystem;

/// Distance in spacings within which the surface of a cell borders on gas.
const BORDER: f64 = 2.3;
/// Rings of nodes within that distance.
const RINGS: i64 = 2;
/// Kinds of gas that a cell may see.
const KINDS: usize = 4;

/// Pockets that the surface of a cell borders on, by their labels, and with what share; the rest is open.
#[derive(Debug, Clone, Copy)]
pub struct Border {
    labels: [u32; 2],
    shares: [f64; 2],
}

impl Border {
    /// That of a cell without a surface, or in the open air.
    const NONE: Self = Self { labels: [OPEN; 2], shares: [0.0; 2] };

    /// Pockets with their shares.
    pub fn pockets(self) -> impl Iterator<Item = (usize, f64)> {
        let closed = self.labels.into_iter().zip(self.shares).filter(|(label, _)| *label != OPEN);
        closed.map(|(label, share)| (label as usize - 1, share))
    }
}

/// Pockets that cell i borders on, with their shares; none where nothing was looked for.
pub fn border_of(borders: &[Border], i: usize) -> impl Iterator<Item = (usize, f64)> + use<> {
    borders.get(i).copied().unwrap_or(Border::NONE).pockets()
}

impl PressureSystem {
    /// What the surface of every cell borders on; one that sees no gas borders on what its neighbours do.
    pub(super) fn find_borders(&self, gas: &mut GasCells, spacing: f64) {
        let mut seen = vec![None; self.positions.len()];
        let space = &gas.space;
        parallel::fill(&mut seen, |i| {
            self.cells.cells[i].is_open().then(|| self.seen_from(space, i, spacing)).flatten()
        });
        gas.borders.resize(seen.len(), Border::NONE);
        let seen = &seen;
        parallel::fill(&mut gas.borders, |i| {
            if !self.cells.cells[i].is_open() || self.cells.is_isolated(i) {
                return Border::NONE;
            }
            let around = || self.cells.facets.of(i).iter().find_map(|facet| seen[facet.neighbour as usize]);
            seen[i].or_else(around).unwrap_or(Border::NONE)
        });
    }

    /// The two kinds of gas that the surface of cell i sees most of; none where there is none.
    fn seen_from(&self, space: &Space, i: usize, spacing: f64) -> Option<Border> {
        let place = &self.positions[i];
        let cell = &self.cells.cells[i];
        let outward = cell.outward / cell.surface;
        let beside_walls = !self.proximities.of(i).is_empty();
        let mut sums: [(u32, f64); KINDS] = [(NOTHING, 0.0); KINDS];
        for (label, node) in space.labels().near(place, RINGS) {
            let away = node - place;
            let distance = away.norm();
            if distance > BORDER * spacing || (beside_walls && self.walls.separates(place, &node)) {
                continue;
            }
            // All round a cell whose surface faces all ways.
            let facing = 1.0 - outward.norm() + outward.dot(&away) / distance;
            let weight = (facing.max(0.0) / distance).powi(2);
            if let Some(sum) = sums.iter_mut().find(|sum| sum.0 == label || sum.0 == NOTHING) {
                *sum = (label, sum.1 + weight);
            }
        }
        let all: f64 = sums.iter().map(|sum| sum.1).sum();
        if all <= 0.0 {
            return None;
        }
        sums.sort_by(|a, b| b.1.total_cmp(&a.1));
        let shares = [sums[0].1 / all, sums[1].1 / all];
        let labels = [0, 1].map(|k: usize| if sums[k].0 == NOTHING || shares[k] == 0.0 { OPEN } else { sums[k].0 });
        Some(Border { labels, shares: [0, 1].map(|k: usize| if labels[k] == OPEN { 0.0 } else { shares[k] }) })
    }
}
