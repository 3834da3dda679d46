//! Water that touches no free surface: its pressure is determined up to a constant only.

use super::cells::Cells;

/// Least weight of a facet that ties two cells together. A group held by weaker ones has a matrix so nearly singular
/// that its pressure, and with it a load, is noise.
const STRONG: f64 = 0.02;
/// Smallest group of cells without a free surface that is solved for as it is: smaller ones, pressed into a corner by
/// a splash, get a vent.
const SMALLEST: usize = 50;
/// Conductance to the air of a cell of such a group, that of a flat free surface.
const VENT: f64 = 2.0;

/// Finds groups of cells that hang together with no free surface. Small ones get a vent, a conductance in `to_air`; the
/// return value says whether a large one remains.
pub fn settle(cells: &Cells, to_air: &mut [f64], reached: &mut Vec<bool>, queue: &mut Vec<u32>) -> bool {
    reached.clear();
    reached.extend(to_air.iter().map(|&conductance| conductance > 0.0));
    queue.clear();
    queue.extend((0..reached.len() as u32).filter(|&i| reached[i as usize]));
    spread(cells, reached, queue);
    let mut large = false;
    for start in 0..reached.len() {
        if reached[start] {
            continue;
        }
        reached[start] = true;
        queue.push(start as u32);
        let group = spread(cells, reached, queue);
        if group.len() >= SMALLEST {
            large = true;
        } else {
            group.iter().for_each(|&i| to_air[i as usize] = VENT);
        }
    }
    large
}

/// Marks everything tied to the queue, and returns it.
fn spread(cells: &Cells, reached: &mut [bool], queue: &mut Vec<u32>) -> Vec<u32> {
    let mut group = Vec::new();
    while let Some(i) = queue.pop() {
        group.push(i);
        for facet in cells.facets.of(i as usize) {
            let j = facet.neighbour as usize;
            if !reached[j] && facet.weight() >= STRONG {
                reached[j] = true;
                queue.push(facet.neighbour);
            }
        }
    }
    group
}
