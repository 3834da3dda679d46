//! What can go wrong between a scene and a component.

use thiserror::Error;

/// A scene that a component cannot use, or a frame that cannot be written.
#[derive(Debug, Error)]
pub enum Error {
    /// The scene is neither a file nor a packed scene.
    #[error("scene '{name}' not found: {reason}")]
    SceneNotFound {
        /// Name as given.
        name: String,
        /// Where was looked, and what there is.
        reason: String,
    },
    /// A scene of which something cannot be used, with its file.
    #[error("{scene}: {error}")]
    InScene {
        /// Name or path of the scene, as given.
        scene: String,
        /// What is wrong.
        error: Box<Error>,
    },
    /// The scene file is wrong.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// The scene has no part for this component.
    #[error("scene '{title}' has no {part}: choose another scene or add the table")]
    MissingPart {
        /// Title of the scene.
        title: String,
        /// Missing table.
        part: &'static str,
    },
    /// The scene has a variable that the FMU has not.
    #[error(
        "the scene has '{name}', and this FMU has no such variable: it was packed for another scene; `plimsoll pack SCENE` packs \
         one for this"
    )]
    NotInInterface {
        /// Name of the variable.
        name: String,
    },
    /// A value that this component cannot use.
    #[error("{key} = {}: expected {}", digits::rounded(got), digits::rounded(expected))]
    Value {
        /// Key in the scene or name of the parameter.
        key: String,
        /// Value found.
        got: String,
        /// What would be right.
        expected: String,
    },
    /// Geometry that kinematics refuses.
    #[error(transparent)]
    Kinematics(#[from] kinematics::Error),
    /// Parameters or a step that the structure refuses.
    #[error(transparent)]
    Structure(#[from] structure::Error),
    /// Parameters or a step that the fluid refuses.
    #[error(transparent)]
    Fluid(#[from] fluid::Error),
    /// A field frame that cannot be written or read.
    #[error(transparent)]
    Frame(#[from] frames::Error),
}

impl Error {
    /// The same error with the scene that it is about, unless it names one itself.
    #[must_use]
    pub fn in_scene(self, scene: &str) -> Self {
        match self {
            Self::SceneNotFound { .. } | Self::Scene(_) | Self::InScene { .. } | Self::Frame(_) => self,
            error if scene.is_empty() => error,
            error => Self::InScene { scene: scene.to_string(), error: Box::new(error) },
        }
    }
}
