//! The coefficients of one step; Newmark and generalised-alpha differ in nothing else.

use crate::Integrator;
use kinematics::Motion;
use nalgebra::DVector;

/// One family for both methods, with a the algorithmic acceleration:
///
/// ```text
/// x1 = x0 + H v0 + H^2 ((1/2 - beta) a0 + beta a1),      v1 = v0 + H ((1 - gamma) a0 + gamma a1),
/// M(xp) ap + f(xp, vp) = Q,   xp = (1 - alpha_f) x1 + alpha_f x0,   vp alike,   ap = (1 - alpha_m) a1 + alpha_m a0.
/// ```
///
/// Newmark is alpha_m = alpha_f = 0. Source: Chung and Hulbert (1993), equations 14-17 and 24-25.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scheme {
    pub alpha_m: f64,
    pub alpha_f: f64,
    pub beta: f64,
    pub gamma: f64,
    /// Whether a1 is carried over as the a0 of the next step. Newmark takes a0 anew from equilibrium with the load that
    /// is held over the step: (v1 - v0)/H is then the mean acceleration under the mean load, and a load that jumps from
    /// step to step, as one with a large added mass does, starts no oscillation of the accelerations.
    pub remembers: bool,
}

impl Scheme {
    pub(crate) fn new(integrator: Integrator) -> Self {
        match integrator {
            Integrator::Newmark { beta, gamma } => Self { alpha_m: 0.0, alpha_f: 0.0, beta, gamma, remembers: false },
            Integrator::GeneralisedAlpha { rho_infinity } => {
                let alpha_m = (2.0 * rho_infinity - 1.0) / (rho_infinity + 1.0);
                let alpha_f = rho_infinity / (rho_infinity + 1.0);
                let gamma = 0.5 - alpha_m + alpha_f;
                let beta = 0.25 * (1.0 - alpha_m + alpha_f).powi(2);
                Self { alpha_m, alpha_f, beta, gamma, remembers: true }
            }
        }
    }

    /// The end of the step if the acceleration stays what it is at the start.
    pub(crate) fn predict(&self, start: &Motion, start_acceleration: &DVector<f64>, duration: f64, end: &mut Motion) {
        let square = duration * duration;
        for (k, &acceleration) in start_acceleration.iter().enumerate() {
            let (position, velocity) = (start.position[k], start.velocity[k]);
            end.position[k] = position + duration * velocity + 0.5 * square * acceleration;
            end.velocity[k] = velocity + duration * acceleration;
            end.acceleration[k] = acceleration;
        }
    }

    /// The motion at which the step asks for equilibrium.
    pub(crate) fn point(&self, start: &Motion, start_acceleration: &DVector<f64>, end: &Motion, point: &mut Motion) {
        let mix = |alpha: f64, old: f64, new: f64| (1.0 - alpha) * new + alpha * old;
        for k in 0..end.position.len() {
            point.position[k] = mix(self.alpha_f, start.position[k], end.position[k]);
            point.velocity[k] = mix(self.alpha_f, start.velocity[k], end.velocity[k]);
            point.acceleration[k] = mix(self.alpha_m, start_acceleration[k], end.acceleration[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_those_of_chung_and_hulbert() {
        // rho = 1 is the midpoint rule with the weights of the average acceleration, rho = 0 annihilates (their section
        // 4).
        for (rho_infinity, expected) in [(1.0, [0.5, 0.5, 0.25, 0.5]), (0.0, [-1.0, 0.0, 1.0, 1.5])] {
            let scheme = Scheme::new(Integrator::GeneralisedAlpha { rho_infinity });
            assert_eq!([scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma], expected);
            assert!(scheme.remembers);
        }
    }

    #[test]
    fn newmark_asks_for_equilibrium_at_the_end() {
        let scheme = Scheme::new(Integrator::default());
        let start = Motion::at_rest(1);
        let mut end = Motion::at_rest(1);
        let acceleration = DVector::from_vec(vec![2.0, 0.0, -4.0, 1.0]);
        scheme.predict(&start, &acceleration, 0.5, &mut end);
        assert_eq!(end.position, 0.125 * &acceleration);
        assert_eq!(end.velocity, 0.5 * &acceleration);
        let mut point = Motion::at_rest(1);
        scheme.point(&start, &acceleration, &end, &mut point);
        assert_eq!(point, end);
    }
}
