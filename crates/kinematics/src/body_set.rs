//! All bodies of a scene, on one vector of generalised coordinates.

use crate::{Body, CoordinateLayout, Error, MaterialPoint, Motion, Panel};
use nalgebra::{DVector, Vector2};

/// A point of the surface of one of the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Index of the body.
    pub body: usize,
    /// The point on it.
    pub point: MaterialPoint,
}

impl SurfacePoint {
    /// The point at `fraction` of the way from `start` to `end` along the material; none where no material line joins
    /// them.
    pub fn between(start: Self, end: Self, fraction: f64) -> Option<Self> {
        if start.body != end.body {
            return None;
        }
        let point = MaterialPoint::between(start.point, end.point, fraction)?;
        Some(Self { body: start.body, point })
    }
}

/// The bodies of a scene; none where everything stands still.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BodySet {
    bodies: Vec<Body>,
    layout: CoordinateLayout,
}

impl From<Body> for BodySet {
    fn from(body: Body) -> Self {
        Self::new(vec![body])
    }
}

impl From<Option<Body>> for BodySet {
    fn from(body: Option<Body>) -> Self {
        Self::new(body.into_iter().collect())
    }
}

impl BodySet {
    /// These bodies.
    pub fn new(bodies: Vec<Body>) -> Self {
        let modes = |body: &Body| body.members.iter().map(|beam| beam.modes.count()).collect();
        let layout = CoordinateLayout::new(bodies.iter().map(modes).collect());
        Self { bodies, layout }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The bodies, in the order of their coordinates.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Which coordinate is what.
    pub fn layout(&self) -> &CoordinateLayout {
        &self.layout
    }

    /// All of them as they stand in the scene.
    pub fn at_rest(&self) -> Motion {
        Motion::zeros(self.layout.size())
    }

    /// Checks every number once.
    ///
    /// # Errors
    /// As [`Body::validate`].
    pub fn validate(&self) -> Result<(), Error> {
        self.bodies.iter().try_for_each(Body::validate)
    }

    /// Place in the global frame, m.
    pub fn position(&self, at: SurfacePoint, motion: &Motion) -> Vector2<f64> {
        self.place(at, &motion.position)
    }

    /// Place in the global frame, m, from the coordinates alone.
    pub fn place(&self, at: SurfacePoint, coordinates: &DVector<f64>) -> Vector2<f64> {
        self.bodies[at.body].place(at.point, &coordinates.as_slice()[self.layout.body(at.body)])
    }

    /// Where a point, m, that stands at `place` in the scene's pose is carried to by the rigid motion of a body.
    pub fn carry(&self, body: usize, place: &Vector2<f64>, coordinates: &DVector<f64>) -> Vector2<f64> {
        self.bodies[body].carry(place, &coordinates.as_slice()[self.layout.body(body)])
    }

    /// Velocity in the global frame, m/s.
    pub fn velocity(&self, at: SurfacePoint, motion: &Motion) -> Vector2<f64> {
        self.bodies[at.body].velocity(at.point, motion.view(self.layout.body(at.body)))
    }

    /// Acceleration in the global frame, m/s2.
    pub fn acceleration(&self, at: SurfacePoint, motion: &Motion) -> Vector2<f64> {
        self.bodies[at.body].acceleration(at.point, motion.view(self.layout.body(at.body)))
    }

    /// Adds the virtual work of a `force` (N per metre of width, global frame) on a point to the generalised `load` of all
    /// coordinates.
    pub fn add_force(&self, at: SurfacePoint, coordinates: &DVector<f64>, force: Vector2<f64>, load: &mut [f64]) {
        let own = self.layout.body(at.body);
        self.bodies[at.body].add_force(at.point, &coordinates.as_slice()[own.clone()], force, &mut load[own]);
    }

    /// The whole surface in panels no longer than `longest` m in the undeformed bodies, as [`Body::panels`], each with its
    /// body.
    pub fn panels(&self, longest: f64) -> impl Iterator<Item = (usize, Panel)> {
        let bodies = self.bodies.iter().enumerate();
        bodies.flat_map(move |(index, body)| body.panels(longest).into_iter().map(move |panel| (index, panel)))
    }
}
