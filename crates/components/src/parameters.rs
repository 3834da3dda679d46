//! The parameters that both FMUs have: which scene, and where field frames go.

use crate::{Error, find_scene};
use fmi::{Failure, Variable};
use frames::Series;
use scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Zeros and empty texts mean "as the scene says".
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneParameters {
    /// Name of a packed scene, or the path of a scene file.
    pub scene: String,
    /// Changes to the scene.
    pub overrides: String,
    /// Folder for field frames; empty writes none.
    pub output_directory: String,
    /// Time between field frames \[s\].
    pub output_interval: f64,
}

/// A component with these parameters.
pub trait HasSceneParameters {
    /// To read.
    fn common(&self) -> &SceneParameters;
    /// To set.
    fn common_mut(&mut self) -> &mut SceneParameters;
}

impl SceneParameters {
    /// The scene's name, or the name of its file without folders, for messages.
    pub fn scene_file(&self) -> String {
        scene::file_name(Path::new(&self.scene))
    }

    /// The scene with its overrides.
    pub fn find_scene(&self, resources: Option<&Path>) -> Result<Scene, Error> {
        find_scene(&self.scene, &self.overrides, resources)
    }

    /// These parameters, of a saved state, in an instance that has `own` ones: where frames go is the instance's, so
    /// that a state may be restored by another process with another folder.
    pub fn restored(&self, own: &Self) -> Self {
        let mut restored = self.clone();
        if !own.output_directory.is_empty() {
            restored.output_directory.clone_from(&own.output_directory);
        }
        restored
    }

    /// Whether frames go to the same place as often.
    pub fn same_output(&self, other: &Self) -> bool {
        (&self.output_directory, self.output_interval) == (&other.output_directory, other.output_interval)
    }

    /// The frames of `field`, when some are to be written.
    pub fn series(&self, scene: &Scene, field: &'static str, start: f64) -> Result<Option<Series>, Error> {
        let given = self.output_interval;
        let interval = if given > 0.0 { given } else { scene.output.interval };
        if self.output_directory.is_empty() || interval <= 0.0 {
            return Ok(None);
        }
        Ok(Some(Series::new(Path::new(&self.output_directory), field, start, interval)?))
    }
}

/// Whether the state of one scene is a state of another.
///
/// # Errors
/// Both names, and where the scenes differ.
pub fn same_model(own: &Arc<Scene>, other: &Arc<Scene>) -> Result<(), Failure> {
    if Arc::ptr_eq(own, other) {
        return Ok(());
    }
    let Some(difference) = own.model_difference(other) else { return Ok(()) };
    let (own, other) = (&own.title, &other.title);
    Err(Failure::refused(format!("the state belongs to the scene '{other}', this instance has '{own}': {difference}")))
}

/// Rows of the table that choose the scene.
pub fn scene_rows<C: HasSceneParameters>() -> [Variable<C>; 2] {
    [
        Variable::text_parameter(
            1,
            "scene",
            "name of a packed scene, or the path of a scene file; empty takes the one that the FMU was packed for, or else \
             dam_break_plate",
            "",
            |this: &C, _| this.common().scene.clone(),
            |this, _, text| this.common_mut().scene = text.to_string(),
        ),
        Variable::text_parameter(
            2,
            "scene_overrides",
            "changes to the scene: key.path=value; key.path=value",
            "",
            |this: &C, _| this.common().overrides.clone(),
            |this, _, text| this.common_mut().overrides = text.to_string(),
        ),
    ]
}

/// Rows of the table that direct the field frames of `what`.
pub fn output_rows<C: HasSceneParameters>(what: &str) -> [Variable<C>; 2] {
    [
        Variable::text_parameter(
            5,
            "output_directory",
            format!("folder for field frames of the {what}; empty writes none"),
            "",
            |this: &C, _| this.common().output_directory.clone(),
            |this, _, text| this.common_mut().output_directory = text.to_string(),
        ),
        Variable::real(
            6,
            "output_interval",
            "time between field frames; 0 takes the scene's",
            "Duration",
            |this: &C, _| this.common().output_interval,
        )
        .real_parameter(0.0, |this, _, value| this.common_mut().output_interval = value)
        .within(0.0, f64::INFINITY),
    ]
}
