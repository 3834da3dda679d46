//! What a structure is made of and how it is integrated; validated once by [`crate::Solver::new`].

use crate::Error;
use kinematics::{BeamModes, CoordinateLayout};
use nalgebra::Vector2;

/// Bodies with their members, and how they are integrated.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// The bodies, in the order of their coordinates.
    pub bodies: Vec<BodyParameters>,
    /// Acceleration of gravity along -Y of the global frame, m/s2, at least 0.
    pub gravity: f64,
    /// Time integration.
    pub integrator: Integrator,
    /// Bound of the relative residual at which Newton-Raphson stops, in [1e-13, 1e-2]; 1e-11 costs one iteration more
    /// than 1e-6.
    pub tolerance: f64,
    /// Newton-Raphson iterations after which a step is given up, at least 1; 20 is ample.
    pub maximum_iterations: usize,
}

/// A rigid body with its elastic members.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyParameters {
    /// M_R, mass of the rigid part, kg per metre of width. Positive when X or Y is free.
    pub rigid_mass: f64,
    /// I_R, moment of inertia of the rigid part about its centre of gravity o_R, kg m2 per metre of width. Positive
    /// when theta is free.
    pub rigid_inertia: f64,
    /// Angle of the body frame in the scene, rad, counter-clockwise; theta is counted from it.
    pub angle: f64,
    /// The elastic members.
    pub members: Vec<BeamParameters>,
    /// Which of X, Y and theta move. A locked coordinate is not solved for: the system has a row less.
    pub free: [bool; 3],
    /// Springs that pull X, Y and theta back to the scene's pose, N/m, N/m and N m/rad per metre of width, at least 0.
    pub springs: [f64; 3],
    /// Contact with fixed walls; none where the body cannot meet any.
    pub contact: Option<ContactParameters>,
}

/// An elastic beam of the body. With zero modes it is a rigid bulkhead with its mass.
#[derive(Debug, Clone, PartialEq)]
pub struct BeamParameters {
    /// Shape functions, length and line density.
    pub modes: BeamModes,
    /// o_F, the middle of the beam, in the body frame, m.
    pub middle: Vector2<f64>,
    /// EJ, N m2 per metre of width: E h^3/12, or E h^3/(12 (1 - nu^2)) in plane strain.
    ///
    /// Misprint in the paper: table 1 of the paper has the thickness 0.04 mm, which fits its frequencies for no bulkhead of
    /// that cabin.
    pub bending_stiffness: f64,
    /// Largest deflection for which the linear beam counts as valid, m; a step that would exceed it is an error.
    pub deflection_limit: f64,
    /// zeta of every mode (share of critical damping, at least 0), or empty for none.
    pub damping_ratios: Vec<f64>,
}

/// Contact of the cabin's corners with fixed walls: F = k delta (1 + a delta') at a depth delta.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactParameters {
    /// k, N/m per metre of width.
    pub stiffness: f64,
    /// a, s/m: an impact of speed v loses about the share a v of its speed, all of it at most.
    pub damping: f64,
    /// Depth up to which a corner counts as behind a wall, m; farther it stands behind another one's back.
    pub reach: f64,
    /// Corners in the body frame, m.
    pub corners: Vec<Vector2<f64>>,
    /// Straight walls from start to end, seen from the place of o_R in the scene, m, with the free side on the left.
    pub walls: Vec<[Vector2<f64>; 2]>,
}

/// Time integration.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case", tag = "method")]
pub enum Integrator {
    /// Newmark (1959) with gamma >= 1/2 and 2 beta >= gamma (unconditionally stable). 1/4 and 1/2 is the average
    /// acceleration: second order, no damping.
    Newmark {
        /// Weight of the end acceleration in the displacement.
        beta: f64,
        /// Weight of the end acceleration in the velocity; above 1/2 it damps and drops to first order.
        gamma: f64,
    },
    /// Generalised-alpha (Chung and Hulbert 1993): second order, damps high frequencies only.
    GeneralisedAlpha {
        /// Spectral radius at infinite frequency, in [0, 1]: 1 keeps, 0 annihilates in one step.
        rho_infinity: f64,
    },
}

impl Default for Integrator {
    fn default() -> Self {
        Self::Newmark { beta: 0.25, gamma: 0.5 }
    }
}

impl Parameters {
    /// Which coordinate is what.
    pub fn layout(&self) -> CoordinateLayout {
        let modes = |body: &BodyParameters| body.members.iter().map(|beam| beam.modes.count()).collect();
        CoordinateLayout::new(self.bodies.iter().map(modes).collect())
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        check("the gravity [m/s2]", self.gravity, self.gravity >= 0.0, "at least 0 and finite")?;
        check(
            "the tolerance of Newton-Raphson",
            self.tolerance,
            (1e-13..=1e-2).contains(&self.tolerance),
            "from 1e-13 to 1e-2",
        )?;
        let iterations = self.maximum_iterations as f64;
        check("the largest number of iterations", iterations, iterations >= 1.0, "at least 1")?;
        self.bodies.iter().try_for_each(BodyParameters::validate)?;
        self.integrator.validate()
    }
}

impl BodyParameters {
    fn validate(&self) -> Result<(), Error> {
        let inertial = |what: &str, value: f64, moves: bool, range: &'static str| {
            let inside = if moves { value > 0.0 } else { value >= 0.0 };
            check(what, value, inside, if moves { range } else { "at least 0 and finite" })
        };
        let [x, y, theta] = self.free;
        inertial("the rigid mass [kg/m]", self.rigid_mass, x || y, "positive and finite when x or y is free")?;
        let what = "the rigid moment of inertia [kg m2/m]";
        inertial(what, self.rigid_inertia, theta, "positive and finite when theta is free")?;
        check("the angle [rad]", self.angle, true, "finite")?;
        for (name, &spring) in ["x", "y", "theta"].iter().zip(&self.springs) {
            check(&format!("the spring on {name}"), spring, spring >= 0.0, "at least 0 and finite")?;
        }
        self.members.iter().try_for_each(BeamParameters::validate)?;
        self.contact.as_ref().map_or(Ok(()), ContactParameters::validate)
    }
}

/// Places along a beam at which its deflection is checked.
const STATIONS: usize = 8;

impl BeamParameters {
    /// Refuses a deflection beyond what a linear beam bears.
    pub(crate) fn check_deflection(&self, amplitudes: &[f64], time: f64) -> Result<(), Error> {
        let limit = self.deflection_limit;
        for part in 1..=STATIONS {
            let station = self.modes.length() * part as f64 / STATIONS as f64;
            // The outputs have it positive along +x of the body, eta is so along -x.
            let deflection = -self.modes.deflection(station, amplitudes);
            if deflection.abs() > limit {
                return Err(Error::Deflection { deflection, station, time, limit });
            }
        }
        Ok(())
    }

    fn validate(&self) -> Result<(), Error> {
        check("the beam's middle x [m]", self.middle.x, true, "finite")?;
        check("the beam's middle y [m]", self.middle.y, true, "finite")?;
        let stiffness = self.bending_stiffness;
        check(
            "the bending stiffness [N m2/m]",
            stiffness,
            stiffness > 0.0,
            "positive and finite; a rigid beam has 0 modes instead",
        )?;
        let limit = self.deflection_limit;
        check("the limit of the deflection [m]", limit, limit > 0.0, "positive and finite")?;
        let (expected, got) = (self.modes.count(), self.damping_ratios.len());
        if got != 0 && got != expected {
            return Err(Error::Length { what: "the list of damping ratios", expected, got });
        }
        for (index, &ratio) in self.damping_ratios.iter().enumerate() {
            check(&format!("the damping ratio of mode {}", index + 1), ratio, ratio >= 0.0, "at least 0 and finite")?;
        }
        Ok(())
    }
}

impl Integrator {
    fn validate(&self) -> Result<(), Error> {
        match *self {
            Self::Newmark { beta, gamma } => {
                check("gamma of Newmark", gamma, (0.5..=1.0).contains(&gamma), "from 0.5 to 1")?;
                check(
                    "beta of Newmark",
                    beta,
                    2.0 * beta >= gamma && beta <= 1.0,
                    "from gamma/2 (unconditional stability) to 1",
                )
            }
            Self::GeneralisedAlpha { rho_infinity } => check(
                "rho_infinity of generalised-alpha",
                rho_infinity,
                (0.0..=1.0).contains(&rho_infinity),
                "from 0 to 1",
            ),
        }
    }
}

pub(crate) fn check(what: &str, value: f64, inside: bool, range: &'static str) -> Result<(), Error> {
    if inside && value.is_finite() { Ok(()) } else { Err(Error::Parameter { what: what.to_string(), value, range }) }
}
