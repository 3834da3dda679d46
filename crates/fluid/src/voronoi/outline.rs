//! Figures of the water's outline and of its pressure on walls, from the cells.

use super::cells::{Cells, Setup};
use super::facet::turn;
use crate::parallel::Lists;
use crate::problem::Problem;
use crate::state::State;
use crate::walls::Walls;
use nalgebra::Vector2;
use std::borrow::Cow;

/// The cells of a state, for looking at it.
pub struct Outline<'a> {
    state: &'a State,
    spacing: f64,
    cells: Cow<'a, Cells>,
}

impl<'a> Outline<'a> {
    /// Of a state with its cells.
    pub fn of(problem: &'a Problem, state: &'a State, cells: &'a Cells) -> Self {
        let cells = Cow::Borrowed(cells);
        Self { state, spacing: problem.spacing, cells }
    }

    /// Of a state whose cells are cut out between `walls`.
    pub fn new(problem: &'a Problem, state: &'a State, walls: &Walls) -> Self {
        let mut proximities = Lists::default();
        proximities.build(state.positions.len(), |i, out| walls.attach(&state.positions[i], out));
        let mut cells = Cells::default();
        cells.build(&Setup {
            positions: &state.positions,
            areas: &state.areas,
            proximities: &proximities,
            walls,
            spacing: problem.spacing,
        });
        Self { state, spacing: problem.spacing, cells: Cow::Owned(cells) }
    }

    /// Area of all cells \[m2\].
    pub fn area(&self) -> f64 {
        self.cells.cells.iter().map(|cell| cell.area).sum()
    }

    /// The place on the free surface that a particle stands for; none for a cell without a clear outward direction.
    fn surface_point(&self, i: usize) -> Option<Vector2<f64>> {
        let cell = &self.cells.cells[i];
        let length = cell.outward.norm();
        let clear = cell.is_open() && length > 0.3 * cell.surface;
        clear.then(|| self.state.positions[i] + cell.outward * (cell.depth / length))
    }

    /// Calls `visit` with places on the outline of the water that has company: surface points and facet ends.
    fn visit_outline(&self, mut visit: impl FnMut(Vector2<f64>)) {
        for (i, position) in self.state.positions.iter().enumerate() {
            let facets = self.cells.facets.of(i);
            if facets.is_empty() {
                continue;
            }
            if let Some(point) = self.surface_point(i) {
                visit(point);
            }
            for facet in self.cells.facets_and_walls(i) {
                let (foot, along) = (position + facet.normal * facet.height, turn(&facet.normal));
                visit(foot + along * facet.from);
                visit(foot + along * facet.to);
            }
        }
    }

    /// Lowest and highest x and y, and largest distance from the origin \[m\].
    pub fn extent(&self) -> ([Vector2<f64>; 2], f64) {
        let (mut low, mut high, mut farthest) = (Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN), 0.0_f64);
        self.visit_outline(|point| {
            low = low.inf(&point);
            high = high.sup(&point);
            farthest = farthest.max(point.norm());
        });
        if low.x > high.x { ([Vector2::zeros(); 2], 0.0) } else { ([low, high], farthest) }
    }

    /// Highest place where the free surface crosses the vertical line at `x`; `lowest` where there is no water \[m\].
    ///
    /// The pieces of surface of two cells may leave a gap over the line, and the cell beside it may have no surface that
    /// can be told: there the highest cell near the line that touches two others at least says how far water goes.
    pub fn level(&self, x: f64, lowest: f64) -> f64 {
        let (mut highest, mut top) = (lowest, lowest);
        for (i, position) in self.state.positions.iter().enumerate() {
            let cell = &self.cells.cells[i];
            let away = (position.x - x).abs();
            if self.cells.facets.of(i).len() < 2 || away > 3.0 * cell.surface.max(self.spacing) {
                continue;
            }
            if away < BRIDGED * self.spacing {
                top = top.max(position.y + if cell.is_open() { cell.depth } else { 0.5 * self.spacing });
            }
            let Some(middle) = self.surface_point(i) else { continue };
            self.crossings(i, &middle, x, |y| highest = highest.max(y));
        }
        if top > highest + self.spacing { top } else { highest }
    }

    /// Calls `visit` with the heights at which the surface of cell i, with the place `middle` on it, passes `x`.
    fn crossings(&self, i: usize, middle: &Vector2<f64>, x: f64, mut visit: impl FnMut(f64)) {
        let position = &self.state.positions[i];
        for facet in self.cells.facets_and_walls(i) {
            let (foot, along) = (position + facet.normal * facet.height, turn(&facet.normal));
            for end in facet.surface_ends().into_iter().flatten() {
                if let Some(y) = crossing(middle, &(foot + along * end), x) {
                    visit(y);
                }
            }
        }
    }
}

/// Distance in spacings of a particle from a gauge up to which its surface point bridges a gap.
const BRIDGED: f64 = 0.75;

/// Height at which the straight line between two points passes the abscissa `x`.
fn crossing(a: &Vector2<f64>, b: &Vector2<f64>, x: f64) -> Option<f64> {
    let slack = 1e-9 * (a - b).norm();
    if x < a.x.min(b.x) - slack || x > a.x.max(b.x) + slack {
        return None;
    }
    let width = b.x - a.x;
    let share = if width.abs() <= slack { 1.0 } else { ((x - a.x) / width).clamp(0.0, 1.0) };
    Some(a.y + share * (b.y - a.y))
}
