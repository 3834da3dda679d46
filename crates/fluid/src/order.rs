//! The order of particles: neighbours in space stand near each other in memory.

use crate::grid::bounding_box;
use crate::state::{AreaRate, State};
use nalgebra::Vector2;

/// Internal steps between two sorts: particles travel a few spacings meanwhile.
const EVERY: u64 = 32;
/// Side in spacings of the cells that are put in order.
const CELL: f64 = 2.0;
/// Cells along each side of the curve, as a power of two.
const LEVELS: u32 = 16;

/// Whether a state after this many internal steps is put in order.
pub fn is_due(steps: u64) -> bool {
    steps.is_multiple_of(EVERY)
}

/// Scratch for putting particles in order.
#[derive(Debug, Clone, Default)]
pub struct Order {
    keys: Vec<(u64, u32)>,
    vectors: Vec<Vector2<f64>>,
    numbers: Vec<f64>,
    rates: Vec<AreaRate>,
    flags: Vec<bool>,
}

impl Order {
    /// Puts particles in the order of a Hilbert curve through cells of two spacings, those of one cell by their old
    /// order.
    pub fn sort(&mut self, state: &mut State, spacing: f64) {
        let Self { keys, vectors, numbers, rates, flags } = self;
        let (low, _) = bounding_box(&state.positions);
        let size = CELL * spacing;
        let most = (1u32 << LEVELS) - 1;
        let place = |value: f64| (value / size).min(f64::from(most)) as u32;
        keys.clear();
        keys.extend(state.positions.iter().enumerate().map(|(i, position)| {
            let relative = position - low;
            (along_curve(place(relative.x), place(relative.y)), i as u32)
        }));
        keys.sort_unstable();
        if keys.iter().enumerate().all(|(k, &(_, i))| k == i as usize) {
            return;
        }
        permute(&mut state.positions, keys, vectors);
        permute(&mut state.velocities, keys, vectors);
        for values in [&mut state.pressures, &mut state.areas, &mut state.number_densities] {
            permute(values, keys, numbers);
        }
        permute(&mut state.area_rates, keys, rates);
        permute(&mut state.surface, keys, flags);
    }
}

fn permute<T: Copy>(values: &mut Vec<T>, keys: &[(u64, u32)], scratch: &mut Vec<T>) {
    scratch.clear();
    scratch.extend(keys.iter().map(|&(_, i)| values[i as usize]));
    std::mem::swap(values, scratch);
}

/// Place along the Hilbert curve of a cell (Hilbert 1891), quadrant by quadrant.
fn along_curve(mut x: u32, mut y: u32) -> u64 {
    let mut along = 0;
    let mut side = 1 << (LEVELS - 1);
    while side > 0 {
        let (right, upper) = (u32::from(x & side > 0), u32::from(y & side > 0));
        along += u64::from(side) * u64::from(side) * u64::from((3 * right) ^ upper);
        if upper == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            (x, y) = (y, x);
        }
        side >>= 1;
    }
    along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_neighbour_to_neighbour() {
        let mut cells: Vec<_> = (0..64).map(|k| (k % 8, k / 8)).collect();
        cells.sort_by_key(|&(x, y)| along_curve(x, y));
        for pair in cells.windows(2) {
            let ((x, y), (next_x, next_y)) = (pair[0], pair[1]);
            assert_eq!(x.abs_diff(next_x) + y.abs_diff(next_y), 1, "from {:?} to {:?}", pair[0], pair[1]);
        }
    }
}
