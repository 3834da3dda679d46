//! The program as studies see it.

use crate::checkpoint::Schedule;
use crate::command::run::{RunArguments, execute};
use crate::log::Log;
use crate::progress::{Progress, Style};
use crate::scene_case::{self, Places};
use crate::{in_process, pack, run, tell};
use components::Interface;
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use studies::{Failure, FinishedRun, Measured, Program, Request};

/// This program.
pub struct Plimsoll;

impl Program for Plimsoll {
    fn scenes(&self) -> Result<Vec<PathBuf>, Failure> {
        pack::files_with(&pack::scenes_folder()?, "toml").map_err(Into::into)
    }

    fn run(&self, request: &Request, interrupted: &AtomicBool) -> Result<FinishedRun, Failure> {
        let Request { scene, set, quick, out, threads, resume, overwrite, quiet } = request.clone();
        let arguments = RunArguments {
            target: scene,
            set,
            quick,
            out: Some(out),
            threads,
            resume,
            overwrite,
            quiet,
            ..RunArguments::default()
        };
        let (summary, outcome, folder) = execute(&arguments, interrupted)?;
        Ok(FinishedRun { folder, summary, series: outcome.series })
    }

    fn measure(
        &self,
        scene: &Scene,
        path: &Path,
        overrides: &[(String, String)],
        threads: usize,
        folder: &Path,
        stop: &AtomicBool,
    ) -> Result<Measured, String> {
        let places = Places { scene: path.to_path_buf(), fmus: folder.to_path_buf(), frames: folder.join("frames") };
        let case = scene_case::case(scene, overrides, Some(threads), &places);
        let participants = in_process::participants(&case, &Interface::of(scene), &Log::default())
            .map_err(|error| error.to_string())?;
        let mut progress = Progress::new(case.start, case.run.end, Style::Quiet);
        let (outcome, _) = run::run(&case, participants, folder, Schedule::never(), None, stop, &mut progress)
            .map_err(|error| error.to_string())?;
        let run::Outcome { status, error, simulated, series, .. } = outcome;
        Ok(Measured { status, error: error.map(|error| error.to_string()), simulated, series })
    }

    fn tell(&self, line: &str) {
        tell!("{line}");
    }
}
