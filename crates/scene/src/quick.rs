//! The quick variant of a scene: the same, coarser and shorter, with limits of its own, for tests.

use crate::{Check, Error, Scene, parse_overrides};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The quick variant of a scene. Of its checks only those with a `quick` table are made.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Quick {
    /// Whether the scene is read as its quick variant: what `plimsoll run --quick` sets.
    pub active: bool,
    /// What it changes, `key.path=value` as with `--set`.
    pub set: Vec<String>,
}

/// What a check has otherwise in the quick variant; an absent key keeps the check's own.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct QuickCheck {
    /// Largest error that counts as passed; absent: reported only.
    pub limit: Option<f64>,
    /// Expected value.
    pub reference: Option<f64>,
    /// Start of the window \[s\].
    pub from: Option<f64>,
    /// End of the window \[s\].
    pub to: Option<f64>,
}

impl Quick {
    /// What the variant changes, as pairs of key path and TOML value.
    ///
    /// # Errors
    /// No entry, or one that is no `key.path=value`; `name` is that of the scene.
    pub(crate) fn overrides(&self, name: &str) -> Result<Vec<(String, String)>, Error> {
        if self.set.is_empty() {
            let (key, expected) = ("quick.set".to_string(), "what the quick variant changes".to_string());
            return Err(Error::Range { name: name.to_string(), key, got: "nothing".to_string(), expected });
        }
        let lists: Result<Vec<_>, _> = self.set.iter().map(|text| parse_overrides(text)).collect();
        Ok(lists?.into_iter().flatten().collect())
    }
}

impl Scene {
    /// Keeps the checks of the quick variant, as they are there.
    pub(crate) fn keep_quick_checks(&mut self) {
        let all = std::mem::take(&mut self.check);
        self.check = all.into_iter().filter_map(Check::into_quick).collect();
    }
}

impl Check {
    fn into_quick(self) -> Option<Self> {
        let quick = self.quick.clone()?;
        Some(Self {
            limit: quick.limit,
            reference: quick.reference.or(self.reference),
            from: quick.from.or(self.from),
            to: quick.to.or(self.to),
            ..self
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::Scene;

    const SCENE: &str = "title = 'tank'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.01\n\
        water = [{ polygon = [[0,0],[1,0],[1,0.5],[0,0.5]] }]\n[quick]\nset = ['fluid.spacing=0.1', 'run.end=0.2']\n\
        [[check]]\nname = 'long'\nkind = 'series_mean'\nvariable = 'v'\nlimit = 0.1\n\
        [[check]]\nname = 'both'\nkind = 'series_mean'\nvariable = 'v'\nreference = 3.0\nlimit = 0.1\nto = 0.9\n\
        quick = { limit = 0.5, to = 0.1 }\n";

    fn read(overrides: &[(&str, &str)]) -> Scene {
        let pairs: Vec<_> = overrides.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect();
        Scene::with_overrides(SCENE, "tank.toml", &pairs).unwrap()
    }

    #[test]
    fn the_quick_variant_is_coarser_and_has_its_own_limits() {
        let (whole, quick) = (read(&[]), read(&[("quick.active", "true")]));
        assert_eq!((whole.run.end, whole.check.len()), (1.0, 2));
        let fluid = quick.fluid.unwrap();
        assert_eq!((quick.run.end, fluid.spacing, quick.check.len()), (0.2, 0.1, 1));
        let check = &quick.check[0];
        assert_eq!((check.limit, check.reference, check.to), (Some(0.5), Some(3.0), Some(0.1)));
    }

    #[test]
    fn what_is_set_by_hand_comes_after_the_variant() {
        let scene = read(&[("run.end", "0.3"), ("quick.active", "true")]);
        assert_eq!((scene.run.end, scene.fluid.unwrap().spacing), (0.3, 0.1));
    }

    #[test]
    fn a_change_that_is_none_is_refused() {
        let text = SCENE.replace("fluid.spacing=0.1", "fluid.spacing");
        let overrides = [("quick.active".to_string(), "true".to_string())];
        let message = Scene::with_overrides(&text, "tank.toml", &overrides).unwrap_err().to_string();
        assert!(message.contains("key.path=value"), "{message}");
    }
}
