//! Where the points of a body stand, how they move, and what forces on them do to its generalised coordinates.

use crate::layout::RIGID;
use crate::{BeamModes, Error, MotionView};
use nalgebra::{Rotation2, Vector2};

/// An elastic beam that a body carries.
///
/// Its axis runs along +y of the body, its deflection eta along -x. A point of the face at `offset` along +x stands in
/// the body frame at `(x_of + offset - eta(s), y_of + s)` with `s = station - l/2`: the faces are translated copies of
/// the neutral axis, so a force on either does its work through the very shape that the structure integrates.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// o_F, the middle of the beam, in the body frame, m.
    pub middle: Vector2<f64>,
    /// Distance between the two faces, m.
    pub thickness: f64,
    /// Shape functions.
    pub modes: BeamModes,
}

/// A rigid body with its elastic members, as it stands in the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Place of o_R (the rigid part's centre of gravity) in the scene, m.
    pub origin: Vector2<f64>,
    /// Angle of the body frame in the scene, rad, counter-clockwise; the coordinate theta is added to it.
    pub angle: f64,
    /// Rigid surface as polylines in the body frame, m, with the fluid on the left when walked along their points.
    pub walls: Vec<Vec<Vector2<f64>>>,
    /// The elastic parts.
    pub members: Vec<Beam>,
}

/// A point that is painted on the body and moves with it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum MaterialPoint {
    /// A point of the rigid part, in the body frame, m.
    Rigid(Vector2<f64>),
    /// A point of a beam.
    Beam {
        /// Index of the beam among the body's members.
        member: usize,
        /// x in [0, l] along the beam, m.
        station: f64,
        /// Distance from the neutral axis along +x of the body, m; the faces have plus and minus half the thickness.
        offset: f64,
    },
}

impl MaterialPoint {
    /// The point at `fraction` of the way from `start` to `end` along the material.
    ///
    /// None when they belong to different parts: no material line joins these.
    pub fn between(start: Self, end: Self, fraction: f64) -> Option<Self> {
        let mix = |a: f64, b: f64| a + fraction * (b - a);
        match (start, end) {
            (Self::Rigid(a), Self::Rigid(b)) => Some(Self::Rigid(a.lerp(&b, fraction))),
            (Self::Beam { member, station: s0, offset: o0 }, Self::Beam { member: other, station: s1, offset: o1 })
                if member == other =>
            {
                Some(Self::Beam { member, station: mix(s0, s1), offset: mix(o0, o1) })
            }
            _ => None,
        }
    }
}

impl Body {
    /// Checks every number once; the other functions rely on it.
    ///
    /// # Errors
    /// A number that is not finite, a thickness that is not positive, a wall with fewer than two points or with an
    /// empty segment.
    pub fn validate(&self) -> Result<(), Error> {
        let mut numbers = vec![
            ("the body's origin x".to_string(), self.origin.x),
            ("the body's origin y".to_string(), self.origin.y),
            ("the body's angle".to_string(), self.angle),
        ];
        for beam in &self.members {
            numbers.push(("the beam's middle x".to_string(), beam.middle.x));
            numbers.push(("the beam's middle y".to_string(), beam.middle.y));
            if !(beam.thickness.is_finite() && beam.thickness > 0.0) {
                return Err(Error::NotPositive { what: "the thickness of the beam", value: beam.thickness, unit: "m" });
            }
        }
        for (wall, points) in self.walls.iter().enumerate() {
            if points.len() < 2 {
                return Err(Error::ShortWall { wall, points: points.len() });
            }
            for (point, place) in points.iter().enumerate() {
                numbers.push((format!("x of point {point} of wall {wall} of the body"), place.x));
                numbers.push((format!("y of point {point} of wall {wall} of the body"), place.y));
            }
            if let Some(point) = points.windows(2).position(|pair| pair[0] == pair[1]) {
                return Err(Error::EmptySegment { wall, point, x: points[point].x, y: points[point].y });
            }
        }
        match numbers.into_iter().find(|(_, value)| !value.is_finite()) {
            Some((what, value)) => Err(Error::NotFinite { what, value }),
            None => Ok(()),
        }
    }

    /// Number N of modes of all members.
    pub fn modes(&self) -> usize {
        self.members.iter().map(|beam| beam.modes.count()).sum()
    }

    /// Index of the first mode of a member among those of the body.
    fn first_mode(&self, member: usize) -> usize {
        self.members[..member].iter().map(|beam| beam.modes.count()).sum()
    }

    /// Place in the global frame, m (equation 6 of the paper).
    ///
    /// Here and below the motion or the coordinates must have the body's own 3 + N entries, N = [`Body::modes`].
    pub fn position<'a>(&self, point: MaterialPoint, motion: impl Into<MotionView<'a>>) -> Vector2<f64> {
        self.place(point, motion.into().position)
    }

    /// Where a point, m, that stands at `place` in the scene's pose is carried to by the rigid motion.
    pub fn carry(&self, place: &Vector2<f64>, coordinates: &[f64]) -> Vector2<f64> {
        self.origin + rigid(coordinates) + Rotation2::new(coordinates[2]) * (place - self.origin)
    }

    /// Place in the global frame, m, from the coordinates alone.
    pub fn place(&self, point: MaterialPoint, coordinates: &[f64]) -> Vector2<f64> {
        self.origin + rigid(coordinates) + self.rotation(coordinates) * self.local(point, coordinates)
    }

    /// Velocity in the global frame, m/s.
    pub fn velocity<'a>(&self, point: MaterialPoint, motion: impl Into<MotionView<'a>>) -> Vector2<f64> {
        let motion = motion.into();
        // In the rotating frame: r = R + Rot b, so rdot = Rdot + Rot (thetadot U b + bdot).
        let local = self.local(point, motion.position);
        let drift = self.drift(point, motion.velocity);
        rigid(motion.velocity) + self.rotation(motion.position) * (motion.velocity[2] * turned(local) + drift)
    }

    /// Acceleration in the global frame, m/s2.
    pub fn acceleration<'a>(&self, point: MaterialPoint, motion: impl Into<MotionView<'a>>) -> Vector2<f64> {
        let motion = motion.into();
        // One more derivative: Rddot + Rot (thetaddot U b - thetadot^2 b + 2 thetadot U bdot + bddot).
        let local = self.local(point, motion.position);
        let drift = self.drift(point, motion.velocity);
        let spin = motion.velocity[2];
        let turning = motion.acceleration[2] * turned(local) - spin * spin * local + 2.0 * spin * turned(drift);
        rigid(motion.acceleration) + self.rotation(motion.position) * (turning + self.drift(point, motion.acceleration))
    }

    /// Derivatives of the place by every coordinate: `out[k]` = d position / d x_k, for 3 + N entries of `out`.
    pub fn jacobian(&self, point: MaterialPoint, coordinates: &[f64], out: &mut [Vector2<f64>]) {
        let rotation = self.rotation(coordinates);
        out[0] = Vector2::x();
        out[1] = Vector2::y();
        out[2] = rotation * turned(self.local(point, coordinates));
        let deflecting = rotation * -Vector2::x();
        for (index, column) in out[RIGID..].iter_mut().enumerate() {
            *column = self.shape(point, index) * deflecting;
        }
    }

    /// Adds the virtual work of a `force` (N per metre of width, global frame) on this point to the generalised `load`,
    /// 3 + N: `load_k += (d position / d x_k) . force`.
    ///
    /// Misprint in the paper: equation (A15) of the paper takes the moment about the global origin; the work on theta is the
    /// moment about o_R, where it stands now.
    pub fn add_force(&self, point: MaterialPoint, coordinates: &[f64], force: Vector2<f64>, load: &mut [f64]) {
        let rotation = self.rotation(coordinates);
        let local_force = rotation.inverse() * force;
        load[0] += force.x;
        load[1] += force.y;
        load[2] += turned(self.local(point, coordinates)).dot(&local_force);
        for (index, entry) in load[RIGID..].iter_mut().enumerate() {
            *entry -= self.shape(point, index) * local_force.x;
        }
    }

    /// Rotation from the body frame to the global frame.
    ///
    /// Misprint in the paper: the paper's (7) and (A11)-(A13) give one constant matrix for all of U, R_R and R. Only R, from
    /// the beam's frame (s, w) to the body frame, is constant; R_R = Rot(theta), U = dRot/dtheta Rot^T,
    /// R_F = Rot(theta) R.
    fn rotation(&self, coordinates: &[f64]) -> Rotation2<f64> {
        Rotation2::new(self.angle + coordinates[2])
    }

    /// Place in the body frame, deformed.
    fn local(&self, point: MaterialPoint, coordinates: &[f64]) -> Vector2<f64> {
        match point {
            MaterialPoint::Rigid(place) => place,
            MaterialPoint::Beam { member, station, offset } => match self.members.get(member) {
                Some(beam) => {
                    beam.middle
                        + Vector2::new(offset, station - 0.5 * beam.modes.length())
                        + self.drift(point, coordinates)
                }
                // Without the member no panel carries such a point; its offset and station are plain body coordinates.
                None => Vector2::new(offset, station),
            },
        }
    }

    /// What the modal part of `values` (positions, rates or accelerations) adds to this point in the body frame.
    fn drift(&self, point: MaterialPoint, values: &[f64]) -> Vector2<f64> {
        match self.beam_at(point) {
            Some((beam, station, first)) => {
                let amplitudes = &values[RIGID + first..RIGID + first + beam.modes.count()];
                Vector2::new(-beam.modes.deflection(station, amplitudes), 0.0)
            }
            None => Vector2::zeros(),
        }
    }

    /// The beam that carries a point, its station there, and the index of its first mode; none for the rigid part.
    fn beam_at(&self, point: MaterialPoint) -> Option<(&Beam, f64, usize)> {
        let MaterialPoint::Beam { member, station, .. } = point else { return None };
        Some((self.members.get(member)?, station, self.first_mode(member)))
    }

    /// phi of one mode of the body at this point; 0 on the rigid part and on other members.
    fn shape(&self, point: MaterialPoint, index: usize) -> f64 {
        let Some((beam, station, first)) = self.beam_at(point) else { return 0.0 };
        let own = first..first + beam.modes.count();
        if own.contains(&index) { beam.modes.shape(index - first, station) } else { 0.0 }
    }
}

/// X and Y of a vector of 3 + N entries.
fn rigid(values: &[f64]) -> Vector2<f64> {
    Vector2::new(values[0], values[1])
}

/// A quarter turn counter-clockwise: U of the paper.
fn turned(vector: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}
