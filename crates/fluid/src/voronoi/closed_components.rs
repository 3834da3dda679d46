//! Water that touches no free surface: its pressure is determined up to a constant only.
//!
//! Where it fills a compartment, the constant is the user's: that the highest point has a given pressure, by default
//! none, as if a thin pipe led from there to the air. Cells pressed together by a splash get a pin instead.

use super::cells::Cells;
use super::facet::Facet;
use crate::parallel::{CHUNK, Lists};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Least weight of a facet that ties two cells together. A group held by weaker ones has a matrix so nearly singular
/// that its pressure, and with it a load, is noise.
const STRONG: f64 = 0.02;
/// Smallest group of cells without a free surface that is solved for as it is, wherever it is: smaller ones are taken
/// for water pressed into a corner by a splash, unless they fill a compartment.
const SMALLEST: u32 = 50;
/// Largest share by which the cells of a small group may be larger or smaller than its water, to be a compartment that
/// it fills.
const FULL: f64 = 0.01;
/// Conductance to the air of a cell of such a group, that of a flat free surface.
const PIN: f64 = 2.0;

/// Scratch for finding groups of cells that hang together.
#[derive(Debug, Clone, Default)]
pub struct ClosedComponents {
    /// Another member of the group, an earlier one; itself for the first.
    leader: Vec<u32>,
    /// Ties between cells of different chunks.
    across: Lists<(u32, u32)>,
    /// Number of cells of the group of each leader, and whether one of them is open.
    size: Vec<(u32, bool)>,
    /// ClosedComponents without a free surface, in the order of their leaders.
    closed: Vec<Closed>,
}

/// What is known of a group of cells without a free surface.
#[derive(Debug, Clone, Copy, Default)]
struct Closed {
    leader: u32,
    size: u32,
    /// Whether it touches another group.
    touches: bool,
    /// Area of the cells, and of the water in them \[m2\].
    area: f64,
    volume: f64,
}

impl Closed {
    fn is_compartment(&self) -> bool {
        let full = (self.area - self.volume).abs() <= FULL * self.volume;
        self.size >= SMALLEST || full && !self.touches
    }
}

impl ClosedComponents {
    /// Finds groups of cells that hang together with no free surface. Small ones get a pin, a conductance in `to_air`;
    /// the return value says whether a large one remains.
    ///
    /// ClosedComponents are found within chunks of particles at once, and then joined across them: the groups are the same
    /// whatever the order.
    pub fn settle(&mut self, cells: &Cells, areas: &[f64], to_air: &mut [f64]) -> bool {
        let count = to_air.len();
        self.leader.resize(count, 0);
        let writers = (self.leader.par_chunks_mut(CHUNK), self.across.writers(count));
        writers.into_par_iter().enumerate().for_each(|(chunk, (leader, mut across))| {
            let first = (chunk * CHUNK) as u32;
            leader.iter_mut().zip(0..).for_each(|(leader, k)| *leader = k);
            for k in 0..leader.len() as u32 {
                let earlier = |j: &u32| *j < first + k;
                let tied = |j: &u32| *j >= first;
                for j in ties(cells, first + k).filter(earlier) {
                    if tied(&j) {
                        // Most ties are between cells that hang together already.
                        if leader[k as usize] != leader[(j - first) as usize] {
                            join(leader, k, j - first);
                        }
                    } else {
                        across.items.push((first + k, j));
                    }
                }
                across.end();
            }
            leader.iter_mut().for_each(|leader| *leader += first);
        });
        for &(i, j) in self.across.iter_all() {
            join(&mut self.leader, i, j);
        }
        self.count(to_air);
        self.find_closed(cells, areas) && self.pin(to_air)
    }

    /// Size and openness of every group; afterwards `leader` names the first member of each cell's group.
    fn count(&mut self, to_air: &[f64]) {
        self.size.clear();
        self.size.resize(to_air.len(), (0, false));
        for (i, &conductance) in to_air.iter().enumerate() {
            let first = self.leader[self.leader[i] as usize];
            self.leader[i] = first;
            let size = &mut self.size[first as usize];
            size.0 += 1;
            size.1 |= conductance > 0.0;
        }
    }

    /// Looks closer at groups without a free surface; whether there are any.
    fn find_closed(&mut self, cells: &Cells, areas: &[f64]) -> bool {
        self.closed.clear();
        if self.size.iter().all(|&(size, open)| open || size == 0) {
            return false;
        }
        for (i, &leader) in self.leader.iter().enumerate() {
            let (size, open) = self.size[leader as usize];
            if open {
                continue;
            }
            // The leader is the first of its members.
            if leader as usize == i {
                self.closed.push(Closed { leader, size, ..Closed::default() });
            }
            let beyond = |facet: &Facet| self.leader[facet.neighbour as usize] != leader;
            let Some(place) = self.place(leader) else { continue };
            let closed = &mut self.closed[place];
            closed.touches |= cells.facets.of(i).iter().any(beyond);
            closed.area += cells.cells[i].area;
            closed.volume += areas[i];
        }
        true
    }

    /// Where a group without a free surface stands in the list of these.
    fn place(&self, leader: u32) -> Option<usize> {
        self.closed.binary_search_by_key(&leader, |closed| closed.leader).ok()
    }

    fn pin(&self, to_air: &mut [f64]) -> bool {
        let pinned = |leader: &u32| self.place(*leader).is_some_and(|place| !self.closed[place].is_compartment());
        to_air.iter_mut().zip(&self.leader).filter(|(_, leader)| pinned(leader)).for_each(|(air, _)| *air = PIN);
        self.closed.iter().any(Closed::is_compartment)
    }

    /// Gives every compartment its constant: `pressure` at its highest point. `up` is the direction against gravity
    /// times the weight of a volume \[N/m3\].
    pub fn level(&self, cells: &Cells, places: &[Vector2<f64>], up: &Vector2<f64>, pressure: f64, values: &mut [f64]) {
        for &Closed { leader, size, .. } in self.closed.iter().filter(|group| group.is_compartment()) {
            let members = || (leader as usize..values.len()).filter(|&i| self.leader[i] == leader);
            let walls = |i: usize| cells.walls.of(i).iter().flat_map(|wall| wall.facet.ends());
            let highest = |i: usize| walls(i).map(|end| up.dot(&end)).fold(0.0, f64::max) + up.dot(&places[i]);
            let top = members().map(highest).fold(f64::NEG_INFINITY, f64::max);
            let excess = |i: usize| values[i] - (top - up.dot(&places[i]));
            let shift = pressure - members().map(excess).sum::<f64>() / f64::from(size);
            let own = values.iter_mut().zip(&self.leader).filter(|(_, of)| **of == leader);
            own.for_each(|(value, _)| *value += shift);
        }
    }
}

/// Cells that cell i is tied to.
fn ties(cells: &Cells, i: u32) -> impl Iterator<Item = u32> {
    cells
        .facets
        .of(i as usize)
        .iter()
        .filter(|facet| facet.length() >= STRONG * 2.0 * facet.height)
        .map(|facet| facet.neighbour)
}

/// Makes one group of those of two members: its leader is the first of all.
fn join(leader: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(leader, a), find(leader, b));
    leader[a.max(b) as usize] = a.min(b);
}

/// The first member of a group; the way there gets shorter.
fn find(leader: &mut [u32], mut member: u32) -> u32 {
    while leader[member as usize] != member {
        let next = leader[leader[member as usize] as usize];
        leader[member as usize] = next;
        member = next;
    }
    member
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_joined_in_any_order() {
        let mut leader: Vec<u32> = (0..9).collect();
        for (a, b) in [(8, 2), (3, 4), (2, 5), (4, 7), (5, 3)] {
            join(&mut leader, a, b);
        }
        let groups: Vec<u32> = (0..9).map(|member| find(&mut leader, member)).collect();
        assert_eq!(groups, [0, 1, 2, 2, 2, 2, 6, 2, 2]);
    }
}
