//! Water that touches no free surface: its pressure is determined up to a constant only.

use super::cells::Cells;
use crate::parallel::{CHUNK, Lists};
use rayon::prelude::*;

/// Least weight of a facet that ties two cells together. A group held by weaker ones has a matrix so nearly singular
/// that its pressure, and with it a load, is noise.
const STRONG: f64 = 0.02;
/// Smallest group of cells without a free surface that is solved for as it is: smaller ones, pressed into a corner by
/// a splash, get a vent.
const SMALLEST: u32 = 50;
/// Conductance to the air of a cell of such a group, that of a flat free surface.
const VENT: f64 = 2.0;

/// Scratch for finding groups of cells that hang together.
#[derive(Debug, Clone, Default)]
pub struct Groups {
    /// Another member of the group, an earlier one; itself for the first.
    leader: Vec<u32>,
    /// Ties between cells of different chunks.
    across: Lists<(u32, u32)>,
    /// Number of cells of the group of each leader, and whether one of them is open.
    size: Vec<(u32, bool)>,
}

impl Groups {
    /// Finds groups of cells that hang together with no free surface. Small ones get a vent, a conductance in `to_air`;
    /// the return value says whether a large one remains.
    ///
    /// Groups are found within chunks of particles at once, and then joined across them: the groups are the same
    /// whatever the order.
    pub fn settle(&mut self, cells: &Cells, to_air: &mut [f64]) -> bool {
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
        self.vent(to_air)
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

    fn vent(&self, to_air: &mut [f64]) -> bool {
        let mut large = false;
        if self.size.iter().all(|&(size, open)| open || size == 0) {
            return large;
        }
        for (conductance, &leader) in to_air.iter_mut().zip(&self.leader) {
            match self.size[leader as usize] {
                (_, true) => {}
                (size, false) if size < SMALLEST => *conductance = VENT,
                _ => large = true,
            }
        }
        large
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
