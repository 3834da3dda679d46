//! How pressure and load answer to accelerations of the body.
//!
//! While the cells stand still the pressure is affine in the generalised acceleration a: p = p_0 + sum_k P_k a_k with
//! A P_k = b_k, and the load is Q = Q_0 - M a with the added mass M. With g_k the work of a unit normal force on a wall
//! facet of length L at the distance h from its particle,
//!
//!   b_k = -rho sum L g_k,      Q_k = sum (p + rho (f - a_w).n h) L g_k,      M_lk = sum rho L h g_l g_k - sum L g_l P_k.
//!
//! M is symmetric, positive semi-definite, and exact for the discrete water: the load that it foretells is the one that the
//! next solve gives.

use super::cells::{Cells, WallFacet};
use crate::matrix::Matrix;
use crate::multigrid::Multigrid;
use crate::parallel;
use crate::parameters::SolveParameters;
use crate::prepare::Setting;
use crate::pressure::ConjugateGradient;
use crate::walls::{FIXED, WallLayout};
use kinematics::{Body, MaterialPoint};
use nalgebra::{DMatrix, DVector};

/// Relative residual of the unit responses. The error of the added mass is its square.
const TOLERANCE: f64 = 1e-4;

/// A facet on a moving wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFacet {
    /// Particle whose cell it bounds.
    pub particle: u32,
    /// The facet.
    pub wall: WallFacet,
}

/// Unit responses that are solved for at once.
const WIDTH: usize = 4;

/// The systems of up to `WIDTH` active coordinates, side by side; what is left over is zero.
#[derive(Debug, Clone, Default)]
struct Block {
    right: Vec<[f64; WIDTH]>,
    /// Pressure for a unit acceleration of each coordinate \[Pa s2/m, Pa s2, modal\].
    pressure: Vec<[f64; WIDTH]>,
    product: Vec<[f64; WIDTH]>,
    solver: ConjugateGradient<WIDTH>,
    partial: Vec<[f64; WIDTH]>,
}

/// The facets on moving walls with their work, and what the water answers to unit accelerations.
#[derive(Debug, Clone, Default)]
pub struct Responses {
    /// Facets in the order of particles.
    pub facets: Vec<MovingFacet>,
    /// Work of a unit normal force on each facet by each coordinate \[m, m2, modal\]: facet after facet. The same numbers
    /// give the normal velocity of the wall there.
    work: Vec<f64>,
    /// First facet of each particle, and the number of facets.
    starts: Vec<u32>,
    /// Number of coordinates.
    size: usize,
    /// Coordinates that answer to the load.
    active: Vec<usize>,
    blocks: Vec<Block>,
    answer: DMatrix<f64>,
    near: DMatrix<f64>,
    /// Added mass of all coordinates, row after row; zero where one of the two is not active.
    pub added_mass: Vec<f64>,
    /// Iterations of the solver that the unit responses took.
    pub iterations: usize,
}

impl Responses {
    /// Collects the facets on moving walls, with the body at `coordinates`.
    pub fn collect(&mut self, cells: &Cells, layout: &WallLayout, body: &Body, coordinates: &DVector<f64>) {
        self.size = coordinates.len();
        self.facets.clear();
        self.work.clear();
        self.starts.clear();
        self.starts.push(0);
        for i in 0..cells.cells.len() {
            let walls = if cells.is_lone(i) { &[] } else { cells.walls.of(i) };
            for wall in walls.iter().filter(|wall| wall.panel != FIXED && !wall.filler) {
                let [start, end] = layout.panels[wall.panel as usize];
                let Some(point) = MaterialPoint::between(start, end, wall.fraction) else { continue };
                self.facets.push(MovingFacet { particle: i as u32, wall: *wall });
                let begin = self.work.len();
                self.work.resize(begin + self.size, 0.0);
                body.add_force(point, coordinates, wall.facet.normal, &mut self.work[begin..]);
            }
            self.starts.push(self.facets.len() as u32);
        }
    }

    /// Facets of particle i on moving walls, with the work on them; none where nothing was collected.
    pub fn of(&self, i: usize) -> impl Iterator<Item = (&MovingFacet, &[f64])> {
        let range = match self.starts.get(i..i + 2) {
            Some(&[begin, end]) => begin as usize..end as usize,
            _ => 0..0,
        };
        range.map(|k| (&self.facets[k], &self.work[k * self.size..(k + 1) * self.size]))
    }

    /// Normal component, into the solid, of the wall's velocity or acceleration at a facet.
    pub fn normal_rate(work: &[f64], rates: &DVector<f64>) -> f64 {
        work.iter().zip(rates.iter()).map(|(work, rate)| work * rate).sum()
    }

    /// Facets with the work of a unit normal force on them by every coordinate.
    pub fn facets_with_work(&self) -> impl Iterator<Item = (&MovingFacet, &[f64])> {
        self.facets.iter().zip(self.work.chunks_exact(self.size.max(1)))
    }

    /// Solves for the unit responses of the active coordinates.
    pub fn solve(&mut self, setting: &Setting, matrix: &Matrix, multigrid: &Multigrid) {
        let (active, density) = (&setting.geometry.active, setting.parameters.density);
        self.active.clone_from(active);
        self.iterations = 0;
        let parameters = &setting.parameters.solve;
        let parameters = SolveParameters { tolerance: TOLERANCE.max(parameters.tolerance), ..parameters.clone() };
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.resize_with(active.len().div_ceil(WIDTH), Block::default);
        for (block, coordinates) in blocks.iter_mut().zip(active.chunks(WIDTH)) {
            block.clear(matrix.size());
            for (facet, work) in self.facets_with_work() {
                let right = &mut block.right[facet.particle as usize];
                for (right, &coordinate) in right.iter_mut().zip(coordinates) {
                    *right -= density * facet.wall.facet.length() * work[coordinate];
                }
            }
            let Block { right, pressure, product, solver, partial } = block;
            self.iterations += solver.solve(matrix, multigrid, right, pressure, &parameters).iterations;
            matrix.product(pressure, product, partial);
        }
        self.blocks = blocks;
        self.find_added_mass(density);
    }

    /// M from the unit responses, corrected by their residuals: its error is the square of theirs.
    fn find_added_mass(&mut self, density: f64) {
        let mut answer = clean(&mut self.answer, self.active.len());
        for column in 0..self.blocks.len() {
            // The partial sums move out so that this block can be compared with all.
            let mut partial = std::mem::take(&mut self.blocks[column].partial);
            for row in 0..self.active.len() {
                let (left, lane) = (&self.blocks[row / WIDTH], row % WIDTH);
                let block = &self.blocks[column];
                let sums = parallel::sums(block.right.len(), &mut partial, |i| {
                    let (right, pressure, product) = (&block.right[i], &block.pressure[i], &block.product[i]);
                    std::array::from_fn(|k| {
                        left.right[i][lane] * pressure[k] + left.pressure[i][lane] * (right[k] - product[k])
                    })
                });
                for (k, sum) in sums.into_iter().enumerate().take(self.active.len() - column * WIDTH) {
                    answer[(row, column * WIDTH + k)] = sum;
                }
            }
            self.blocks[column].partial = partial;
        }
        self.added_mass.clear();
        self.added_mass.resize(self.size * self.size, 0.0);
        let mut near = clean(&mut self.near, self.active.len());
        for (facet, work) in self.facets_with_work() {
            let weight = density * facet.wall.facet.length() * facet.wall.facet.height;
            for (k, &column) in self.active.iter().enumerate() {
                for (l, &row) in self.active.iter().enumerate() {
                    near[(l, k)] += weight * work[row] * work[column];
                }
            }
        }
        for (k, &column) in self.active.iter().enumerate() {
            for (l, &row) in self.active.iter().enumerate() {
                let symmetric = 0.5 * (answer[(l, k)] + answer[(k, l)]) / density;
                self.added_mass[row * self.size + column] = near[(l, k)] + symmetric;
            }
        }
        (self.answer, self.near) = (answer, near);
    }

    /// Adds the pressure that the accelerations `change` of all coordinates cause.
    pub fn add(&self, change: &DVector<f64>, pressures: &mut [f64]) {
        for (block, coordinates) in self.blocks.iter().zip(self.active.chunks(WIDTH)) {
            let mut factors = [0.0; WIDTH];
            factors.iter_mut().zip(coordinates).for_each(|(factor, &coordinate)| *factor = change[coordinate]);
            parallel::update(pressures, |i, old| {
                old + factors.iter().zip(&block.pressure[i]).map(|(factor, unit)| factor * unit).sum::<f64>()
            });
        }
    }
}

/// Takes a matrix out of its place as zeros of the given size.
fn clean(matrix: &mut DMatrix<f64>, size: usize) -> DMatrix<f64> {
    let mut taken = std::mem::take(matrix);
    if taken.nrows() != size {
        taken = DMatrix::zeros(size, size);
    }
    taken.fill(0.0);
    taken
}

impl Block {
    fn clear(&mut self, size: usize) {
        for vector in [&mut self.right, &mut self.pressure, &mut self.product] {
            vector.clear();
            vector.resize(size, [0.0; WIDTH]);
        }
    }
}
