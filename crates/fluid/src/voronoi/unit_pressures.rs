//! How pressure and load answer to accelerations of the body.
//!
//! While the cells stand still the pressure is affine in the generalised acceleration a: p = p_0 + sum_k P_k a_k with
//! A P_k = b_k, and the load is Q = Q_0 - M a with the added mass M. With g_k the work of a unit normal force on a wall
//! facet of length L at the distance h from its particle,
//!
//!   b_k = -rho sum L g_k,      Q_k = sum (p + rho (f - a_w).n h) L g_k,      M_lk = sum rho L h g_l g_k - sum L g_l P_k.
//!
//! M is symmetric, positive semi-definite, and exact for the discrete water: the load that it predicts is the one that
//! the next solve gives.

use super::cells::{Cells, WallFacet};
use super::facet::Facet;
use crate::linear::{ConjugateGradient, Guess, Matrix, Multigrid, SolveParameters};
use crate::parallel;
use crate::problem::Problem;
use crate::walls::{FIXED, WallLayout};
use kinematics::{BodySet, SurfacePoint};
use nalgebra::{DMatrix, DVector, Vector2};

/// Relative residual of the unit pressures. The error of the added mass is its square.
const TOLERANCE: f64 = 1e-4;

/// A facet on a moving wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFacet {
    /// Particle whose cell it bounds.
    pub particle: u32,
    /// The facet.
    pub wall: WallFacet,
}

/// Unit pressures that are solved for at once, and how many at the end take a smaller block of their own.
const WIDE: usize = 4;
const NARROW: usize = 2;

/// The systems of up to `K` active coordinates, side by side; what is left over is zero.
#[derive(Debug, Clone, Default)]
struct Block<const K: usize> {
    /// Coordinates, none for a block that is not there.
    coordinates: Vec<usize>,
    right: Vec<[f64; K]>,
    /// Pressure for a unit acceleration of each coordinate \[Pa s2/m, Pa s2, modal\].
    pressure: Vec<[f64; K]>,
    solver: ConjugateGradient<K>,
}

/// The facets on moving walls with their work, and what the water answers to unit accelerations.
#[derive(Debug, Clone, Default)]
pub struct UnitPressures {
    /// Facets in the order of particles.
    pub facets: Vec<MovingFacet>,
    /// Work of a unit normal force on each facet by each coordinate \[m, m2, modal\]: facet after facet. The same
    /// numbers give the normal velocity of the wall there.
    work: Vec<f64>,
    /// First facet of each particle, and the number of facets.
    starts: Vec<u32>,
    /// Walls that pockets of gas touch, each as one facet of length 1 of the pocket's row, and their work.
    gas: Vec<MovingFacet>,
    gas_work: Vec<f64>,
    /// Number of coordinates.
    size: usize,
    /// Coordinates that answer to the load.
    active: Vec<usize>,
    wide: Vec<Block<WIDE>>,
    narrow: Block<NARROW>,
    partial: Vec<[f64; WIDE * WIDE]>,
    mass: DMatrix<f64>,
    /// Added mass of all coordinates, row after row; zero where one of the two is not active.
    pub added_mass: Vec<f64>,
    /// Iterations of the solver that the unit pressures took.
    pub iterations: usize,
}

impl UnitPressures {
    /// Collects the facets on moving walls, with the bodies at `coordinates`.
    pub fn collect(&mut self, cells: &Cells, layout: &WallLayout, bodies: &BodySet, coordinates: &DVector<f64>) {
        self.size = coordinates.len();
        self.facets.clear();
        self.work.clear();
        self.starts.clear();
        self.starts.push(0);
        for i in 0..cells.cells.len() {
            let walls = if cells.is_isolated(i) { &[] } else { cells.walls.of(i) };
            for wall in walls.iter().filter(|wall| wall.panel != FIXED && !wall.is_closure) {
                let [start, end] = layout.panels[wall.panel as usize];
                let Some(point) = SurfacePoint::between(start, end, wall.fraction) else { continue };
                self.facets.push(MovingFacet { particle: i as u32, wall: *wall });
                let begin = self.work.len();
                self.work.resize(begin + self.size, 0.0);
                bodies.add_force(point, coordinates, wall.facet.normal, &mut self.work[begin..]);
            }
            self.starts.push(self.facets.len() as u32);
        }
    }

    /// Collects the work of a unit pressure of each pocket of gas; their rows begin at `first`.
    pub fn collect_gas<'a>(&mut self, first: usize, works: impl Iterator<Item = &'a [f64]>) {
        self.gas.clear();
        self.gas_work.clear();
        for (k, work) in works.enumerate().filter(|_| self.size > 0) {
            let facet = Facet::new(FIXED, Vector2::x(), 0.0, [0.0, 1.0]);
            let wall = WallFacet { facet, panel: FIXED, segment: FIXED, fraction: 0.0, is_closure: false };
            self.gas.push(MovingFacet { particle: (first + k) as u32, wall });
            self.gas_work.extend_from_slice(work);
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

    /// Solves for the unit pressures of the active coordinates.
    pub fn solve(&mut self, problem: &Problem, matrix: &Matrix, multigrid: &Multigrid) {
        let (active, density) = (&problem.geometry.active, problem.parameters.density);
        self.active.clone_from(active);
        let parameters = &problem.parameters.solve;
        let parameters = SolveParameters { tolerance: TOLERANCE.max(parameters.tolerance), ..parameters.clone() };
        let Self { facets, work, gas, gas_work, size, wide, narrow, .. } = self;
        let size = (*size).max(1);
        let loaded = || facets.iter().zip(work.chunks_exact(size)).chain(gas.iter().zip(gas_work.chunks_exact(size)));
        let system = System { matrix, multigrid, parameters: &parameters };
        let rest = active.len() % WIDE;
        let (most, last) = active.split_at(active.len() - if rest <= NARROW { rest } else { 0 });
        wide.resize_with(most.len().div_ceil(WIDE), Block::default);
        self.iterations = 0;
        for (block, coordinates) in wide.iter_mut().zip(most.chunks(WIDE)) {
            self.iterations += block.solve(loaded(), density, coordinates, &system);
        }
        self.iterations += narrow.solve(loaded(), density, last, &system);
        self.find_added_mass(density);
    }

    /// M from the unit pressures, corrected by their residuals r = b - A P to an error of the square of theirs: the
    /// work of P_k is that of b_l . P_k + P_l . r_k.
    fn find_added_mass(&mut self, density: f64) {
        let mut mass = std::mem::take(&mut self.mass);
        if mass.nrows() != self.size {
            mass = DMatrix::zeros(self.size, self.size);
        }
        mass.fill(0.0);
        let gas = self.gas.iter().zip(self.gas_work.chunks_exact(self.size.max(1)));
        for (facet, work) in self.facets_with_work().chain(gas) {
            let length = facet.wall.facet.length();
            for &column in &self.active {
                let rise = density * facet.wall.facet.height * work[column];
                self.active.iter().for_each(|&row| mass[(row, column)] += length * work[row] * rise);
            }
            for block in &self.wide {
                block.add_work(facet, work, &self.active, &mut mass);
            }
            self.narrow.add_work(facet, work, &self.active, &mut mass);
        }
        let mut partial = std::mem::take(&mut self.partial);
        for block in &self.wide {
            self.wide.iter().for_each(|other| block.add_rest(other, density, &mut partial, &mut mass));
            block.add_rest(&self.narrow, density, &mut partial, &mut mass);
            self.narrow.add_rest(block, density, &mut partial, &mut mass);
        }
        self.narrow.add_rest(&self.narrow, density, &mut partial, &mut mass);
        self.partial = partial;
        self.added_mass.clear();
        self.added_mass.resize(self.size * self.size, 0.0);
        for &column in &self.active {
            for &row in &self.active {
                self.added_mass[row * self.size + column] = 0.5 * (mass[(row, column)] + mass[(column, row)]);
            }
        }
        self.mass = mass;
    }

    /// Adds the pressure that the accelerations `change` of all coordinates cause.
    pub fn add(&self, change: &DVector<f64>, pressures: &mut [f64]) {
        self.wide.iter().for_each(|block| block.add(change, pressures));
        self.narrow.add(change, pressures);
    }
}

/// What the unit pressures are solved with.
struct System<'a> {
    matrix: &'a Matrix,
    multigrid: &'a Multigrid,
    parameters: &'a SolveParameters,
}

impl<const K: usize> Block<K> {
    /// Solves for those of `coordinates`, given the facets on moving walls with their work; returns iterations.
    fn solve<'a>(
        &mut self,
        facets: impl Iterator<Item = (&'a MovingFacet, &'a [f64])>,
        density: f64,
        coordinates: &[usize],
        system: &System,
    ) -> usize {
        self.coordinates.clear();
        self.coordinates.extend(coordinates);
        if coordinates.is_empty() {
            return 0;
        }
        let Self { right, pressure, solver, .. } = self;
        right.clear();
        right.resize(system.matrix.size(), [0.0; K]);
        pressure.resize(right.len(), [0.0; K]);
        for (facet, work) in facets {
            let right = &mut right[facet.particle as usize];
            for (right, &coordinate) in right.iter_mut().zip(coordinates) {
                *right -= density * facet.wall.facet.length() * work[coordinate];
            }
        }
        solver.solve(system.matrix, system.multigrid, right, pressure, Guess::Zero, system.parameters).iterations
    }

    /// Adds what the unit pressures do on a facet.
    fn add_work(&self, facet: &MovingFacet, work: &[f64], active: &[usize], mass: &mut DMatrix<f64>) {
        let length = facet.wall.facet.length();
        for (k, &column) in self.coordinates.iter().enumerate() {
            let force = length * self.pressure[facet.particle as usize][k];
            active.iter().for_each(|&row| mass[(row, column)] -= work[row] * force);
        }
    }

    /// Adds P_l . r_k / rho for the coordinates l of this block and k of another.
    fn add_rest<const L: usize>(
        &self,
        other: &Block<L>,
        density: f64,
        partial: &mut Vec<[f64; WIDE * WIDE]>,
        mass: &mut DMatrix<f64>,
    ) {
        if self.coordinates.is_empty() || other.coordinates.is_empty() {
            return;
        }
        let (pressure, residual) = (&self.pressure, other.solver.residual());
        let sums = parallel::sums(pressure.len(), partial, |i| {
            let mut terms = [0.0; WIDE * WIDE];
            for (l, pressure) in pressure[i].iter().enumerate() {
                let row = &mut terms[l * WIDE..(l + 1) * WIDE];
                row.iter_mut().zip(&residual[i]).for_each(|(term, rest)| *term = pressure * rest);
            }
            terms
        });
        for (l, &row) in self.coordinates.iter().enumerate() {
            for (k, &column) in other.coordinates.iter().enumerate() {
                mass[(row, column)] += sums[l * WIDE + k] / density;
            }
        }
    }

    fn add(&self, change: &DVector<f64>, pressures: &mut [f64]) {
        if self.coordinates.is_empty() {
            return;
        }
        let mut factors = [0.0; K];
        factors.iter_mut().zip(&self.coordinates).for_each(|(factor, &coordinate)| *factor = change[coordinate]);
        parallel::update(pressures, |i, old| {
            old + factors.iter().zip(&self.pressure[i]).map(|(factor, unit)| factor * unit).sum::<f64>()
        });
    }
}
