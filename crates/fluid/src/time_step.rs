//! Internal time steps: as large as stability allows, changing slowly, and landing on the end of the step.

use crate::Error;

/// An internal step.
#[derive(Debug, Clone, Copy)]
pub struct TimeStep {
    /// Length of the step \[s\].
    pub length: f64,
    /// Length that stability would allow at the default Courant number \[s\].
    pub ordinary: f64,
    /// Share of the communication step.
    pub share: f64,
}

/// What a discretisation bears.
#[derive(Debug, Clone, Copy)]
pub struct Stability {
    /// Courant number.
    pub courant: f64,
    /// Its default.
    pub ordinary_courant: f64,
    /// Share of sqrt(l0 / |a|) that a step may take.
    pub ease: f64,
}

/// Limits of one internal step.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Particle spacing \[m\].
    pub spacing: f64,
    /// What the discretisation bears.
    pub stability: Stability,
    /// Largest speed of particles and walls \[m/s\].
    pub speed: f64,
    /// Largest acceleration expected, at least gravity \[m/s2\].
    pub acceleration: f64,
}

impl Limits {
    /// Largest stable step \[s\]: Courant's, and `ease` sqrt(l0 / |a|) for the acceleration. At 0.25, still water with
    /// an effective radius of 2.1 spacings blows up.
    pub fn stable_step(&self) -> f64 {
        self.at_courant(self.stability.courant)
    }

    fn at_courant(&self, courant: f64) -> f64 {
        let by_speed = courant * self.spacing / self.speed.max(1e-12);
        let by_acceleration = self.stability.ease * (self.spacing / self.acceleration.max(1e-12)).sqrt();
        by_speed.min(by_acceleration)
    }

    /// The same at the scheme's default Courant number: the time scale of what is done to errors step by step, so that it
    /// does not get stronger where a smaller Courant number makes more steps.
    pub fn ordinary_step(&self) -> f64 {
        self.at_courant(self.stability.ordinary_courant)
    }
}

/// Internal steps that one communication step may take. A step of 1e300 s would never come to an end.
const MOST_PARTS: f64 = 1e6;

/// The next internal step \[s\], given the time left and the last step (0 for none).
///
/// The source term of the pressure contains 1/dt, and jumps of dt make it ring: where there is a choice, a step grows
/// by at most a tenth, and the time left is cut into equal parts. A master that asks for no more than a stable step
/// gets it in one piece, even after a much shorter one: only then is the load affine in the motion.
pub fn next_step(limits: &Limits, left: f64, last: f64, time: f64) -> Result<f64, Error> {
    let stable = limits.stable_step();
    let wanted = if last > 0.0 { stable.min(1.1 * last) } else { stable };
    let weightless = limits.acceleration < 1e-9;
    let floor = if weightless { 0.0 } else { 1e-6 * 0.25 * (limits.spacing / limits.acceleration).sqrt() };
    if stable < floor || !stable.is_finite() {
        return Err(Error::TimeStep { step: stable, floor, time, speed: limits.speed, spacing: limits.spacing });
    }
    if left <= stable {
        return Ok(left);
    }
    if left > MOST_PARTS * stable {
        return Err(Error::CommunicationStep { left, stable, parts: MOST_PARTS, time });
    }
    let parts = (left / wanted - 1e-9).ceil().max(1.0);
    Ok(left / parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_land_exactly_and_change_slowly() {
        let stability = Stability { courant: 0.2, ordinary_courant: 0.2, ease: 0.1 };
        let limits = Limits { spacing: 0.01, stability, speed: 1.7, acceleration: 9.81 };
        let (mut left, mut last, mut steps) = (0.01_f64, 0.0, Vec::new());
        while left > 0.0 {
            let step = next_step(&limits, left, last, 0.0).unwrap();
            left = if step >= left { 0.0 } else { left - step };
            last = step;
            steps.push(step);
        }
        assert_eq!(steps.len(), 9, "0.01 s at 1.176e-3 s at most");
        assert!((steps.iter().sum::<f64>() - 0.01).abs() < 1e-16);
        assert!(steps.windows(2).all(|pair| (pair[1] / pair[0] - 1.0).abs() < 0.1));
    }
}
