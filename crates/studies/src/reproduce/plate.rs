//! The section of the dam break on an elastic plate: the paper's figures 3 and 4.

use super::FinishedRun;
use maud::{Markup, html};
use report::html::{self, Failure};
use report::{Band, Chart, Curve, FieldFigure, Fields, Quantity, movie};
use std::path::Path;

/// Moments of the water's shape \[s\], around the impact.
const MOMENTS: [f64; 4] = [0.16, 0.26, 0.36, 0.5];
/// Deflection of the tip; the paper plots the upper left corner of the plate.
const TIP: &str = "structure.body.base.plate.deflection.tip";

/// The section for runs at several spacings, coarsest first.
pub fn section(runs: &[FinishedRun], band: Option<Band>, folder: &Path) -> Result<Markup, Failure> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots)?;
    let row = |done: &FinishedRun| {
        let points = tip(done);
        let (time, peak) = points.iter().copied().fold((0.0, 0.0), |most, it| if it.1 > most.1 { it } else { most });
        let summary = &done.summary;
        let number =
            |value: Option<f64>, factor: f64| value.map_or_else(|| "-".into(), |it| format!("{:.0}", factor * it));
        vec![
            number(summary.spacing, 1e3),
            number(summary.particles, 1.0),
            format!("{:?}", summary.status),
            format!("{:.0}", summary.wall_seconds),
            format!("{peak:.2}"),
            format!("{time:.3}"),
        ]
    };
    let curve = |done: &FinishedRun| {
        let spacing = done.summary.spacing.unwrap_or(f64::NAN);
        Curve { label: format!("{:.0} mm", 1e3 * spacing), points: tip(done), markers: false }
    };
    let chart = Chart {
        title: "Displacement of the plate's tip (the paper's figure 4)".to_string(),
        x: "time [s]".to_string(),
        y: "displacement [mm]".to_string(),
        curves: runs.iter().map(curve).collect(),
        band,
    };
    let head = ["spacing [mm]", "particles", "status", "wall-clock time [s]", "peak [mm]", "at [s]"];
    let mut pictures = Vec::new();
    for (index, done) in runs.iter().enumerate() {
        pictures.extend(shapes(done, &plots, index)?);
    }
    Ok(html! {
        h2 { "Dam break on an elastic plate" }
        (html::table(&head, &runs.iter().map(row).collect::<Vec<_>>()))
        (html::chart(&chart)?)
        p { "The band spans four published solutions (Idelsohn et al. 2008, Bogaers et al. 2016, Liu et al. 2013, Sun et al. 2019)." }
        @for picture in pictures { (picture) }
    })
}

fn tip(done: &FinishedRun) -> Vec<(f64, f64)> {
    let column = done.series.column(TIP);
    column.map_or_else(Vec::new, |it| done.series.points(it).map(|(time, value)| (time, 1e3 * value)).collect())
}

/// The water at some moments, and for the coarsest run in motion.
fn shapes(done: &FinishedRun, plots: &Path, index: usize) -> Result<Vec<Markup>, Failure> {
    let fields = Fields::open(&done.folder.join("frames"))?;
    let times = fields.times();
    let Some(&last) = times.last() else { return Ok(Vec::new()) };
    let moments = MOMENTS.iter().filter(|&&time| time <= last);
    let panels: Result<Vec<_>, String> = moments.map(|&time| fields.panel(time, Quantity::Pressure)).collect();
    let figure = FieldFigure { panels: panels?, columns: 2, ..FieldFigure::default() };
    let spacing = 1e3 * done.summary.spacing.unwrap_or(f64::NAN);
    let mut all = Vec::new();
    if !figure.panels.is_empty() {
        let path = figure.draw(&plots.join(format!("plate-{index}")))?;
        all.push(html::picture(&path, &format!("Spacing {spacing:.0} mm (the paper's figure 3)"))?);
    }
    if index == 0
        && let Some(path) = movie(&fields, None, &plots.join("plate-movie.png"))?
    {
        all.push(html::picture(&path, &format!("Spacing {spacing:.0} mm: pressure; the bar at the bottom is time"))?);
    }
    Ok(all)
}
