//! When, where and of what the figures were measured.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// What a record says of its circumstances.
#[derive(Debug, Clone, PartialEq)]
pub struct Circumstances {
    /// Date and time of day, UTC.
    pub date: String,
    /// Processor, processors, memory, operating system.
    pub machine: String,
    /// Commit of the working directory, with a word if files differ from it; empty if it is no working copy.
    pub commit: String,
    /// The command line.
    pub command: String,
}

impl Circumstances {
    /// As they are now; the commit is that of the working directory.
    pub fn now() -> Self {
        Self { commit: commit().unwrap_or_default(), ..Self::here() }
    }

    /// The same without a commit: an installed program belongs to no working copy.
    pub fn here() -> Self {
        Self { date: date(), machine: machine(), commit: String::new(), command: command() }
    }
}

/// Lines of a page: circumstances, running processes before and after, and runs of each kind.
pub fn table(it: &Circumstances, load: (Option<f64>, Option<f64>), repeats: u32) -> String {
    let processes = |load: Option<f64>| load.map_or_else(|| "unknown".to_string(), |load| format!("{load:.1}"));
    let commit = if it.commit.is_empty() { "unknown" } else { &it.commit };
    format!(
        "| | |\n|---|---|\n| date | {} |\n| machine | {} |\n| running processes before and after, mean of a minute | {} \
         and {} |\n| commit | {commit} |\n| command | `{}` |\n| repeats | {repeats}, the fastest counts |\n\n",
        it.date,
        it.machine,
        processes(load.0),
        processes(load.1),
        it.command
    )
}

fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (year, month, day) = civil(seconds / 86_400);
    let (hour, minute) = (seconds / 3600 % 24, seconds / 60 % 60);
    format!("{year}-{month:02}-{day:02} {hour:02}:{minute:02} UTC")
}

/// Year, month and day in the Gregorian calendar, from the days since 1 January 1970.
fn civil(days: u64) -> (u64, u64, u64) {
    let leap = |year: u64| (year.is_multiple_of(4) && !year.is_multiple_of(100)) || year.is_multiple_of(400);
    let (mut year, mut left) = (1970, days);
    while left >= 365 + u64::from(leap(year)) {
        left -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if left < length {
            break;
        }
        left -= length;
        month += 1;
    }
    (year, month, left + 1)
}

fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cpu = field("/proc/cpuinfo", "model name", ':').unwrap_or_else(|| std::env::consts::ARCH.to_string());
    let memory = field("/proc/meminfo", "MemTotal", ':').and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    let memory = memory.map_or_else(String::new, |kib| format!(", {:.0} GiB", kib / 1024.0 / 1024.0));
    let system = field("/etc/os-release", "PRETTY_NAME", '=');
    let system = system.map_or_else(|| std::env::consts::OS.to_string(), |name| name.trim_matches('"').to_string());
    format!("{cpu}, {cores} processors{memory}, {system}")
}

/// Value of a line `key SEPARATOR value` of a file.
fn field(path: &str, key: &str, separator: char) -> Option<String> {
    let text = std::fs::read_to_string(Path::new(path)).ok()?;
    let line = text.lines().find(|line| line.split(separator).next().is_some_and(|name| name.trim() == key))?;
    Some(line.split_once(separator)?.1.trim().to_string())
}

/// Mean number of running processes over the last minute, the program's own included, where the system tells it.
pub fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed = git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|text| !text.is_empty());
    Some(if changed { format!("{commit}, with changes") } else { commit })
}

/// The command line, with the program's name instead of its path.
fn command() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
    std::iter::once("plimsoll".to_string()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Processor time of this process \[s\], all threads; none where the system does not tell it.
#[cfg(unix)]
pub fn processor_seconds() -> Option<f64> {
    let time = nix::time::clock_gettime(nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID).ok()?;
    Some(std::time::Duration::from(time).as_secs_f64())
}

/// Processor time of this process \[s\], all threads; none where the system does not tell it.
#[cfg(not(unix))]
pub fn processor_seconds() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates() {
        // Days since the epoch of known dates: a leap day, the day after, the end and the start of a century's year.
        assert_eq!(civil(0), (1970, 1, 1));
        assert_eq!(civil(11_016), (2000, 2, 29));
        assert_eq!(civil(11_017), (2000, 3, 1));
        assert_eq!(civil(20_453), (2025, 12, 31));
        assert_eq!(civil(20_454), (2026, 1, 1));
    }

    #[test]
    fn the_machine_is_named() {
        let circumstances = Circumstances::now();
        assert!(circumstances.machine.contains("processors"), "{}", circumstances.machine);
        assert!(circumstances.date.ends_with("UTC") && circumstances.command.starts_with("plimsoll"));
    }

    #[cfg(unix)]
    #[test]
    fn processor_time_grows_with_work() {
        let before = processor_seconds().unwrap();
        let sum: f64 = (0..2_000_000).map(|i| f64::from(i).sqrt()).sum();
        assert!(sum > 0.0 && processor_seconds().unwrap() > before);
    }
}
