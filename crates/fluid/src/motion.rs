//! Motion of the body inside a communication step.

use kinematics::Motion;

/// Motion at `fraction` of a communication step of length `duration`, by cubic Hermite interpolation of positions and
/// velocities; at 1 it is `end` itself.
pub fn interpolate(start: &Motion, end: &Motion, duration: f64, fraction: f64, out: &mut Motion) {
    if fraction >= 1.0 {
        out.clone_from(end);
        return;
    }
    let s = fraction;
    for k in 0..end.position.len() {
        let (x0, x1) = (start.position[k], end.position[k]);
        let (m0, m1) = (start.velocity[k] * duration, end.velocity[k] * duration);
        let (c2, c3) = (3.0 * (x1 - x0) - 2.0 * m0 - m1, 2.0 * (x0 - x1) + m0 + m1);
        out.position[k] = x0 + s * (m0 + s * (c2 + s * c3));
        out.velocity[k] = (m0 + s * (2.0 * c2 + 3.0 * c3 * s)) / duration;
        out.acceleration[k] = (2.0 * c2 + 6.0 * c3 * s) / (duration * duration);
    }
}

/// Motion extrapolated from the start of an internal step alone: it does not depend on the inputs of the step, so that a
/// repeated step finds the same geometry.
pub fn extrapolate(start: &Motion, time_step: f64, out: &mut Motion) {
    out.clone_from(start);
    out.position.axpy(time_step, &start.velocity, 1.0);
    out.position.axpy(0.5 * time_step * time_step, &start.acceleration, 1.0);
    out.velocity.axpy(time_step, &start.acceleration, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_motion_is_reproduced() {
        let at = |t: f64| {
            let mut motion = Motion::at_rest(0);
            motion.position[1] = 1.0 + 2.0 * t - t * t + 3.0 * t * t * t;
            motion.velocity[1] = 2.0 - 2.0 * t + 9.0 * t * t;
            motion.acceleration[1] = -2.0 + 18.0 * t;
            motion
        };
        let mut out = Motion::at_rest(0);
        interpolate(&at(0.0), &at(0.5), 0.5, 0.3, &mut out);
        let exact = at(0.15);
        assert!((out.position[1] - exact.position[1]).abs() < 1e-14);
        assert!((out.velocity[1] - exact.velocity[1]).abs() < 1e-14);
        assert!((out.acceleration[1] - exact.acceleration[1]).abs() < 1e-12);
    }
}
