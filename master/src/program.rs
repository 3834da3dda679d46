//! The program as studies see it.

use crate::checkpoint::Schedule;
use crate::command::run::{RunArguments, execute};
use crate::log::Log;
use crate::progress::{Progress, Style};
use crate::scene_case::{self, Places};
use crate::{in_process, pack, run, tell};
use components::Interface;
use report::record::{Series, Summary};
use scene::Scene;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use studies::{Failure, FinishedRun, Measured, Program, Request};

/// How often a process is looked at.
const TICK: Duration = Duration::from_millis(50);

/// This program.
pub struct Plimsoll;

/// The command line of a run.
fn arguments(request: &Request) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = vec!["run".into(), request.scene.clone().into(), "--quiet".into()];
    arguments.extend(["--out".into(), request.out.clone().into()]);
    arguments.extend(request.set.iter().flat_map(|change| ["--set".into(), change.clone().into()]));
    arguments.extend(request.threads.iter().flat_map(|threads| ["--threads".into(), threads.to_string().into()]));
    let flags = [("--quick", request.quick), ("--resume", request.resume), ("--overwrite", request.overwrite)];
    arguments.extend(flags.into_iter().filter(|(_, wanted)| *wanted).map(|(flag, _)| flag.into()));
    arguments
}

/// Asks a process to end after its step; one that cannot be asked is ended at once.
fn end(child: &mut Child) {
    #[cfg(unix)]
    if let Ok(process) = i32::try_from(child.id()) {
        // It may have ended by itself meanwhile.
        let _ = nix::sys::signal::kill(nix::unistd::Pid::from_raw(process), nix::sys::signal::Signal::SIGTERM);
    }
    #[cfg(not(unix))]
    let _ = child.kill();
}

/// The error among the lines of a run that did not reach its end.
fn said(standard_error: &[u8]) -> String {
    let text = String::from_utf8_lossy(standard_error);
    let error = text.lines().rev().find_map(|line| line.split_once("error: ").map(|(_, error)| error.to_string()));
    error.unwrap_or_else(|| "it did not reach its end".to_string())
}

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

    fn run_apart(&self, request: &Request, interrupted: &AtomicBool) -> Result<FinishedRun, Failure> {
        let folder = request.out.clone();
        let mut child = Command::new(std::env::current_exe()?)
            .args(arguments(request))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        while !interrupted.load(Ordering::Relaxed) && child.try_wait()?.is_none() {
            std::thread::sleep(TICK);
        }
        if child.try_wait()?.is_none() {
            end(&mut child);
        }
        let output = child.wait_with_output()?;
        let summary = Summary::read(&folder.join("summary.json"));
        match output.status.code() {
            Some(0 | 3) => {
                Ok(FinishedRun { series: Series::read(&folder.join("results.csv"))?, summary: summary?, folder })
            }
            _ => Err(said(&output.stderr).into()),
        }
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
