//! Small scenes that the tests share.
#![allow(dead_code, reason = "every test file uses a part of it")]
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, MpsParameters, Parameters, Scheme, SolveParameters, VoronoiParameters};
use kinematics::{Beam, BeamModes, Body, Support};
use nalgebra::Vector2;

pub fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
    list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
}

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
    let modes = BeamModes::new(Support::ClampedFree, length, 2500.0 * thickness, modes).unwrap();
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
        water: vec![rectangle(0.0, 0.0, 0.146, 0.292)],
        fixed_walls: vec![tank(0.584, 0.8)],
        bodies: (plate(0.292, 0.08, 0.012, 2)).into(),
        probes: vec![Vector2::new(0.285, 0.01).into()],
        ..Geometry::default()
    }
}
