//! Which scenes are compared, at which spacings, and what counts as their error.

/// How one scene is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Name of the scene.
    pub scene: &'static str,
    /// Checks of the scene whose distance from the reference is an error. The first is drawn.
    pub figures: &'static [&'static str],
    /// Particle spacings \[m\], coarse to fine.
    pub spacings: &'static [f64],
    /// End of the run \[s\] where it is shorter than the scene's.
    pub end: Option<f64>,
    /// What a reader must know of the figures; empty for nothing.
    pub note: &'static str,
}

/// The scenes with a reference that depends on the fluid alone, most exact first.
pub const PLANS: [Plan; 8] = [
    Plan {
        scene: "hydrostatic",
        figures: &["pressure against rho g (H - y), L2", "wall pressure, temporal rms", "fall of the centre of mass"],
        spacings: &[0.04, 0.025, 0.016, 0.01],
        end: Some(2.0),
        note: "A scheme that is exact for a linear pressure shows the tolerance of its pressure solver here, and no order.",
    },
    Plan {
        scene: "standing_wave",
        figures: &[
            "energy of the wave lost in ten periods",
            "period, from the centre of mass",
            "elevation at the wall over five periods, rms over mean",
        ],
        spacings: &[0.04, 0.025, 0.016, 0.01],
        end: None,
        note: "Water that loses volume sinks below its level of rest, so more than the energy of the wave can be lost. The \
               elevation is compared with a series of third order that is itself cut off, so its error has a floor.",
    },
    Plan {
        scene: "rotating_square",
        figures: &[
            "centre pressure to omega t = 1.5, largest error over mean",
            "corner to omega t = 1.5, largest error over mean",
        ],
        spacings: &[0.04, 0.025, 0.016, 0.01],
        end: None,
        note: "Where the water has come apart into single particles, there is no corner and its distance counts as 0. The \
               kinetic energy is no measure here: particles that fly apart freely keep it.",
    },
    Plan {
        scene: "oscillating_drop",
        figures: &[
            "semi-axis along x over one period, largest error",
            "centre pressure over one period, rms over mean",
            "energy lost in one period",
        ],
        spacings: &[0.08, 0.05, 0.032, 0.02],
        end: Some(4.58),
        note: "",
    },
    Plan {
        scene: "stretching_drop",
        figures: &[
            "semi-axis along x, largest error",
            "semi-axis along y at 0.0076 s",
            "centre pressure, rms over mean",
        ],
        spacings: &[0.08, 0.05, 0.032, 0.02],
        end: None,
        note: "",
    },
    Plan {
        scene: "dam_break_peers",
        figures: &["energy lost by 0.2 s", "front at 0.2 s"],
        spacings: &[0.0073, 0.0045625, 0.00292, 0.002],
        end: Some(0.2),
        note: "The front is compared with what other codes converge to, which is known to about one per cent.",
    },
    Plan {
        scene: "dam_break_front",
        figures: &[
            "front against the experiment, rms of Z",
            "height of the column against the experiment, rms",
            "late speed dZ/dT",
        ],
        spacings: &[0.005715, 0.003571875, 0.002286, 0.00142875],
        end: None,
        note: "An experiment with a gate and friction: no scheme converges to it, and its scatter is a floor of the error.",
    },
    Plan {
        scene: "forced_sloshing",
        figures: &["elevation beside the left wall, rms over mean"],
        spacings: &[0.04, 0.024, 0.015, 0.01],
        end: Some(6.0),
        note: "",
    },
];

/// The plan of a scene.
pub fn find(scene: &str) -> Result<Plan, String> {
    PLANS.into_iter().find(|plan| plan.scene == scene).ok_or_else(|| {
        let names = PLANS.map(|plan| plan.scene);
        let hint = scene::nearest(scene, names.into_iter());
        let hint = hint.map_or_else(String::new, |name| format!("; did you mean '{name}'?"));
        format!("no comparison is planned for '{scene}', expected one of {}{hint}", names.join(", "))
    })
}

impl Plan {
    /// The first `levels` spacings; in a quick try the coarsest one and twice that.
    pub fn levels(&self, levels: usize, smoke: bool) -> Vec<f64> {
        let coarsest = self.spacings[0];
        if smoke { vec![2.0 * coarsest, coarsest] } else { self.spacings.iter().copied().take(levels).collect() }
    }

    /// Communication step \[s\] at a spacing, for a scene with this one and a run to `end`: the scene's at the finest
    /// spacing and in proportion to the spacing above, so that no fixed step holds the error up or slows the coarse
    /// runs down; shortened to divide the run.
    pub fn communication_step(&self, spacing: f64, step: f64, end: f64) -> f64 {
        let finest = self.spacings.last().copied().unwrap_or(spacing);
        end / (end / (step * (spacing / finest).max(1.0)) * (1.0 - 1e-9)).ceil()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;
    use std::path::Path;

    #[test]
    fn plans_name_checks_that_their_scenes_have_and_go_from_coarse_to_fine() {
        for plan in PLANS {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{}.toml", plan.scene));
            let scene = Scene::from_file(&path).unwrap();
            for figure in plan.figures {
                let check =
                    scene.check.iter().find(|check| check.name == *figure).unwrap_or_else(|| panic!("{figure}"));
                let end = plan.end.unwrap_or(scene.run.end);
                assert!(check.from.is_none_or(|from| from < end * 1.001), "{}: {figure}", plan.scene);
                // A window in the curve's own time cannot be told from the check alone.
                let needs = check.to.filter(|_| check.time_scale == 1.0);
                assert!(needs.is_none_or(|to| to <= end * 1.001), "{}: {figure}", plan.scene);
            }
            assert!(plan.spacings.len() >= 3 && plan.spacings.is_sorted_by(|a, b| a > b), "{}", plan.scene);
            assert!(plan.end.is_none_or(|end| end < scene.run.end), "{}", plan.scene);
        }
    }

    #[test]
    fn the_communication_step_grows_with_the_spacing_and_divides_the_run() {
        let plan = Plan { spacings: &[0.04, 0.01], ..PLANS[0] };
        assert!((plan.communication_step(0.01, 0.01, 2.0) - 0.01).abs() < 1e-15);
        assert!((plan.communication_step(0.04, 0.01, 2.0) - 0.04).abs() < 1e-15);
        // 0.03 s does not divide 2 s: 67 steps do.
        assert!((plan.communication_step(0.03, 0.01, 2.0) - 2.0 / 67.0).abs() < 1e-15);
        assert!((plan.communication_step(0.005, 0.01, 2.0) - 0.01).abs() < 1e-15);
    }

    #[test]
    fn a_scene_without_a_plan_is_refused_with_the_nearest_name() {
        let message = find("standing_wav").unwrap_err();
        assert!(message.contains("did you mean 'standing_wave'?") && message.contains("forced_sloshing"), "{message}");
        assert_eq!(find("hydrostatic").unwrap().levels(2, false), [0.04, 0.025]);
        assert_eq!(find("hydrostatic").unwrap().levels(9, true), [0.08, 0.04]);
    }
}
