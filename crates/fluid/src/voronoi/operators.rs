//! Discrete operators on Voronoi cells.
//!
//! With L the length of the facet between i and j, r their distance and m its middle:
//!
//!   (D u)_i = sum_j L/r (r_j - m).(u_j - u_i) + walls L n.(u_w - u_i)      rate of the cell's area,
//!   (G p)_i = sum_j L/r (p_j - p_i) (m - r_i) + walls L dp/dn (m - r_i) - p_i S_i,
//!   (A p)_i = sum_j L/r (p_i - p_j) + Lambda/delta p_i.
//!
//! D is the exact rate at which cell areas change (Serrano and Espanol 2001), G is its adjoint inside the water and
//! G / area is exact for linear p on any arrangement (Kincl, Peshkov and Boscheri 2024); S is the integral of the
//! outward normal over the cell's free surface, where p = 0 at the distance delta.

use super::cells::Cells;
use super::facet::Facet;
use nalgebra::{Matrix2, Vector2};

/// Rate of the area of cell i over the facets to particles \[m2/s\].
pub fn area_rate(cells: &Cells, i: usize, velocities: &[Vector2<f64>]) -> f64 {
    let own = velocities[i];
    let between = |facet: &Facet| facet.weight() * facet.beyond().dot(&(velocities[facet.neighbour as usize] - own));
    cells.facets.of(i).iter().map(between).sum()
}

/// Sum of the pressure differences over the facets of cell i and its free surface, G p without walls \[N/m\].
pub fn pressure_difference(cells: &Cells, i: usize, pressures: &[f64]) -> Vector2<f64> {
    let own = pressures[i];
    let mut sum = -cells.cells[i].free_surface_gradient * own;
    for facet in cells.facets.of(i) {
        sum += facet.middle() * (facet.weight() * (pressures[facet.neighbour as usize] - own));
    }
    sum
}

/// Weight of the divergence, over the trace of the moments, against what the neighbours say of it.
const TOWARDS_NO_DIVERGENCE: f64 = 0.2;
/// Weight of the gradient itself, over the trace of the moments, where the neighbours lie on a line.
const TOWARDS_NO_GRADIENT: f64 = 1e-3;

/// Gradient d u_a / d x_b at particle i by least squares over its neighbours \[1/s\]: the G that makes
///
///   sum w |G r - du|^2 + lambda (tr G)^2 + mu |G|^2
///
/// smallest, with the closed form G = (P - lambda t 1) N of P = sum w du r^T, N = (sum w r r^T + mu 1)^-1 and
/// t = tr(P N) / (1 + lambda tr N). A film one particle thick is stretched along itself and says nothing of what it does
/// across: water, it gets thinner by as much. Any field without divergence keeps its gradient; mu vanishes where the
/// neighbours stand all round.
pub fn velocity_gradient(
    cells: &Cells,
    i: usize,
    positions: &[Vector2<f64>],
    velocities: &[Vector2<f64>],
) -> Matrix2<f64> {
    let (mut moments, mut products) = (Matrix2::zeros(), Matrix2::zeros());
    for facet in cells.facets.of(i) {
        let j = facet.neighbour as usize;
        let weight = facet.weight();
        let away = positions[j] - positions[i];
        moments += away * away.transpose() * weight;
        products += (velocities[j] - velocities[i]) * away.transpose() * weight;
    }
    let trace = moments.trace();
    if trace <= 0.0 {
        return Matrix2::zeros();
    }
    let lean = (1.0 - 4.0 * moments.determinant() / (trace * trace)).max(0.0);
    let ridge = TOWARDS_NO_GRADIENT * trace * lean * lean;
    let Some(inverse) = (moments + Matrix2::identity() * ridge).try_inverse() else { return Matrix2::zeros() };
    let free = products * inverse;
    let prior = TOWARDS_NO_DIVERGENCE * trace;
    free - inverse * (prior * free.trace() / (1.0 + prior * inverse.trace()))
}
