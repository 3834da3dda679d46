//! What a user should know of a scene before it runs, told by `check` and by the run alike.

use report::Short;
use scene::{Integrator, Member, Scene};
use std::f64::consts::TAU;

/// Communication steps in a period of the beam below which the time integration is too coarse for it.
const STEPS_IN_A_PERIOD: f64 = 20.0;

/// Warnings about a validated scene.
pub fn of_scene(scene: &Scene) -> Vec<String> {
    let bodies = scene.body.iter().enumerate();
    let members =
        bodies.flat_map(|(body, of)| of.member.iter().enumerate().map(move |(index, member)| (body, index, member)));
    members
        .filter_map(|(body, index, member)| beam_period(scene, member, &format!("body[{body}].member[{index}]")))
        .collect()
}

/// A mode of a member whose period is near the communication step swings too slowly; `key` is that of the member.
fn beam_period(scene: &Scene, member: &Member, key: &str) -> Option<String> {
    // What cannot be computed is refused elsewhere.
    let frequencies = components::conversion::frequencies(member).ok()?;
    let step = scene.run.communication_step;
    let coarse = |frequency: &f64| TAU / frequency < STEPS_IN_A_PERIOD * step;
    let first = frequencies.iter().position(coarse)?;
    let one = |(index, frequency): (usize, &f64)| {
        let longer = elongation(&scene.integrator, frequency * step);
        let longer = longer.map_or_else(String::new, |share| format!(", {:.1} % too long", 100.0 * share));
        format!("{} ({} s{longer})", index + 1, Short(TAU / frequency))
    };
    let listed: Vec<String> = frequencies.iter().enumerate().skip(first).map(one).collect();
    let needed = TAU / frequencies[frequencies.len() - 1] / STEPS_IN_A_PERIOD;
    Some(format!(
        "{key} '{}': the period in vacuo of mode {} is shorter than {STEPS_IN_A_PERIOD} communication steps of {} s, too \
         coarse for the time integration; lower run.communication_step to {} s, or {key}.modes to {first}",
        member.name,
        listed.join(", "),
        Short(step),
        Short(needed)
    ))
}

/// Share by which Newmark's method with gamma = 1/2 lengthens a period, from the angle W of a step:
/// cos W = 1 - w^2 / (2 (1 + beta w^2)) with w the frequency times the step (Newmark 1959); none of other methods.
fn elongation(integrator: &Integrator, step: f64) -> Option<f64> {
    if integrator.rho_infinity.is_some() || integrator.gamma != 0.5 {
        return None;
    }
    let squared = step * step;
    let cosine = 1.0 - 0.5 * squared / (1.0 + integrator.beta * squared);
    (cosine > -1.0).then(|| step / cosine.acos() - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = 't'\n[run]\nend = 1.0\ncommunication_step = 0.001\n[[body]]\nname = 'base'\n\
        [[body.member]]\nname = 'plate'\nsupport = 'clamped_free'\nmiddle = [0.0, 0.04]\nlength = 0.08\nthickness = 0.012\ndensity = 2500.0\n\
        youngs_modulus = MODULUS\nmodes = 2\n";

    fn warnings(modulus: &str) -> Vec<String> {
        of_scene(&Scene::from_str(&SCENE.replace("MODULUS", modulus), "t").unwrap())
    }

    #[test]
    fn a_period_near_the_step_is_named_with_what_it_becomes() {
        // 6.0577 Hz and 37.96 Hz at 1 MPa: 165 and 26 steps.
        assert!(warnings("1e6").is_empty());
        // The second mode at 2 MPa has 53.7 Hz and 18.6 steps: 2 pi / 18.6 squared over 12 is 1 %.
        let text = &warnings("2e6")[0];
        assert!(text.contains("mode 2 (0.01863 s, 0.9 % too long)") && text.ends_with("modes to 1"), "{text}");
        // 191.6 Hz at 1 GPa, which comes out as 172.4 Hz.
        let text = &warnings("1e9")[0];
        assert!(text.contains("mode 1 (0.005220 s, 11.1 % too long), 2 (") && text.ends_with("modes to 0"), "{text}");
    }

    #[test]
    fn the_elongation_is_that_of_the_average_acceleration() {
        // tan(W / 2) = w / 2.
        let exact = 0.6 / (0.3_f64.atan() * 2.0) - 1.0;
        assert!((elongation(&Integrator::default(), 0.6).unwrap() - exact).abs() < 1e-14);
        assert_eq!(elongation(&Integrator { rho_infinity: Some(0.8), ..Integrator::default() }, 0.6), None);
    }
}
