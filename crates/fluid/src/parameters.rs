//! Parameters of the fluid solver and the geometry it works on, validated once.

use crate::Error;
use crate::gas::GasParameters;
use crate::linear::SolveParameters;
use keys::keys;
use kinematics::BodySet;
use nalgebra::{Matrix2, Vector2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Numbers and methods.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Density rho \[kg/m3\].
    pub density: f64,
    /// Gravity \[m/s2\].
    pub gravity: Vector2<f64>,
    /// Attraction to the origin: an acceleration of minus this times the position \[1/s2\].
    pub attraction: f64,
    /// Shaking of the whole scene, seen from a frame that moves with it.
    pub shaking: Shaking,
    /// Zones in which waves die out; empty for none.
    pub damping: Vec<DampingZone>,
    /// Particle spacing l0 \[m\].
    pub spacing: f64,
    /// Discretisation.
    pub scheme: Scheme,
    /// Pressure solver.
    pub solve: SolveParameters,
    /// Gas in what is closed off from the open air; none takes all space without water for open air.
    pub gas: Option<GasParameters>,
    /// Threads of the solver's own pool; 0 takes all processors.
    pub threads: usize,
}

impl Default for Parameters {
    /// Water under gravity in the scheme `voronoi` at its defaults, spacing 10 mm, on all processors.
    fn default() -> Self {
        Self {
            density: 1000.0,
            gravity: Vector2::new(0.0, -9.81),
            attraction: 0.0,
            shaking: Shaking::default(),
            damping: Vec::new(),
            spacing: 0.01,
            scheme: Scheme::Voronoi(VoronoiParameters::default()),
            solve: SolveParameters::default(),
            gas: None,
            threads: 0,
        }
    }
}

/// Displacement `amplitude` cos(2 pi t / `period`) of tank and frame from t = 0 on: water feels the acceleration
/// `amplitude` (2 pi / `period`)^2 cos(2 pi t / `period`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaking {
    /// Amplitude \[m\]; zero for none.
    pub amplitude: Vector2<f64>,
    /// Period \[s\], above 0.
    pub period: f64,
}

impl Default for Shaking {
    fn default() -> Self {
        Self { amplitude: Vector2::zeros(), period: 1.0 }
    }
}

impl Shaking {
    /// Acceleration of the water in the moving frame at a time \[m/s2\].
    pub fn acceleration(&self, time: f64) -> Vector2<f64> {
        let frequency = std::f64::consts::TAU / self.period;
        self.amplitude * (frequency * frequency * (frequency * time).cos())
    }
}

/// A zone in which the water is slowed, so that waves die out before the end of a tank: the rate grows with the square
/// of the way from `from` to `to`, and stays at its full value beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingZone {
    /// X where the damping begins \[m\].
    pub from: f64,
    /// X where it is full \[m\]; on either side of `from`.
    pub to: f64,
    /// Rate there \[1/s\]: du/dt = -rate u.
    pub rate: f64,
}

impl DampingZone {
    /// Rate at a place \[1/s\].
    pub fn rate_at(&self, x: f64) -> f64 {
        let way = ((x - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        self.rate * way * way
    }

    fn validate(&self) -> Result<(), Error> {
        within("damping.from", self.from, -1e9, 1e9)?;
        within("damping.to", self.to, -1e9, 1e9)?;
        within("damping.rate", self.rate, 0.0, 1e6)?;
        if self.from != self.to {
            return Ok(());
        }
        Err(Error::Parameter { name: "damping.to", got: self.to, expected: "another X than damping.from".to_string() })
    }
}

/// Discretisation.
#[derive(Debug, Clone, PartialEq)]
pub enum Scheme {
    /// The semi-implicit method as the paper states it.
    Mps(MpsParameters),
    /// Voronoi cells as weights.
    Voronoi(VoronoiParameters),
}

/// Source term of the pressure Poisson equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Divergence and density deviation mixed with a fixed weight `alpha` (the paper's equation 5).
    Mixed,
    /// Density deviation weighted with its own magnitude (Sun et al. 2015).
    Adaptive,
}

keys! {
    /// Parameters of the scheme `mps`.
    pub struct MpsParameters {
        /// Effective radius r_e in spacings: larger is smoother and slower.
        influence_radius: f64 = 3.1, in 2.1 to 4.0;
        /// Share of the density error removed per step: larger holds the volume better and rings more.
        alpha: f64 = 0.01, in 0.0 to 1.0;
        /// Form of the source term.
        source: Source = Source::Mixed;
        /// Courant number u dt / l0.
        courant: f64 = 0.2, in 0.01 to 0.5;
        /// Strength of particle shifting; 0 switches it off.
        shifting: f64 = 0.03, in 0.0 to 0.5;
        /// Whether negative pressures pull particles together. Without, they count as zero in the gradient, as usual for
        /// this scheme: its one-sided gradient turns a pressure minimum into a repulsion of everything around it. Loads
        /// always use the pressure as solved, since coupling relies on their being affine in the wall's acceleration.
        tension: bool = false;
        /// Distance in spacings below which two approaching particles collide.
        collision_distance: f64 = 0.85, in 0.0 to 1.0;
        /// Coefficient of restitution of such a collision.
        restitution: f64 = 0.2, in 0.0 to 1.0;
        /// A particle whose neighbours' centroid is farther than this, in spacings, lies on the surface if nothing stands
        /// on the other side.
        surface_deviation: f64 = 0.2, in 0.0 to 1.0;
    }
}

keys! {
    /// Parameters of the scheme `voronoi`. No scene needs others than the defaults.
    pub struct VoronoiParameters {
        /// Share of the error of a cell's area removed per step: larger holds areas closer and is noisier.
        alpha: f64 = 0.01, in 0.0 to 1.0;
        /// Courant number u dt / l0.
        courant: f64 = 0.4, in 0.01 to 1.0;
        /// Strength of the shift of particles to the centroids of their cells; 0 switches it off.
        shifting: f64 = 1.0, in 0.0 to 10.0;
        /// Strength of the shift away from particles nearer than 0.9 spacings; 0 switches it off.
        repulsion: f64 = 20.0, in 0.0 to 100.0;
        /// Strength of the shift towards neighbours with more room; 0 switches it off.
        spreading: f64 = 30.0, in 0.0 to 200.0;
        /// Strength of the smoothing of velocities that neighbours do not explain; 0 switches it off.
        smoothing: f64 = 1.0, in 0.0 to 10.0;
        /// Pressure at the highest point of water that fills a closed tank \[Pa\]: nothing else determines it.
        enclosed_pressure: f64 = 0.0, in -1e12 to 1e12;
    }
}

/// A place where the pressure is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// Place in the scene's pose \[m\].
    pub place: Vector2<f64>,
    /// The body that it moves with, by its index; none for the scene.
    pub on_body: Option<usize>,
    /// Length of the patch on a wall over which the pressure is averaged \[m\]; 0 for one spacing.
    pub size: f64,
    /// Pressure beyond which its impulse is added up \[Pa\]; infinite for none.
    pub threshold: f64,
}

impl From<Vector2<f64>> for Probe {
    fn from(place: Vector2<f64>) -> Self {
        Self { place, on_body: None, size: 0.0, threshold: f64::INFINITY }
    }
}

/// A place where gas is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chamber {
    /// Place in the scene's pose \[m\].
    pub place: Vector2<f64>,
    /// The body that it moves with, by its index; none for the scene.
    pub on_body: Option<usize>,
    /// Absolute pressure of its gas at the start \[Pa\]; none for that of the open air.
    pub pressure: Option<f64>,
}

/// An opening through which gas leaves or enters a pocket.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vent {
    /// A place in the pocket, in the scene's pose \[m\].
    pub place: Vector2<f64>,
    /// A place in the pocket at its other end; none for the open air.
    pub to: Option<Vector2<f64>>,
    /// The body that it moves with, by its index; none for the scene.
    pub on_body: Option<usize>,
    /// Area per width \[m\].
    pub area: f64,
    /// Discharge coefficient.
    pub discharge: f64,
}

/// A region whose water is weighed.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Corners in the scene's pose \[m\].
    pub polygon: Vec<Vector2<f64>>,
    /// The body that it moves with, by its index; none for the scene.
    pub on_body: Option<usize>,
}

/// What there is besides numbers. Coordinates in metres.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// Bodies of water at the start, closed polygons.
    pub water: Vec<Vec<Vector2<f64>>>,
    /// Velocity of the water at the start, affine in the place.
    pub start: AffineVelocity,
    /// Disorder of the particles at the start.
    pub jitter: Jitter,
    /// Fixed walls, fluid on the left when walked along.
    pub fixed_walls: Vec<Vec<Vector2<f64>>>,
    /// The moving bodies.
    pub bodies: BodySet,
    /// Generalised coordinates that answer to the load. Only these have an added mass.
    pub active: Vec<usize>,
    /// Points where the pressure is reported.
    pub probes: Vec<Probe>,
    /// Regions whose water mass is reported, closed polygons.
    pub regions: Vec<Region>,
    /// Abscissae where the water level is reported \[m\].
    pub gauges: Vec<f64>,
    /// Places where gas is read.
    pub chambers: Vec<Chamber>,
    /// Openings through which gas flows.
    pub vents: Vec<Vent>,
}

/// A random displacement of every particle at the start. Runs that differ in the seed alone say how far an impact
/// repeats.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Jitter {
    /// Largest displacement along X and Y, in spacings, 0 (none) to 0.2.
    pub amplitude: f64,
    /// Number that decides the displacements.
    pub seed: u64,
}

impl Jitter {
    pub(crate) fn validate(&self) -> Result<(), Error> {
        within("start.jitter", self.amplitude, 0.0, 0.2)
    }

    /// Displaces particles; the same seed gives the same places on every machine.
    pub fn apply(&self, positions: &mut [Vector2<f64>], spacing: f64) {
        if self.amplitude == 0.0 {
            return;
        }
        let mut random = Pcg64Mcg::seed_from_u64(self.seed);
        let mut share = || self.amplitude * spacing * random.random_range(-1.0..1.0);
        for position in positions {
            *position += Vector2::new(share(), share());
        }
    }
}

/// A velocity field u(r) = `constant` + `gradient` r.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AffineVelocity {
    /// Velocity at the origin \[m/s\].
    pub constant: Vector2<f64>,
    /// d u_a / d x_b \[1/s\].
    pub gradient: Matrix2<f64>,
}

impl AffineVelocity {
    /// Velocity at a place \[m/s\].
    pub fn at(&self, place: &Vector2<f64>) -> Vector2<f64> {
        self.constant + self.gradient * place
    }
}

fn within(name: &'static str, got: f64, low: f64, high: f64) -> Result<(), Error> {
    if got.is_finite() && (low..=high).contains(&got) {
        return Ok(());
    }
    Err(Error::Parameter { name, got, expected: format!("a number from {low} to {high}") })
}

impl Parameters {
    /// Body force per mass at a place and time: gravity, attraction and shaking \[m/s2\].
    #[inline]
    pub fn body_force(&self, place: &Vector2<f64>, time: f64) -> Vector2<f64> {
        self.uniform_force(time) - place * self.attraction
    }

    /// The part of the body force that is the same everywhere \[m/s2\].
    #[inline]
    pub fn uniform_force(&self, time: f64) -> Vector2<f64> {
        if self.shaking.amplitude == Vector2::zeros() {
            return self.gravity;
        }
        self.gravity + self.shaking.acceleration(time)
    }

    /// Potential energy per mass in gravity above the origin, and in the attraction \[m2/s2\].
    #[inline]
    pub fn potential(&self, place: &Vector2<f64>) -> f64 {
        0.5 * self.attraction * place.norm_squared() - self.gravity.dot(place)
    }

    /// Change of that potential energy on a way that ends at `place`; exact, the potential is quadratic.
    #[inline]
    pub fn potential_on(&self, way: &Vector2<f64>, place: &Vector2<f64>) -> f64 {
        ((place - way * 0.5) * self.attraction - self.gravity).dot(way)
    }

    /// Share of its velocity that water at a place keeps over `duration` \[s\].
    #[inline]
    pub fn kept_velocity(&self, place: &Vector2<f64>, duration: f64) -> f64 {
        let rate: f64 = self.damping.iter().map(|zone| zone.rate_at(place.x)).sum();
        (-rate * duration).exp()
    }

    /// Checks every number against its range, but for those of the scheme: its discretisation checks them.
    pub fn validate(&self) -> Result<(), Error> {
        within("density", self.density, f64::MIN_POSITIVE, f64::MAX)?;
        within("spacing", self.spacing, f64::MIN_POSITIVE, f64::MAX)?;
        within("gravity.x", self.gravity.x, -1e6, 1e6)?;
        within("gravity.y", self.gravity.y, -1e6, 1e6)?;
        within("attraction", self.attraction, -1e6, 1e6)?;
        within("shaking.amplitude.x", self.shaking.amplitude.x, -1e6, 1e6)?;
        within("shaking.amplitude.y", self.shaking.amplitude.y, -1e6, 1e6)?;
        within("shaking.period", self.shaking.period, 1e-6, 1e9)?;
        self.damping.iter().try_for_each(DampingZone::validate)?;
        self.gas.iter().try_for_each(GasParameters::check)?;
        Ok(self.solve.check()?)
    }
}
