//! The report as a page of Markdown.

use crate::page::ONE_SAMPLE;
use crate::record::{CheckResult, Status, Summary};
use std::path::{Path, PathBuf};

/// The page for a summary, with what the scene says of itself and the pictures, which are shown by paths relative to
/// `folder`.
pub fn markdown(summary: &Summary, about: &[(&str, &str)], pictures: &[PathBuf], folder: &Path) -> String {
    let mut text = format!("# {}\n\n", if summary.title.is_empty() { &summary.scene } else { &summary.title });
    for (name, content) in about.iter().filter(|(_, content)| !content.is_empty()) {
        text += &format!("**{name}.** {content}\n\n");
    }
    text += &format!("{}\n\n", state(summary));
    for (title, lines) in [("Limits that were missed", &summary.missed), ("Warnings", &summary.warnings)] {
        if !lines.is_empty() {
            text += &format!("## {title}\n\n{}\n", lines.iter().map(|line| format!("- {line}\n")).collect::<String>());
        }
    }
    let facts = facts(summary);
    let rows = facts.iter().map(|(name, value)| format!("| {name} | {value} |\n")).collect::<String>();
    text += &format!("| | |\n|---|---|\n{rows}");
    if !summary.checks.is_empty() {
        text += &format!("\n## Figures\n\n{ONE_SAMPLE}\n\n");
        text += "| figure | value | reference | error | unit | verdict |\n|---|---|---|---|---|---|\n";
        summary.checks.iter().for_each(|(name, check)| text += &row(name, check));
    }
    text += "\n## Wall-clock time by stage\n\n| stage | seconds | share |\n|---|---|---|\n";
    for [stage, seconds, share] in stages(summary) {
        text += &format!("| {stage} | {seconds} | {share} |\n");
    }
    if !pictures.is_empty() {
        text += "\n## Pictures\n\n";
    }
    for picture in pictures {
        let path = picture.strip_prefix(folder).unwrap_or(picture);
        let name = picture.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().replace('-', " "));
        text += &format!("![{name}]({})\n\n", path.display());
    }
    text
}

/// How a run ended, in a sentence.
pub(super) fn state(summary: &Summary) -> String {
    let reached = format!("{:.6} s simulated in {:.2} s", summary.simulated_seconds, summary.wall_seconds);
    let missed = summary.missed.len();
    match (summary.status, &summary.error) {
        (Status::Complete, _) if missed > 0 => {
            format!("**The run reached its end, but missed {missed} of its limits**: {reached}.")
        }
        (Status::Complete, _) => format!("The run reached its end: {reached}."),
        (Status::Interrupted, _) => format!("**The run was interrupted**: {reached}."),
        (Status::Failed, Some(error)) => format!("**The run failed**: {reached}; {error}."),
        (Status::Failed, None) => format!("**The run failed**: {reached}."),
    }
}

/// Numbers of a run, by name.
pub(super) fn facts(summary: &Summary) -> Vec<(&'static str, String)> {
    let coupling = &summary.coupling;
    let mut rows = vec![("steps", summary.steps.to_string())];
    rows.extend(summary.scheme.clone().map(|scheme| ("scheme", scheme)));
    rows.extend(summary.spacing.map(|spacing| ("particle spacing", format!("{spacing} m"))));
    rows.extend(summary.particles.map(|count| ("particles", count.to_string())));
    rows.push(("coupling", coupling.method.clone()));
    rows.push(("iterations per step, mean", format!("{:.2}", coupling.mean_iterations)));
    rows.push(("iterations per step, most", coupling.maximum_iterations.to_string()));
    rows.push(("steps repeated smaller", coupling.rollbacks.to_string()));
    rows.extend(summary.jumps_per_step.map(|jumps| ("cells that jumped, per step", Short(jumps).to_string())));
    let percent = |gain: f64| format!("{:.2} % of the energy of the run", 100.0 * gain);
    rows.extend(summary.energy_gain.map(|gain| ("energy gained that nothing supplied, at most", percent(gain))));
    rows
}

/// Stages with their seconds and shares, the longest first.
pub(super) fn stages(summary: &Summary) -> Vec<[String; 3]> {
    let total: f64 = summary.stages.values().sum::<f64>().max(1e-12);
    let mut stages: Vec<_> = summary.stages.iter().collect();
    stages.sort_by(|a, b| b.1.total_cmp(a.1));
    let row = |(stage, seconds): (&String, &f64)| {
        [stage.clone(), format!("{seconds:.3}"), format!("{:.1} %", 100.0 * seconds / total)]
    };
    stages.into_iter().map(row).collect()
}

/// What came of a check, in words.
pub(super) fn verdict(check: &CheckResult) -> String {
    match (check.passed, &check.problem) {
        (_, Some(problem)) => problem.clone(),
        (Some(true), _) => "within the limit".to_string(),
        (Some(false), _) => "**outside the limit**".to_string(),
        (None, _) => check
            .details
            .iter()
            .map(|(name, value)| format!("{} {}", name.replace('_', " "), Short(*value)))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

/// A number, or a dash where there is none.
pub fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_string(), |value| Short(value).to_string())
}

fn row(name: &str, check: &CheckResult) -> String {
    let [value, reference, error] = [check.value, check.reference, check.error].map(number);
    format!("| {name} | {value} | {reference} | {error} | {} | {} |\n", check.unit, verdict(check))
}

/// A number with four significant digits.
pub struct Short(pub f64);

impl std::fmt::Display for Short {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-3..1e5).contains(&size) {
            return write!(formatter, "{:.3e}", self.0);
        }
        let decimals = if size == 0.0 { 0 } else { (3.0 - size.log10().floor()).clamp(0.0, 6.0) as usize };
        write!(formatter, "{:.decimals$}", self.0)
    }
}
