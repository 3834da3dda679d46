//! Which scenes give the same numbers: a run that was stopped may go on with another end, a state may go on in another
//! process.

use crate::{Fluid, Output, Run, Scene};

impl Scene {
    /// The same without what does not change the numbers up to a given time: a run that goes on may have another one.
    pub fn for_resuming(&self) -> Self {
        let (title, source, differs, check, quick) = Default::default();
        let (run, output) = (self.run.for_resuming(), self.output.for_resuming());
        let fluid = self.fluid.clone().map(|fluid| Fluid { threads: 0, ..fluid });
        Self { title, source, differs, check, quick, run, output, fluid, ..self.clone() }
    }

    /// Where another scene is another one to the water and the bodies, so that a state of one is none of the other; none
    /// where it is the same. How long they run, how they are coupled, on how many threads, and what is recorded may differ.
    pub fn model_difference(&self, other: &Self) -> Option<String> {
        let model = |scene: &Self| {
            let (output, coupling, watch) = Default::default();
            Self { run: self.run.for_resuming(), output, coupling, watch, ..scene.for_resuming() }
        };
        let (own, other) = (model(self), model(other));
        if own == other {
            return None;
        }
        let lines = |scene: &Self| toml::to_string(scene).unwrap_or_default();
        let (own, other) = (lines(&own), lines(&other));
        let mut pairs = other.lines().zip(own.lines());
        let (there, here) = pairs.find(|(there, here)| there != here).unwrap_or(("more", "less"));
        Some(format!("`{there}` there, `{here}` here"))
    }
}

impl Run {
    /// The same whatever its end.
    pub fn for_resuming(&self) -> Self {
        Self { end: 0.0, ..self.clone() }
    }
}

impl Output {
    /// The same whatever is plotted, and however often checkpoints are written.
    pub fn for_resuming(&self) -> Self {
        let Self { checkpoint_interval, plot, .. } = Self::default();
        Self { checkpoint_interval, plot, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = 't'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.1\n\
        water = [{ polygon = [[0,0],[2,0],[2,1],[0,1]] }]\nwall = [{ points = [[0,2],[0,0],[2,0],[2,2]] }]\n";

    fn with(key: &str, value: &str) -> Scene {
        crate::from_toml(SCENE, "t.toml", &[(key.to_string(), value.to_string())]).unwrap()
    }

    #[test]
    fn a_run_goes_on_whatever_its_end_and_its_threads() {
        let scene = Scene::from_str(SCENE, "t.toml").unwrap();
        for (key, value) in [("run.end", "2.0"), ("fluid.threads", "3"), ("output.checkpoint_interval", "1.0")] {
            assert_eq!(with(key, value).for_resuming(), scene.for_resuming(), "{key}");
        }
        for (key, value) in [("run.communication_step", "0.02"), ("output.interval", "0.1"), ("fluid.density", "900")] {
            assert_ne!(with(key, value).for_resuming(), scene.for_resuming(), "{key}");
        }
    }

    #[test]
    fn a_state_fits_the_same_water_however_it_is_run() {
        let scene = Scene::from_str(SCENE, "t.toml").unwrap();
        for (key, value) in
            [("run.communication_step", "0.02"), ("output.interval", "0.1"), ("watch.speed", "9.0"), ("title", "other")]
        {
            assert_eq!(scene.model_difference(&with(key, value)), None, "{key}");
        }
        let difference = scene.model_difference(&with("fluid.density", "900.0"));
        assert_eq!(difference.as_deref(), Some("`density = 900.0` there, `density = 1000.0` here"));
    }
}
