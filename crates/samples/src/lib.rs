//! Small set-ups with known answers, for tests, examples and benchmarks alike.

use fluid::{Geometry, MpsParameters, Parameters, Scheme, SolveParameters, VoronoiParameters};
use kinematics::{Beam, BeamModes, Body, Support};
use nalgebra::Vector2;

/// Points from pairs of numbers.
pub fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
    list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
}

/// A rectangle from its lower left to its upper right corner.
pub fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Vector2<f64>> {
    points(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
}

/// The scheme of the paper with its defaults.
pub fn mps() -> Scheme {
    Scheme::Mps(MpsParameters::default())
}

/// The scheme `voronoi` with its defaults.
pub fn voronoi() -> Scheme {
    Scheme::Voronoi(VoronoiParameters::default())
}

/// Water under gravity in a scheme.
pub fn parameters(scheme: Scheme, spacing: f64, tolerance: f64, threads: usize) -> Parameters {
    Parameters {
        spacing,
        scheme,
        solve: SolveParameters { tolerance, maximum_iterations: 500 },
        threads,
        ..Parameters::default()
    }
}

/// An open tank from x = 0 to `width`.
pub fn tank(width: f64, height: f64) -> Vec<Vector2<f64>> {
    points(&[(0.0, height), (0.0, 0.0), (width, 0.0), (width, height)])
}

/// A clamped-free plate standing on the floor with its middle line at `x`.
pub fn plate(x: f64, length: f64, thickness: f64, modes: usize) -> Body {
    let modes = BeamModes::new(Support::ClampedFree, length, 2500.0 * thickness, modes);
    let modes = modes.unwrap_or_else(|error| panic!("a plate of {length} m: {error}"));
    Body {
        origin: Vector2::zeros(),
        angle: 0.0,
        walls: Vec::new(),
        members: vec![Beam { middle: Vector2::new(x, 0.5 * length), thickness, modes }],
    }
}

/// The column and plate of the dam break on an elastic plate.
pub fn dam_break_plate() -> Geometry {
    Geometry {
        bodies: plate(0.292, 0.08, 0.012, 2).into(),
        probes: vec![Vector2::new(0.285, 0.01).into()],
        ..Column::KOSHIZUKA.geometry(0.8)
    }
}

/// A column of water at the left end of a tank, about to break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Width \[m\].
    pub width: f64,
    /// Height \[m\].
    pub height: f64,
    /// Width of the tank \[m\].
    pub tank: f64,
}

/// Weight of a volume of the samples' water \[N/m3\].
pub const WEIGHT: f64 = 1000.0 * 9.81;

impl Column {
    /// That of Koshizuka and Oka (1996).
    pub const KOSHIZUKA: Self = Self { width: 0.146, height: 0.292, tank: 0.584 };

    /// Water and an open tank with walls of this height \[m\].
    pub fn geometry(&self, walls: f64) -> Geometry {
        Geometry {
            water: vec![rectangle(0.0, 0.0, self.width, self.height)],
            fixed_walls: vec![tank(self.tank, walls)],
            ..Geometry::default()
        }
    }

    /// Area of the water \[m2\].
    pub fn area(&self) -> f64 {
        self.width * self.height
    }

    /// Weight of the water \[N/m\].
    pub fn weight(&self) -> f64 {
        WEIGHT * self.area()
    }

    /// Potential energy above the floor at the start \[J/m\].
    pub fn potential_energy(&self) -> f64 {
        0.5 * self.weight() * self.height
    }

    /// Speed of a fall from the top to the floor \[m/s\].
    pub fn falling_speed(&self) -> f64 {
        (2.0 * 9.81 * self.height).sqrt()
    }
}
