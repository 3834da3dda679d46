//! The types that a scene file deserialises into. Field names are the keys of the file.

use crate::{Body, Check, Gas, Gauge, Integrator, Member, Probe, Quick, Region};
use fluid::{MpsParameters, SolveParameters, VoronoiParameters};
use keys::keys;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A point or vector \[m\] as written in the file.
pub type Point = [f64; 2];

keys! {
    /// A whole scene.
    pub struct Scene {
        /// One line that names the case.
        title: String;
        /// Where set-up and reference come from.
        source: String = String::new();
        /// What differs from the source.
        differs: String = String::new();
        /// Acceleration of gravity \[m/s2\].
        gravity: Point = [0.0, -9.81], each in -1e6 to 1e6;
        /// Duration and communication step.
        run: Run;
        /// What is written and how often.
        output: Output = Output::default();
        /// The water and its walls; absent in a scene of bodies alone.
        fluid: Option<Fluid> = None;
        /// Gas in what is closed off from the open air; absent where all space without water is open.
        gas: Option<Gas> = None;
        /// Bodies with their flexible members; none in a scene of the fluid alone.
        body: Vec<Body> = Vec::new();
        /// Time integration of the bodies.
        integrator: Integrator = Integrator::default();
        /// How the two are coupled.
        coupling: Coupling = Coupling::default();
        /// What a run is watched for.
        watch: Watch = Watch::default();
        /// Figures that the program computes of its own result.
        check: Vec<Check> = Vec::new();
        /// The same coarser and shorter, for tests.
        quick: Quick = Quick::default();
    }
}

impl Scene {
    /// The flexible members of all bodies.
    pub fn members(&self) -> impl Iterator<Item = &Member> {
        self.body.iter().flat_map(|body| &body.member)
    }

    /// Whether the water can move anything: a free degree of freedom, or a mode.
    pub fn moves(&self) -> bool {
        self.body.iter().any(|body| !body.free.is_empty() || body.modes() > 0)
    }
}

/// Duration and communication step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// End of the run \[s\]; it starts at 0.
    pub end: f64,
    /// Communication step \[s\]: the step of the bodies and the interval of results.
    pub communication_step: f64,
}

keys! {
    /// What is written and how often.
    pub struct Output {
        /// Time between field frames \[s\]; 0 writes none.
        interval: f64 = 0.02, at least 0.0;
        /// Time between rows of the results \[s\]; 0 writes every communication step.
        record_interval: f64 = 0.0, at least 0.0;
        /// Wall-clock time between checkpoints, from which a run can be resumed \[s\]; 0 writes none.
        checkpoint_interval: f64 = 30.0, in 0.0 to 1e9;
        /// Variables to plot, by name; empty plots a default choice.
        plot: Vec<String> = Vec::new();
    }
}

keys! {
    /// What a run is watched for. What is found is a warning at once and counts as a limit that was missed. Energy and speed
    /// are watched in scenes; of the FMUs of a case nobody knows what drives them.
    pub struct Watch {
        /// Share of the energy of the run by which water and bodies may gain energy that nothing supplied; 0 does not
        /// look. The energy of the run is the largest kinetic energy so far, the water's potential energy at the start
        /// above the lowest point of the scene, and the range of that of the bodies.
        energy: f64 = 0.01, in 0.0 to 1e3;
        /// Share of the particles that may leave the scene: 1 where water is meant to run out.
        lost: f64 = 0.0, in 0.0 to 1.0;
        /// Largest speed of a particle over the one that its start, a fall through the scene and the body give; 0 does not
        /// look. Jets of an impact are several times faster than the water that hits.
        speed: f64 = 5.0, in 0.0 to 1e6;
    }
}

keys! {
    /// The water, its walls, and the scheme.
    pub struct Fluid {
        /// Density \[kg/m3\].
        density: f64 = 1000.0, above 0;
        /// Particle spacing l0 \[m\]: halving it quadruples the particles and about octuples the run time.
        spacing: f64, above 0;
        /// Discretisation.
        scheme: Scheme = Scheme::Voronoi;
        /// Parameters of the scheme `voronoi`.
        voronoi: VoronoiParameters = VoronoiParameters::default();
        /// Parameters of the scheme `mps`.
        mps: MpsParameters = MpsParameters::default();
        /// Pressure solver.
        solve: SolveParameters = SolveParameters::default();
        /// Threads of the solver's own pool; 0 takes all processors.
        threads: usize = 0, in 0 to 1024;
        /// Bodies of water at the start, each a closed polygon filled with particles.
        water: Vec<Polygon>;
        /// Motion of the water at the start.
        start: Start = Start::default();
        /// Attraction of the water to the origin: an acceleration of minus this times the position \[1/s2\].
        attraction: f64 = 0.0, in -1e6 to 1e6;
        /// Zones in which waves die out, for the ends of a tank that should not echo.
        damping: Vec<DampingZone> = Vec::new();
        /// Shaking of the tank, seen from a frame that moves with it.
        shaking: Shaking = Shaking::default();
        /// Fixed walls, fluid on the left when walked along.
        wall: Vec<Wall> = Vec::new();
        /// Pressure probes.
        probe: Vec<Probe> = Vec::new();
        /// Gauges of the water level.
        gauge: Vec<Gauge> = Vec::new();
        /// Regions whose water mass is reported.
        region: Vec<Region> = Vec::new();
    }
}

keys! {
    /// Motion of the water at the start: u = `velocity` + `gradient` r. Incompressible water is slower than sound in it by far.
    pub struct Start {
        /// Velocity at the origin \[m/s\].
        velocity: Point = [0.0, 0.0], each in -1e5 to 1e5;
        /// Velocity gradient \[1/s\], row by row: du/dx, du/dy; dv/dx, dv/dy.
        gradient: [Point; 2] = [[0.0, 0.0], [0.0, 0.0]], each in -1e5 to 1e5;
        /// Largest random displacement of a particle along X and Y, in spacings (0 to 0.2). Runs that differ in the seed
        /// alone say how far an impact repeats.
        jitter: f64 = 0.0, in 0.0 to 0.2;
        /// Number that decides the random displacements.
        seed: u64 = 0;
    }
}

keys! {
    /// A zone that slows the water: du/dt = -rate u, growing with the square of the way from `from` to `to`, full beyond.
    pub struct DampingZone {
        /// X where the damping begins \[m\].
        from: f64, in -1e9 to 1e9;
        /// X where it is full \[m\]; on either side of `from`.
        to: f64, in -1e9 to 1e9;
        /// Rate there \[1/s\]: some times the frequency of the longest wave that should die out.
        rate: f64, in 0.0 to 1e6;
    }
}

keys! {
    /// Displacement `amplitude` cos(2 pi t / `period`) of the tank from t = 0 on. The scene is seen from the tank: the
    /// water feels the acceleration `amplitude` (2 pi / `period`)^2 cos(2 pi t / `period`).
    pub struct Shaking {
        /// Amplitude \[m\]; zero for none.
        amplitude: Point = [0.0, 0.0], each in -1e6 to 1e6;
        /// Period \[s\].
        period: f64 = 1.0, in 1e-6 to 1e9;
    }
}

/// Discretisation of the fluid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Voronoi cells of the particles as weights: accurate, quiet and without numbers to tune.
    #[default]
    Voronoi,
    /// The moving particle semi-implicit method as the paper states it.
    Mps,
}

impl Scheme {
    /// The word in the scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Voronoi => "voronoi",
            Self::Mps => "mps",
        }
    }
}

/// A closed polygon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// Corners in order.
    pub polygon: Vec<Point>,
}

/// A polyline of wall, fluid on the left when walked along.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Corners in order.
    pub points: Vec<Point>,
    /// Whether the last corner joins the first.
    #[serde(default)]
    pub closed: bool,
}

keys! {
    /// How the water and the bodies are coupled.
    pub struct Coupling {
        /// Method.
        method: Method = Method::Auto;
        /// For `explicit`: whether the bodies take the water's added mass into their equations.
        added_mass: bool = true;
        /// Relaxation factor: of `constant`, and of the first iteration of the others.
        relaxation: f64 = 0.2, in 1e-6 to 1.0;
        /// Residual allowed relative to the exchanged quantity.
        tolerance_relative: f64 = 1e-6, in 0.0 to 1.0;
        /// Residual allowed in the quantity's own unit.
        tolerance_absolute: f64 = 1e-6, at least 0.0;
        /// Iterations after which the step is halved.
        maximum_iterations: usize = 30, in 1 to 1e4;
        /// Step below which the run stops with an error \[s\]; 0 takes 1/64 of the communication step.
        smallest_step: f64 = 0.0, at least 0.0;
        /// Order of the extrapolation that starts a step: 0, 1 or 2. Missing: 1 for methods that iterate, and 0 for an
        /// explicit exchange, which an extrapolated load makes unstable at a third of the mass ratio.
        predictor_order: Option<usize> = None, in 0 to 2;
        /// Past steps whose columns iqn_ils reuses.
        reused_steps: usize = 4, in 0 to 100;
    }
}

/// Coupling method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// `newton` if every participant gives directional derivatives, `explicit` if one saves no states, else `iqn_ils`.
    Auto,
    /// One pass per step.
    #[serde(alias = "none")]
    Explicit,
    /// Newton's method with the interface Jacobian from directional derivatives (Sicklinger et al. 2014).
    Newton,
    /// Fixed-point iteration with a constant relaxation factor.
    Constant,
    /// Fixed-point iteration with Aitken's factor.
    Aitken,
    /// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote et al. 2009).
    IqnIls,
}
