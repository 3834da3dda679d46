//! Cells that say which wall segments may be near a place.

use crate::grid::bearable_size;
use crate::walls::Segment;
use nalgebra::Vector2;

/// Which segments may be near a place.
#[derive(Debug, Clone, Default)]
pub struct CandidateCells {
    origin: Vector2<f64>,
    inverse_size: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    members: Vec<u32>,
    entries: Vec<(u32, u32)>,
}

impl CandidateCells {
    /// Enters every segment into the cells within `radius` of it \[m\]; the cells are as wide, or wider where the walls
    /// reach so far that there would be too many.
    pub fn build(&mut self, segments: &[Segment], radius: f64) {
        let Some(first) = segments.first() else {
            *self = Self::default();
            return;
        };
        let corners = segments.iter().flat_map(|segment| [segment.start, segment.end()]);
        let (low, high) =
            corners.fold((first.start, first.start), |(low, high), corner| (low.inf(&corner), high.sup(&corner)));
        let size = bearable_size(&(high - low).add_scalar(4.0 * radius), radius);
        self.origin = low.add_scalar(-2.0 * radius);
        self.inverse_size = 1.0 / size;
        self.columns = ((high.x - low.x + 4.0 * radius) / size) as usize + 1;
        self.rows = ((high.y - low.y + 4.0 * radius) / size) as usize + 1;
        let mut entries = std::mem::take(&mut self.entries);
        entries.clear();
        for (index, segment) in segments.iter().enumerate() {
            self.mark(segment, radius, |cell| entries.push((cell as u32, index as u32)));
        }
        entries.sort_unstable();
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        self.members.clear();
        for &(cell, segment) in &entries {
            self.starts[cell as usize + 1] += 1;
            self.members.push(segment);
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.entries = entries;
    }

    fn mark(&self, segment: &Segment, radius: f64, mut enter: impl FnMut(usize)) {
        let size = 1.0 / self.inverse_size;
        let reach = radius + 0.75 * size;
        let index = |value: f64| (value * self.inverse_size).floor().max(0.0) as usize;
        let low = segment.start.inf(&segment.end()) - self.origin;
        let high = segment.start.sup(&segment.end()) - self.origin;
        for row in index(low.y - reach)..=index(high.y + reach).min(self.rows - 1) {
            for column in index(low.x - reach)..=index(high.x + reach).min(self.columns - 1) {
                let centre = self.origin + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * size;
                if segment.squared_distance(&centre) < reach * reach {
                    enter(row * self.columns + column);
                }
            }
        }
    }

    /// Segments that may be within the radius of a point.
    pub fn of(&self, point: &Vector2<f64>) -> &[u32] {
        let relative = (point - self.origin) * self.inverse_size;
        let inside = relative.x >= 0.0 && relative.y >= 0.0;
        let (column, row) = (relative.x as usize, relative.y as usize);
        if !inside || column >= self.columns || row >= self.rows {
            return &[];
        }
        let cell = row * self.columns + column;
        &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}
