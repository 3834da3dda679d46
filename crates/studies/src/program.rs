//! What studies need of the program that makes runs.

use report::record::{Series, Status, Summary};
use scene::Scene;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Why a study cannot go on.
pub type Failure = Box<dyn Error>;

/// A run of a scene that is asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// Name of the scene, or path of its file.
    pub scene: String,
    /// Changes of its values, `key.path=value`.
    pub set: Vec<String>,
    /// Whether it is run as its quick variant.
    pub quick: bool,
    /// Folder for the results.
    pub out: PathBuf,
    /// Threads of the fluid; none as the scene says.
    pub threads: Option<usize>,
    /// Whether to go on from a checkpoint in the folder.
    pub resume: bool,
    /// Whether a complete run in the folder is replaced.
    pub overwrite: bool,
    /// Whether it says how it goes.
    pub quiet: bool,
}

/// A run and what it gave.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRun {
    /// Where it is.
    pub folder: PathBuf,
    /// Summary of the run.
    pub summary: Summary,
    /// Recorded variables.
    pub series: Series,
}

/// What a run in this process gave, without files.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// How it ended.
    pub status: Status,
    /// The error of a failed run.
    pub error: Option<String>,
    /// Simulated time \[s\].
    pub simulated: f64,
    /// Recorded variables.
    pub series: Series,
}

/// The program that makes runs.
pub trait Program: Sync {
    /// The files of the scenes.
    ///
    /// # Errors
    /// There is no folder of scenes.
    fn scenes(&self) -> Result<Vec<PathBuf>, Failure>;

    /// Runs a scene and leaves its results in a folder.
    ///
    /// # Errors
    /// A run that cannot start.
    fn run(&self, request: &Request, interrupted: &AtomicBool) -> Result<FinishedRun, Failure>;

    /// The same in a process of its own, so that several may run at once. Its progress is not shown.
    ///
    /// # Errors
    /// A run that cannot start, or that did not reach its end.
    fn run_apart(&self, request: &Request, interrupted: &AtomicBool) -> Result<FinishedRun, Failure>;

    /// Runs a scene in this process, its frames in `folder`, until it ends or `stop` is raised. `path` is its file and
    /// `overrides` what was changed.
    ///
    /// # Errors
    /// A run that cannot start.
    fn measure(
        &self,
        scene: &Scene,
        path: &Path,
        overrides: &[(String, String)],
        threads: usize,
        folder: &Path,
        stop: &AtomicBool,
    ) -> Result<Measured, String>;

    /// Says a line about how it goes.
    fn tell(&self, line: &str);
}
