//! The equations of motion of one body, `M(x) xdd + h(x, xd) + grad V(x) + C xd = Q`, and their exact derivatives.

use crate::contact::Contact;
use crate::{BeamParameters, BodyParameters};
use kinematics::{MotionView, RIGID};
use nalgebra::{DMatrixView, DMatrixViewMut, DVector, DVectorView, DVectorViewMut, Vector2};
use std::ops::Range;

/// The Lagrangian of a body with its members, free of any time integration.
///
/// Notation of the formulas: e1 = (cos, sin) and e2 = (-sin, cos) of angle + theta, the axes of the body frame;
/// `m_b = (sum M_F x_of - psi0.q, sum M_F y_of)`, the members' first moment in the body frame; U Rot m_b = m_bx e2 - m_by e1.
/// Every vector and matrix is of the body's size n = 3 + N, locked coordinates included.
/// Source: paper, section 2.2 (16)-(21), derived anew from T and V; departures from the print are named below.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodyDynamics {
    mass: f64,
    /// sum M_F o_F: first moment of the undeformed members about o_R.
    moment: Vector2<f64>,
    /// Modes of each member, and its x_of.
    members: Vec<(Range<usize>, f64)>,
    /// I_R + M_F |o|^2 + I_F: moment of inertia about o_R of the undeformed structure.
    inertia: f64,
    gravity: f64,
    springs: [f64; RIGID],
    angle: f64,
    psi0: DVector<f64>,
    /// x_of psi0 of every mode.
    offset: DVector<f64>,
    /// y_of psi0 + psi1: what couples theta with every mode.
    lever: DVector<f64>,
    squared_frequencies: DVector<f64>,
    /// 2 zeta omega of every mode.
    damping: DVector<f64>,
    contact: Option<Contact>,
}

/// The body's axes and the beam's first moment at one position.
struct Pose {
    e1: Vector2<f64>,
    e2: Vector2<f64>,
    moment: Vector2<f64>,
}

impl Pose {
    /// Rot m_b.
    fn arm(&self) -> Vector2<f64> {
        self.moment.x * self.e1 + self.moment.y * self.e2
    }

    /// U Rot m_b.
    fn turned_arm(&self) -> Vector2<f64> {
        self.moment.x * self.e2 - self.moment.y * self.e1
    }
}

impl BodyDynamics {
    /// Constants of the equations; the parameters are taken as validated.
    pub(crate) fn new(parameters: &BodyParameters, gravity: f64) -> Self {
        let mut dynamics = Self {
            mass: parameters.rigid_mass,
            moment: Vector2::zeros(),
            members: Vec::new(),
            inertia: parameters.rigid_inertia,
            gravity,
            springs: parameters.springs,
            angle: parameters.angle,
            psi0: DVector::zeros(0),
            offset: DVector::zeros(0),
            lever: DVector::zeros(0),
            squared_frequencies: DVector::zeros(0),
            damping: DVector::zeros(0),
            contact: parameters.contact.as_ref().map(|contact| Contact::new(contact, parameters.angle)),
        };
        parameters.members.iter().for_each(|beam| dynamics.add_member(beam));
        dynamics
    }

    fn add_member(&mut self, beam: &BeamParameters) {
        let (modes, count) = (&beam.modes, beam.modes.count());
        let beam_inertia = modes.mass() * modes.length().powi(2) / 12.0;
        let ratio = |i: usize| beam.damping_ratios.get(i).copied().unwrap_or(0.0);
        self.mass += modes.mass();
        self.moment += modes.mass() * beam.middle;
        self.inertia += modes.mass() * beam.middle.norm_squared() + beam_inertia;
        let first = self.psi0.len();
        self.members.push((first..first + count, beam.middle.x));
        for i in 0..count {
            let (psi0, psi1) = (modes.psi0()[i], modes.psi1()[i]);
            let frequency = modes.frequency(i, beam.bending_stiffness);
            push(&mut self.psi0, psi0);
            push(&mut self.offset, beam.middle.x * psi0);
            push(&mut self.lever, beam.middle.y * psi0 + psi1);
            push(&mut self.squared_frequencies, frequency * frequency);
            push(&mut self.damping, 2.0 * ratio(i) * frequency);
        }
    }

    /// sum x_of psi0.q over the members.
    fn offset_moment(&self, q: &DVectorView<f64>) -> f64 {
        let of = |(own, x): &(Range<usize>, f64)| x * self.psi0.rows_range(own.clone()).dot(&q.rows_range(own.clone()));
        self.members.iter().map(of).sum()
    }

    /// Number N of modes.
    pub fn modes(&self) -> usize {
        self.psi0.len()
    }

    /// Natural circular frequency of mode `index` (from 0) between fixed supports, in vacuo, rad/s.
    pub fn frequency(&self, index: usize) -> f64 {
        self.squared_frequencies[index].sqrt()
    }

    /// M(x) into `out`, n x n: symmetric, positive definite.
    pub fn mass_matrix(&self, position: &[f64], out: &mut DMatrixViewMut<f64>) {
        let (pose, q) = (self.pose(position), modal(position));
        let arm = pose.turned_arm();
        out.fill(0.0);
        out[(0, 0)] = self.mass;
        out[(1, 1)] = self.mass;
        out[(2, 2)] = self.inertia - 2.0 * self.offset_moment(&q) + q.norm_squared();
        for (row, value) in [(0, arm.x), (1, arm.y)] {
            out[(row, 2)] = value;
            out[(2, row)] = value;
        }
        for i in 0..self.modes() {
            let column = RIGID + i;
            for (row, value) in [(0, -self.psi0[i] * pose.e1.x), (1, -self.psi0[i] * pose.e1.y), (2, self.lever[i])] {
                out[(row, column)] = value;
                out[(column, row)] = value;
            }
            out[(column, column)] = 1.0;
        }
    }

    /// `h(x, xd) + grad V(x) + C xd` into `out`, n.
    ///
    /// Misprint in the paper: (17) ends with `-theta-dd cos(theta) psi.qdd`, right is `-sin(theta) psi.qdd`, and its terms in
    /// theta-d^2 and theta-dd have psi03 q3-dot for psi03 q3; (18) has `M_F (x_of cos + y_of sin)` for
    /// `g (cos m_bx - sin m_by)`: the factor g, the sign and the deflection are missing; (19)-(21) lack the weight of
    /// the modes, `-g sin(theta) psi0_i`.
    pub fn restoring_force(&self, position: &[f64], velocity: &[f64], out: &mut DVectorViewMut<f64>) {
        let (pose, q, qd) = (self.pose(position), modal(position), modal(velocity));
        let spin = velocity[2];
        let drift = self.psi0.dot(&qd);
        let rigid = -spin * spin * pose.arm() - 2.0 * spin * drift * pose.e2;
        out[0] = rigid.x;
        out[1] = rigid.y + self.mass * self.gravity;
        out[2] = 2.0 * spin * (q.dot(&qd) - self.offset_moment(&qd)) + self.gravity * pose.turned_arm().y;
        for (k, spring) in self.springs.iter().enumerate() {
            out[k] += spring * position[k];
        }
        for i in 0..self.modes() {
            let centrifugal = spin * spin * (self.offset[i] - q[i]);
            let weight = -self.gravity * pose.e1.y * self.psi0[i];
            out[RIGID + i] = centrifugal + weight + self.squared_frequencies[i] * q[i] + self.damping[i] * qd[i];
        }
        if let Some(contact) = &self.contact {
            contact.add_force(position, velocity, out);
        }
    }

    /// Adds to `out`, n, the size of every force that `M xdd` and [`BodyDynamics::restoring_force`] are summed up from.
    ///
    /// The sums themselves vanish in equilibrium; these do not, and so tell how much of a residual is more than
    /// rounding. `mass` is M at this position.
    pub(crate) fn add_force_sizes(&self, motion: &MotionView, mass: &DMatrixView<f64>, out: &mut DVectorViewMut<f64>) {
        let (q, qd) = (modal(motion.position), modal(motion.velocity));
        let (spin, drift) = (motion.velocity[2].abs(), self.psi0.dot(&qd).abs());
        let moment = self.pose(motion.position).moment.norm();
        for (row, entry) in out.iter_mut().enumerate() {
            let terms = motion.acceleration.iter().enumerate().map(|(column, a)| (mass[(row, column)] * a).abs());
            *entry += terms.sum::<f64>();
        }
        let rigid = spin * (spin * moment + 2.0 * drift);
        out[0] += rigid;
        out[1] += rigid + self.mass * self.gravity;
        out[2] += 2.0 * spin * (q.dot(&qd).abs() + self.offset_moment(&qd).abs()) + self.gravity * moment;
        for (k, spring) in self.springs.iter().enumerate() {
            out[k] += spring * motion.position[k].abs();
        }
        for i in 0..self.modes() {
            let centrifugal = spin * spin * (self.offset[i].abs() + q[i].abs());
            let bending = self.squared_frequencies[i] * q[i].abs() + self.damping[i] * qd[i].abs();
            out[RIGID + i] += centrifugal + self.gravity * self.psi0[i].abs() + bending;
        }
        if let Some(contact) = &self.contact {
            contact.add_force_size(motion, out);
        }
    }

    /// d(M(x) xdd + h + grad V + C xd)/dx into `out`, n x n; not symmetric.
    pub fn stiffness(&self, position: &[f64], velocity: &[f64], acceleration: &[f64], out: &mut DMatrixViewMut<f64>) {
        let pose = self.pose(position);
        let (q, qd, qdd) = (modal(position), modal(velocity), modal(acceleration));
        let (spin, turn) = (velocity[2], acceleration[2]);
        let rigid_acceleration = Vector2::new(acceleration[0], acceleration[1]);
        out.fill(0.0);
        let (drift, push) = (self.psi0.dot(&qd), self.psi0.dot(&qdd));
        let by_theta =
            -turn * pose.arm() - push * pose.e2 - spin * spin * pose.turned_arm() + 2.0 * spin * drift * pose.e1;
        out[(0, 2)] = by_theta.x;
        out[(1, 2)] = by_theta.y;
        // d/dtheta of U Rot m_b is -Rot m_b, here against the acceleration of o_R and against gravity.
        out[(2, 2)] = -pose.arm().dot(&rigid_acceleration) - self.gravity * pose.arm().y;
        for (k, spring) in self.springs.iter().enumerate() {
            out[(k, k)] += spring;
        }
        for i in 0..self.modes() {
            let (column, psi0) = (RIGID + i, self.psi0[i]);
            let rigid_by_mode = psi0 * (spin * spin * pose.e1 - turn * pose.e2);
            out[(0, column)] = rigid_by_mode.x;
            out[(1, column)] = rigid_by_mode.y;
            let shared = -psi0 * (pose.e2.dot(&rigid_acceleration) + self.gravity * pose.e2.y);
            out[(2, column)] = shared + 2.0 * turn * (q[i] - self.offset[i]) + 2.0 * spin * qd[i];
            out[(column, 2)] = shared;
            out[(column, column)] = self.squared_frequencies[i] - spin * spin;
        }
        if let Some(contact) = &self.contact {
            contact.add_stiffness(position, velocity, out);
        }
    }

    /// d(h + C xd)/d(xd) into `out`, n x n; not symmetric.
    pub fn velocity_tangent(&self, position: &[f64], velocity: &[f64], out: &mut DMatrixViewMut<f64>) {
        let (pose, q, qd) = (self.pose(position), modal(position), modal(velocity));
        let spin = velocity[2];
        let drift = self.psi0.dot(&qd);
        out.fill(0.0);
        let by_spin = -2.0 * (spin * pose.arm() + drift * pose.e2);
        out[(0, 2)] = by_spin.x;
        out[(1, 2)] = by_spin.y;
        out[(2, 2)] = 2.0 * (q.dot(&qd) - self.offset_moment(&qd));
        for i in 0..self.modes() {
            let (column, psi0) = (RIGID + i, self.psi0[i]);
            out[(0, column)] = -2.0 * spin * psi0 * pose.e2.x;
            out[(1, column)] = -2.0 * spin * psi0 * pose.e2.y;
            out[(2, column)] = 2.0 * spin * (q[i] - self.offset[i]);
            out[(column, 2)] = 2.0 * spin * (self.offset[i] - q[i]);
            out[(column, column)] = self.damping[i];
        }
        if let Some(contact) = &self.contact {
            contact.add_velocity_tangent(position, velocity, out);
        }
    }

    /// V, J per metre of width: weight (zero with o_R at its place in the scene and everything at its height), springs,
    /// contact and bending.
    ///
    /// Misprint in the paper: (A5) has the beam's centre without its deflection; here m_b carries it.
    pub fn potential_energy(&self, position: &[f64]) -> f64 {
        let weight = self.gravity * (self.mass * position[1] + self.pose(position).arm().y);
        let q = modal(position);
        let springs = self.springs.iter().zip(position.iter()).map(|(spring, x)| 0.5 * spring * x * x).sum::<f64>();
        let contact = self.contact.as_ref().map_or(0.0, |contact| contact.energy(position));
        weight
            + springs
            + contact
            + 0.5 * (0..self.modes()).map(|i| self.squared_frequencies[i] * q[i] * q[i]).sum::<f64>()
    }

    fn pose(&self, position: &[f64]) -> Pose {
        // Misprint in the paper: (A11)-(A13) hold the rotation constant; it is Rot(theta), counted here from the scene's angle.
        let (sin, cos) = (self.angle + position[2]).sin_cos();
        let along = self.moment.x - self.psi0.dot(&modal(position));
        Pose { e1: Vector2::new(cos, sin), e2: Vector2::new(-sin, cos), moment: Vector2::new(along, self.moment.y) }
    }
}

/// The modal entries of a vector of 3 + N.
fn modal(vector: &[f64]) -> DVectorView<'_, f64> {
    DVectorView::from_slice(&vector[RIGID..], vector.len() - RIGID)
}

fn push(vector: &mut DVector<f64>, value: f64) {
    vector.extend([value]);
}
