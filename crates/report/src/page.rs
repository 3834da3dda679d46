//! report.html of a run: everything about it in one page that opens without a network.

use super::html;
use super::text::{facts, number, stages, state, verdict};
use super::{Pictures, figures::MOVIE};
use crate::record::{CheckResult, Recipe, Summary};
use maud::{Markup, html};

/// What figures of a single run are.
pub const ONE_SAMPLE: &str =
    "Figures of one run: peaks of an impact are one sample each, `plimsoll ensemble` says how far they repeat.";

/// The page for a summary, with what the scene says of itself, charts and pictures.
pub fn run_page(summary: &Summary, about: &[(&str, &str)], recipe: Option<&Recipe>, pictures: &Pictures) -> String {
    let title = if summary.title.is_empty() { &summary.scene } else { &summary.title };
    let failures = pictures.failures.iter().map(ToString::to_string);
    let warnings: Vec<String> = summary.warnings.iter().cloned().chain(failures).collect();
    let body = html! {
        p { (state(summary).replace("**", "")) }
        @for (name, content) in about.iter().filter(|(_, content)| !content.is_empty()) { p { b { (name) ". " } (content) } }
        @if !summary.missed.is_empty() { h2 { "Limits that were missed" } ul { @for limit in &summary.missed { li { (limit) } } } }
        @if !warnings.is_empty() { h2 { "Warnings" } ul { @for warning in &warnings { li { (warning) } } } }
        @if !summary.checks.is_empty() { h2 { "Figures" } p { (ONE_SAMPLE) } (checks(summary)) }
        (images(pictures))
        h2 { "Charts" }
        @for (index, (_, chart)) in pictures.charts.iter().enumerate() { (html::interactive(chart, &format!("chart-{index}"))) }
        h2 { "Run" }
        (html::table(&["", ""], &rows(summary, recipe)))
        h2 { "Wall-clock time by stage" }
        (html::table(&["stage", "seconds", "share"], &stages(summary).into_iter().map(Vec::from).collect::<Vec<_>>()))
    };
    html::interactive_page(title, &body)
}

fn rows(summary: &Summary, recipe: Option<&Recipe>) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> =
        facts(summary).into_iter().map(|(name, value)| vec![name.to_string(), value]).collect();
    rows.push(vec!["version".to_string(), summary.version.clone()]);
    if let Some(recipe) = recipe {
        let changes = if recipe.set.is_empty() { "none".to_string() } else { recipe.set.join("; ") };
        let more = [
            ("changed values", changes),
            ("command", recipe.command.clone()),
            ("begun", recipe.date.clone()),
            ("machine", recipe.machine.clone()),
        ];
        rows.extend(more.map(|(name, value)| vec![name.to_string(), value]));
    }
    rows
}

fn checks(summary: &Summary) -> Markup {
    let row = |(name, check): (&String, &CheckResult)| {
        let [value, reference, error] = [check.value, check.reference, check.error].map(number);
        let verdict = verdict(check).replace("**", "");
        vec![name.clone(), value, reference, error, check.unit.clone(), verdict, check.source.clone()]
    };
    let rows: Vec<Vec<String>> = summary.checks.iter().map(row).collect();
    html::table(&["figure", "value", "reference", "error", "unit", "verdict", "source"], &rows)
}

/// The field at some moments and in motion; a picture that cannot be read is left out, for it was named before.
fn images(pictures: &Pictures) -> Markup {
    let caption = |name: &str| match name {
        "field.png" => Some("Pressure at some moments"),
        "field-last.png" => Some("Pressure at the end"),
        MOVIE => Some("Pressure in motion; the bar at the bottom is time"),
        _ => None,
    };
    let named = |path: &std::path::PathBuf| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned())?;
        html::picture(path, caption(&name)?).ok()
    };
    let images: Vec<Markup> = pictures.files.iter().filter_map(named).collect();
    html! { @if !images.is_empty() { h2 { "The field" } } @for image in images { (image) } }
}
