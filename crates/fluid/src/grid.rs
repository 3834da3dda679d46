//! Uniform cells that list particles in a fixed order.

use crate::parallel::{self, CHUNK};
use nalgebra::Vector2;
use rayon::prelude::*;
use std::ops::Range;

/// Cells over the bounding box of the particles; each lists its particles by ascending index.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    origin: Vector2<f64>,
    inverse_size: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    members: Vec<u32>,
    cell_of: Vec<u32>,
    x: Vec<f64>,
    y: Vec<f64>,
}

/// Particles that stand side by side in the grid.
pub struct Row<'a> {
    /// Their numbers.
    pub members: &'a [u32],
    /// Where they stand \[m\].
    pub x: &'a [f64],
    /// Where they stand \[m\].
    pub y: &'a [f64],
}

/// Most cells of a grid: 64 MB. Water that scatters farther gets larger cells, which find the same neighbours.
const MOST_CELLS: f64 = (1 << 24) as f64;

/// Side of the cells of a grid over a box of `extent`: `size`, or enough more to stay below [`MOST_CELLS`] \[m\].
pub fn bearable_size(extent: &Vector2<f64>, mut size: f64) -> f64 {
    let cells = |size: f64| (extent.x / size + 1.0) * (extent.y / size + 1.0);
    while extent.x.max(extent.y).is_finite() && cells(size) > MOST_CELLS {
        size *= 2.0;
    }
    size
}

impl Grid {
    /// Sorts the particles into cells of `size` \[m\]. Ascending order within a cell keeps every later sum the same.
    pub fn build(&mut self, positions: &[Vector2<f64>], size: f64) {
        let (low, high) = bounding_box(positions);
        let size = bearable_size(&(high - low), size);
        self.origin = low;
        self.inverse_size = 1.0 / size;
        self.columns = ((high.x - low.x) * self.inverse_size) as usize + 1;
        self.rows = ((high.y - low.y) * self.inverse_size) as usize + 1;
        let cells = self.columns * self.rows;
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        let mut cell_of = std::mem::take(&mut self.cell_of);
        cell_of.resize(positions.len(), 0);
        parallel::fill(&mut cell_of, |i| {
            let (column, row) = self.place(&positions[i]);
            (row as usize * self.columns + column as usize) as u32
        });
        cell_of.iter().for_each(|&cell| self.starts[cell as usize + 1] += 1);
        self.cell_of = cell_of;
        for cell in 0..cells {
            self.starts[cell + 1] += self.starts[cell];
        }
        self.members.resize(positions.len(), 0);
        for (index, &cell) in self.cell_of.iter().enumerate().rev() {
            let slot = &mut self.starts[cell as usize + 1];
            *slot -= 1;
            self.members[*slot as usize] = index as u32;
        }
        // Every start was counted down to the start of its own cell: shift by one to restore the table.
        for cell in 0..cells {
            self.starts[cell] = self.starts[cell + 1];
        }
        self.starts[cells] = positions.len() as u32;
        self.x.resize(positions.len(), 0.0);
        self.y.resize(positions.len(), 0.0);
        let members = &self.members;
        let places = self.x.par_iter_mut().zip(&mut self.y).zip(members).with_min_len(CHUNK);
        places.for_each(|((x, y), &member)| (*x, *y) = (positions[member as usize].x, positions[member as usize].y));
    }

    /// Calls `visit` with the particles of every row of cells up to `rings` cells away from `position`, in a fixed
    /// order.
    #[inline(always)]
    pub fn for_each_row(&self, position: &Vector2<f64>, rings: i64, mut visit: impl FnMut(Row)) {
        self.for_each_range(
            position,
            rings,
            #[inline(always)]
            |range| {
                let (x, y) = (&self.x[range.clone()], &self.y[range.clone()]);
                visit(Row { members: &self.members[range], x, y });
            },
        );
    }

    fn place(&self, position: &Vector2<f64>) -> (i64, i64) {
        let relative = (position - self.origin) * self.inverse_size;
        (relative.x.floor() as i64, relative.y.floor() as i64)
    }

    /// Calls `visit` with every particle in the 3 x 3 cells around `position`, in a fixed order.
    #[inline]
    pub fn for_each_near(&self, position: &Vector2<f64>, visit: impl FnMut(usize)) {
        self.for_each_within(position, 1, visit);
    }

    /// Calls `visit` with every particle in the cells up to `rings` cells away from `position`, in a fixed order.
    #[inline]
    pub fn for_each_within(&self, position: &Vector2<f64>, rings: i64, mut visit: impl FnMut(usize)) {
        self.for_each_range(position, rings, |range| {
            self.members[range].iter().for_each(|&member| visit(member as usize))
        });
    }

    /// Calls `visit` with the range of members of every row of cells.
    #[inline(always)]
    fn for_each_range(&self, position: &Vector2<f64>, rings: i64, mut visit: impl FnMut(Range<usize>)) {
        let (column, row) = self.place(position);
        let first = (column - rings).max(0);
        let last = (column + rings).min(self.columns as i64 - 1);
        if first > last {
            return;
        }
        for r in (row - rings).max(0)..=(row + rings).min(self.rows as i64 - 1) {
            let base = r as usize * self.columns;
            visit(self.starts[base + first as usize] as usize..self.starts[base + last as usize + 1] as usize);
        }
    }
}

/// Lowest and highest corner of a set of points; zero for an empty set.
pub fn bounding_box(points: &[Vector2<f64>]) -> (Vector2<f64>, Vector2<f64>) {
    let Some(first) = points.first() else { return (Vector2::zeros(), Vector2::zeros()) };
    points.iter().fold((*first, *first), |(low, high), point| (low.inf(point), high.sup(point)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_same_neighbours_as_all_pairs() {
        let positions: Vec<_> = (0..400)
            .map(|i| Vector2::new(((i * 7919) % 1000) as f64 * 1e-3, ((i * 104_729) % 997) as f64 * 1e-3))
            .collect();
        let mut grid = Grid::default();
        grid.build(&positions, 0.1);
        for point in &positions {
            let mut found = Vec::new();
            grid.for_each_near(point, |j| {
                if (positions[j] - point).norm() < 0.1 {
                    found.push(j);
                }
            });
            found.sort_unstable();
            let all: Vec<_> = (0..positions.len()).filter(|&j| (positions[j] - point).norm() < 0.1).collect();
            assert_eq!(found, all);
        }
    }
}
