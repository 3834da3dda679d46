//! Bending modes of a uniform Euler-Bernoulli beam, mass-normalised.

use crate::Error;

/// How the ends of the beam are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// Clamped at both ends (a bulkhead between bottom and deck).
    FixedFixed,
    /// Clamped at x = 0, free at x = l (a plate standing on a bottom).
    ClampedFree,
}

/// The first modes of a uniform beam of length l, written in x in [0, l].
///
/// With z = kappa x and a = kappa l, the paper's equation (13) is
///
/// ```text
/// phi = M_F^(-1/2) [cosh z - cos z - sigma (sinh z - sin z)],
/// sigma = (cosh a -+ cos a) / (sinh a -+ sin a)        (- fixed-fixed, + clamped-free)
/// ```
///
/// where a solves `cosh a cos a = 1` (fixed-fixed) or `cosh a cos a = -1` (clamped-free). `cosh z - sigma sinh z` is
/// the difference of two numbers of size e^z, and keeps no digit once a exceeds about 35. It is therefore evaluated as
///
/// ```text
/// cosh z - sigma sinh z = grow e^(z - a) + decay e^(-z),
/// grow = (1 - sigma) e^a / 2 = +-(cos a - sin a -+ e^(-a)) / (1 - e^(-2a) -+ 2 e^(-a) sin a),
/// decay = (1 + sigma) / 2,
/// ```
///
/// in which nothing cancels and nothing exceeds one in size.
///
/// The modes satisfy `integral phi_i phi_j rho_l dx = delta_ij`; phi has the unit 1/sqrt(kg/m).
/// Misprint in the paper: after equation (13) the paper counts x from the origin of the beam frame, yet its equations (16)-(18)
/// hold only with that origin at mid-beam; so x = s + l/2 with s from the middle.
#[derive(Debug, Clone, PartialEq)]
pub struct BeamModes {
    support: Support,
    length: f64,
    line_density: f64,
    modes: Vec<Mode>,
    psi0: Vec<f64>,
    psi1: Vec<f64>,
}

/// The constants of one mode.
#[derive(Debug, Clone, PartialEq)]
struct Mode {
    root: f64,
    sigma: f64,
    grow: f64,
    decay: f64,
}

/// The four functions of kappa x from which a mode and its derivatives are put together.
struct Terms {
    grow: f64,
    decay: f64,
    cos: f64,
    sin: f64,
}

impl BeamModes {
    /// The first `count` modes of a beam of `length` m and `line_density` kg/m per metre of width.
    ///
    /// # Errors
    /// When length or line density is not positive and finite.
    pub fn new(support: Support, length: f64, line_density: f64, count: usize) -> Result<Self, Error> {
        for (what, value, unit) in [
            ("the length of the beam", length, "m"),
            ("the line density of the beam", line_density, "kg/m per metre of width"),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::NotPositive { what, value, unit });
            }
        }
        let modes: Vec<Mode> = (0..count).map(|index| Mode::new(support, index)).collect();
        let root_mass = (line_density * length).sqrt();
        let moments = modes.iter().enumerate().map(|(index, mode)| mode.moments(support, index));
        let (psi0, psi1) = moments.map(|(zeroth, first)| (zeroth * root_mass, first * root_mass * length)).unzip();
        Ok(Self { support, length, line_density, modes, psi0, psi1 })
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        self.modes.len()
    }

    /// Length l, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Mass per length, kg/m per metre of width.
    pub fn line_density(&self) -> f64 {
        self.line_density
    }

    /// How the ends are held.
    pub fn support(&self) -> Support {
        self.support
    }

    /// Mass M_F of the beam, kg per metre of width.
    pub fn mass(&self) -> f64 {
        self.line_density * self.length
    }

    /// kappa l of mode `index`, counted from 0 as everywhere in this crate.
    pub fn root(&self, index: usize) -> f64 {
        self.modes[index].root
    }

    /// phi of mode `index` at `x` in [0, l] m, 1/sqrt(kg/m).
    pub fn shape(&self, index: usize, x: f64) -> f64 {
        let mode = &self.modes[index];
        let at = self.terms(mode, x);
        (at.grow + at.decay - at.cos + mode.sigma * at.sin) / self.mass().sqrt()
    }

    /// d phi / dx of mode `index` at `x` in [0, l] m, 1/(m sqrt(kg/m)).
    pub fn slope(&self, index: usize, x: f64) -> f64 {
        let mode = &self.modes[index];
        let at = self.terms(mode, x);
        self.wave_number(mode) * (at.grow - at.decay + at.sin + mode.sigma * at.cos) / self.mass().sqrt()
    }

    /// d2 phi / dx2 of mode `index` at `x` in [0, l] m, 1/(m2 sqrt(kg/m)).
    pub fn curvature(&self, index: usize, x: f64) -> f64 {
        let mode = &self.modes[index];
        let at = self.terms(mode, x);
        self.wave_number(mode).powi(2) * (at.grow + at.decay + at.cos - mode.sigma * at.sin) / self.mass().sqrt()
    }

    /// Natural circular frequency of mode `index` in vacuo, rad/s, for a bending stiffness EJ in N m2 per metre of
    /// width.
    ///
    /// Misprint in the paper: the paper's table 1 lists the same three frequencies for every Young's modulus, infinity
    /// included; they scale with its square root.
    pub fn frequency(&self, index: usize, bending_stiffness: f64) -> f64 {
        self.wave_number(&self.modes[index]).powi(2) * (bending_stiffness / self.line_density).sqrt()
    }

    /// `integral phi_i rho_l ds` of every mode, sqrt(kg/m) (the paper's Psi_0, equation 15).
    pub fn psi0(&self) -> &[f64] {
        &self.psi0
    }

    /// `integral s phi_i rho_l ds` of every mode with s from the middle of the beam, m sqrt(kg/m) (Psi_1, equation 15).
    pub fn psi1(&self) -> &[f64] {
        &self.psi1
    }

    /// Deflection `sum_i phi_i(x) q_i` at `x` in [0, l] m, for as many modes as `amplitudes` and the beam both have.
    pub fn deflection(&self, x: f64, amplitudes: &[f64]) -> f64 {
        let pairs = (0..self.count()).zip(amplitudes);
        pairs.map(|(index, amplitude)| amplitude * self.shape(index, x)).sum()
    }

    fn wave_number(&self, mode: &Mode) -> f64 {
        mode.root / self.length
    }

    fn terms(&self, mode: &Mode, x: f64) -> Terms {
        let z = mode.root * (x / self.length);
        let (sin, cos) = z.sin_cos();
        Terms { grow: mode.grow * (z - mode.root).exp(), decay: mode.decay * (-z).exp(), cos, sin }
    }
}

impl Mode {
    /// Mode `index` (from 0) of unit length and mass.
    fn new(support: Support, index: usize) -> Self {
        // The root is centre + delta, centre an odd multiple of pi/2, and delta is solved for: cos and sin of the
        // root then follow from delta without the rounding of a large argument.
        let (half_turns, sign, even) = match support {
            Support::FixedFixed => (index as f64 + 1.5, -1.0, !index.is_multiple_of(2)),
            Support::ClampedFree => (index as f64 + 0.5, 1.0, index.is_multiple_of(2)),
        };
        let sine_at_centre = if even { 1.0 } else { -1.0 };
        let centre = half_turns * std::f64::consts::PI;
        let delta = root_offset(centre, sign * sine_at_centre);
        let root = centre + delta;
        let cos = -sine_at_centre * delta.sin();
        let sin = sine_at_centre * delta.cos();
        let small = (-root).exp();
        let grow = (sign * (sin - cos) - small) / (1.0 - small * small + sign * 2.0 * small * sin);
        let sigma = 1.0 - 2.0 * grow * small;
        Self { root, sigma, grow, decay: 0.5 * (1.0 + sigma) }
    }

    /// `integral phi dx` and `integral (x - 1/2) phi dx` for unit length and mass.
    ///
    /// From phi'''' = a^4 phi: `integral phi = [phi''']/a^4` and `integral x phi = [x phi''' - phi'']/a^4`, where
    /// phi''(0) = 2 a^2, phi'''(0) = -2 sigma a^3, both vanish at a free end, and repeat with the parity of the mode at
    /// a fixed one.
    fn moments(&self, support: Support, index: usize) -> (f64, f64) {
        let a = self.root;
        match support {
            Support::ClampedFree => (2.0 * self.sigma / a, 2.0 / (a * a) - self.sigma / a),
            Support::FixedFixed if index.is_multiple_of(2) => (4.0 * self.sigma / a, 0.0),
            Support::FixedFixed => (0.0, (4.0 - 2.0 * self.sigma * a) / (a * a)),
        }
    }
}

/// delta in (-pi/2, pi/2) with `sin delta = sign / cosh(centre + delta)`: Newton steps kept inside a shrinking bracket.
fn root_offset(centre: f64, sign: f64) -> f64 {
    let function = |delta: f64| delta.sin() - sign / (centre + delta).cosh();
    let derivative = |delta: f64| {
        let a = centre + delta;
        delta.cos() + sign * a.tanh() / a.cosh()
    };
    // The function rises through its only zero between these ends, for every centre from pi/2 on.
    let (mut low, mut high) = (-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2);
    let mut delta = 0.0;
    // Newton needs about six steps; sixty bisections alone would reach the last digit too.
    for _ in 0..60 {
        let value = function(delta);
        if value > 0.0 {
            high = delta;
        } else {
            low = delta;
        }
        let newton = delta - value / derivative(delta);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - delta).abs() <= f64::EPSILON * next.abs() {
            return next;
        }
        delta = next;
    }
    delta
}

#[cfg(test)]
mod tests {
    use super::*;
    use Support::{ClampedFree, FixedFixed};

    /// Composite Gauss-Legendre rule of five points on [0, length].
    fn integrate(length: f64, cells: usize, function: impl Fn(f64) -> f64) -> f64 {
        let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_5, 0.236_926_885_056_189_1];
        let half = 0.5 * length / cells as f64;
        let cell = |index: usize| {
            let middle = (2 * index + 1) as f64 * half;
            let pair =
                |k: usize| weights[k] * (function(middle - half * nodes[k]) + function(middle + half * nodes[k]));
            weights[0] * function(middle) + pair(1) + pair(2)
        };
        (0..cells).map(cell).sum::<f64>() * half
    }

    #[test]
    fn roots_agree_with_the_tables() {
        // Blevins, Formulas for natural frequency and mode shape (1979), table 8-1. The paper's equation (14) prints
        // 4.7300407446, 7.8532046242, 10.9956078382: correct to nine digits only.
        let fixed = BeamModes::new(FixedFixed, 1.0, 1.0, 5).unwrap();
        let expected = [4.730_040_744_86, 7.853_204_624_10, 10.995_607_838_0, 14.137_165_491_3, 17.278_759_657_4];
        for (index, root) in expected.iter().enumerate() {
            assert!((fixed.root(index) - root).abs() < 6e-11, "{index}: {}", fixed.root(index));
        }
        let free = BeamModes::new(ClampedFree, 1.0, 1.0, 5).unwrap();
        let expected = [1.875_104_068_71, 4.694_091_132_97, 7.854_757_438_24, 10.995_540_734_9, 14.137_168_391_0];
        for (index, root) in expected.iter().enumerate() {
            assert!((free.root(index) - root).abs() < 6e-11, "{index}: {}", free.root(index));
        }
    }

    #[test]
    fn modes_are_orthonormal_up_to_mode_30() {
        for support in [FixedFixed, ClampedFree] {
            let modes = BeamModes::new(support, 0.44, 44.9, 30).unwrap();
            for i in 0..30 {
                for j in [0, 1, 7, 18, 28, 29] {
                    let product =
                        integrate(0.44, 120, |x| modes.line_density() * modes.shape(i, x) * modes.shape(j, x));
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((product - expected).abs() < 1e-12, "{support:?} {i} {j}: {product}");
                }
            }
        }
    }

    #[test]
    fn curvatures_give_the_squared_frequencies() {
        // Equation (12) of the paper, with EJ = 2.5.
        for support in [FixedFixed, ClampedFree] {
            let modes = BeamModes::new(support, 0.3, 7.0, 30).unwrap();
            for i in [0, 1, 2, 14, 29] {
                let energy = integrate(0.3, 120, |x| 2.5 * modes.curvature(i, x).powi(2));
                let squared = modes.frequency(i, 2.5).powi(2);
                assert!((energy / squared - 1.0).abs() < 1e-12, "{support:?} {i}: {energy} {squared}");
            }
        }
    }

    #[test]
    fn ends_are_held_as_said() {
        for support in [FixedFixed, ClampedFree] {
            let modes = BeamModes::new(support, 2.0, 0.5, 40).unwrap();
            for i in 0..40 {
                let wave = modes.root(i) / 2.0;
                assert!(modes.shape(i, 0.0).abs() < 1e-13 && modes.slope(i, 0.0).abs() < 1e-13 * wave);
                assert!((modes.curvature(i, 0.0) / (2.0 * wave * wave) - 1.0).abs() < 1e-13);
                match support {
                    FixedFixed => {
                        assert!(modes.shape(i, 2.0).abs() < 1e-12 && modes.slope(i, 2.0).abs() < 1e-12 * wave);
                    }
                    // |phi(l)| = 2 / sqrt(M_F) for every mode of a cantilever (Blevins 1979).
                    ClampedFree => {
                        assert!((modes.shape(i, 2.0).abs() - 2.0).abs() < 1e-12);
                        assert!(modes.curvature(i, 2.0).abs() < 1e-12 * wave * wave);
                    }
                }
            }
        }
    }

    #[test]
    fn moments_agree_with_quadrature() {
        for support in [FixedFixed, ClampedFree] {
            let modes = BeamModes::new(support, 0.44, 44.9, 30).unwrap();
            for i in 0..30 {
                let zeroth = integrate(0.44, 120, |x| 44.9 * modes.shape(i, x));
                let first = integrate(0.44, 120, |x| 44.9 * (x - 0.22) * modes.shape(i, x));
                assert!((zeroth - modes.psi0()[i]).abs() < 1e-12, "{support:?} {i}: {zeroth} {}", modes.psi0()[i]);
                assert!((first - modes.psi1()[i]).abs() < 1e-12, "{support:?} {i}: {first} {}", modes.psi1()[i]);
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for support in [FixedFixed, ClampedFree] {
            let modes = BeamModes::new(support, 1.0, 1.0, 30).unwrap();
            for i in [0, 1, 5, 29] {
                let step = 1e-4 / modes.root(i);
                for x in [0.05, 0.31, 0.5, 0.77, 0.96] {
                    let wave = modes.root(i);
                    let slope = (modes.shape(i, x + step) - modes.shape(i, x - step)) / (2.0 * step);
                    let curvature = (modes.slope(i, x + step) - modes.slope(i, x - step)) / (2.0 * step);
                    assert!((slope - modes.slope(i, x)).abs() < 1e-7 * wave, "{support:?} {i} {x}");
                    assert!((curvature - modes.curvature(i, x)).abs() < 1e-7 * wave * wave, "{support:?} {i} {x}");
                }
            }
        }
    }

    #[test]
    fn printed_frequencies_follow_from_the_reconstructed_bulkhead() {
        // Table 1 of the paper: 508.4265, 1401.4972, 2747.4948 rad/s, that is sqrt(EJ/rho_l)/l^2 = 22.7247 1/s.
        let modes = BeamModes::new(FixedFixed, 1.0, 1.0, 3).unwrap();
        for (index, printed) in [508.4265, 1401.4972, 2747.4948].iter().enumerate() {
            let frequency = modes.frequency(index, 22.7247_f64.powi(2));
            assert!((frequency / printed - 1.0).abs() < 5e-6, "{frequency} {printed}");
        }
    }

    #[test]
    fn impossible_beams_are_refused() {
        let error = BeamModes::new(FixedFixed, -0.1, 1.0, 3).unwrap_err();
        assert_eq!(error.to_string(), "the length of the beam is -0.1 m, but has to be positive and finite");
        assert!(BeamModes::new(FixedFixed, 0.1, f64::NAN, 3).is_err());
        assert_eq!(BeamModes::new(FixedFixed, 0.1, 1.0, 0).unwrap().count(), 0);
    }
}
