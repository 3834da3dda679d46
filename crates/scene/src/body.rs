//! Bodies and their flexible members in a scene file. Field names are the keys of the file.

use crate::{Point, Wall, identifier};
use keys::keys;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

keys! {
    /// A rigid body, a cabin for example, with its flexible members.
    pub struct Body {
        /// Name, in reports, in the variables of the FMUs and in key paths.
        name: String;
        /// Place of the centre of gravity of the rigid part at the start \[m\].
        origin: Point = [0.0, 0.0], each in -1e9 to 1e9;
        /// Rotation at the start \[rad\], counter-clockwise.
        angle: f64 = 0.0, in -10.0 to 10.0;
        /// Rigid degrees of freedom that move; the others are not solved for.
        free: Vec<Freedom> = Vec::new();
        /// Mass of the rigid part \[kg/m\]; needed when it moves.
        mass: f64 = 0.0, in 0.0 to 1e15;
        /// Moment of inertia of the rigid part about its centre of gravity \[kg m2/m\]; needed when it rotates.
        inertia: f64 = 0.0, in 0.0 to 1e15;
        /// Springs that pull x, y and theta back to the pose of the scene \[N/m, N/m, N m/rad, per metre of width\].
        springs: [f64; 3] = [0.0; 3], each in 0.0 to 1e15;
        /// Wetted rigid walls in the body frame, fluid on the left when walked along.
        wall: Vec<Wall> = Vec::new();
        /// The flexible members.
        member: Vec<Member> = Vec::new();
        /// Contact of the corners of `wall` with the fluid's fixed walls; without it a run stops where they meet.
        contact: Option<Contact> = None;
        /// A constant load on x, y, theta beside that of the water \[N/m, N/m, N m/m\]; missing ones are 0.
        constant_load: Vec<f64> = Vec::new(), each in -1e15 to 1e15;
    }
}

impl Body {
    /// Whether this is its name, or the word of its name in variables.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || identifier(&self.name) == identifier(name)
    }

    /// Number of modes of all its members.
    pub fn modes(&self) -> usize {
        self.member.iter().map(|member| member.modes).sum()
    }

    /// A point of the body frame in the frame of the scene, as the body stands at the start \[m\].
    pub fn in_the_scene(&self, [x, y]: Point) -> Point {
        let (sin, cos) = self.angle.sin_cos();
        [self.origin[0] + x * cos - y * sin, self.origin[1] + x * sin + y * cos]
    }
}

keys! {
    /// Contact with fixed walls: a corner at the depth delta is pushed out by k delta (1 + damping delta'), without
    /// friction.
    pub struct Contact {
        /// Depth to which one corner sinks under the body's weight \[m\]; decides the stiffness k.
        depth: f64 = 1e-4, in 1e-9 to 1.0;
        /// Share of its speed that an impact loses, over that speed \[s/m\].
        damping: f64 = 5.0, in 0.0 to 1e6;
    }
}

/// A rigid degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    /// Sway, along X.
    X,
    /// Heave, along Y.
    Y,
    /// Roll.
    Theta,
}

keys! {
    /// A flexible member: a beam.
    pub struct Member {
        /// Name, in reports, in the variables of the FMUs and in key paths.
        name: String;
        /// How its ends are held.
        support: Support;
        /// Middle of the undeformed beam in the body frame \[m\]; its axis runs along +y of the body.
        middle: Point, each in -1e9 to 1e9;
        /// Length l \[m\].
        length: f64, above 0;
        /// Thickness h \[m\].
        thickness: f64, above 0;
        /// Density \[kg/m3\].
        density: f64, above 0;
        /// Young's modulus E \[Pa\].
        youngs_modulus: f64, above 0;
        /// Poisson's ratio; given, the plate is in plane strain, E h^3 / (12 (1 - nu^2)).
        poisson_ratio: Option<f64> = None, in 0.0 to 0.5;
        /// Number of modes, 0 for rigid. Of the twentieth a wave is a tenth of the length, far shorter than where a beam is one.
        modes: usize = 3, in 0 to 20;
        /// Largest deflection over length for which the beam counts as linear; a run that exceeds it stops. Missing: 0.1
        /// between fixed ends, 0.6 of a clamped one.
        deflection_limit: Option<f64> = None, in 1e-6 to 1e6;
        /// Damping ratios of the modes; missing ones are 0.
        damping: Vec<f64> = Vec::new(), each in 0.0 to 1.0;
        /// A constant load on the modes beside that of the water \[N per modal unit\]; missing ones are 0.
        constant_load: Vec<f64> = Vec::new(), each in -1e15 to 1e15;
        /// Modal coordinates at the start \[m sqrt(kg/m)\]; missing ones are 0.
        initial_modes: Vec<f64> = Vec::new(), each in -1e15 to 1e15;
    }
}

impl Member {
    /// Bending stiffness EJ per metre of width \[N m\].
    pub fn bending_stiffness(&self) -> f64 {
        let plane_strain = self.poisson_ratio.map_or(1.0, |nu| 1.0 - nu * nu);
        self.youngs_modulus * self.thickness.powi(3) / (12.0 * plane_strain)
    }

    /// Largest deflection over length for which the beam counts as linear.
    pub fn deflection_limit(&self) -> f64 {
        self.deflection_limit.unwrap_or(match self.support {
            Support::FixedFixed => 0.1,
            Support::ClampedFree => 0.6,
        })
    }

    /// Line density rho h \[kg/m per metre of width\].
    pub fn line_density(&self) -> f64 {
        self.density * self.thickness
    }
}

/// How the ends of the beam are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// Both ends clamped.
    FixedFixed,
    /// Clamped at -y, free at +y.
    ClampedFree,
}

keys! {
    /// Time integration of the bodies.
    pub struct Integrator {
        /// Spectral radius at infinite frequency; given, generalised-alpha replaces Newmark.
        rho_infinity: Option<f64> = None, in 0.0 to 1.0;
        /// Newmark's beta.
        beta: f64 = 0.25, in 0.01 to 1.0;
        /// Newmark's gamma.
        gamma: f64 = 0.5, in 0.5 to 1.0;
    }
}
