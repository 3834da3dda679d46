//! The section of the cabins: tables, charts, fields and an animation.

use super::cabin::{self, PERIOD, TABLE};
use super::{FinishedRun, Model, balance};
use maud::{Markup, html};
use report::html::{self, Failure};
use report::record::Status;
use report::{Chart, Curve, FieldFigure, Fields, Quantity, movie};
use std::path::Path;

/// Histories: the paper's figure, title, variable, axis, factor.
const HISTORIES: [(&str, &str, &str, &str, f64); 7] = [
    (
        "6",
        "Deflection of the bulkhead's middle",
        "structure.body.cabin.bulkhead.deflection.middle",
        "deflection [mm]",
        1e3,
    ),
    ("7", "Water in the flooded compartment", "fluid.region.flooded_compartment.mass", "mass [kg/m]", 1.0),
    ("8", "Roll, to the damaged side", "structure.body.cabin.motion.theta", "roll [rad]", 1.0),
    ("", "Heave", "structure.body.cabin.motion.y", "heave [m]", 1.0),
    ("", "Sway", "structure.body.cabin.motion.x", "sway [m]", 1.0),
    ("12", "Pressure at P1", "fluid.probe.P1.pressure", "pressure [kPa]", 1e-3),
    ("12", "Pressure at P2", "fluid.probe.P2.pressure", "pressure [kPa]", 1e-3),
];
/// Half the side of the square around the cabin that pictures show \[m\], and where the cabin starts.
const AROUND: f64 = 0.62;
const START: [f64; 2] = [2.0, 0.7206];

/// The section. `others` are the models of other folders with their spacings.
pub fn section(models: &[Model], others: &[(f64, Vec<Model>)], folder: &Path) -> Result<Markup, Failure> {
    Ok(html! {
        h2 { "Runs" }
        (runs(models))
        p { "Peaks and averages below are taken up to " (PERIOD) " s." }
        h2 { "Table 2: pressures at P1 and P2 [kPa], ours (the paper's)" }
        (table(models))
        h2 { "The paper's trends" }
        (trends(models))
        h2 { "Histories" }
        @for chart in histories(models) { (html::chart(&chart)?) }
        h2 { "Along the bulkhead" }
        (html::chart(&profile(models, "Average pressure (the paper's figure 9)", false))?)
        (html::chart(&profile(models, "Peak pressure (the paper's figure 10)", true))?)
        h2 { "Load on the bulkhead: flooded face minus the other" }
        (loads(models))
        (html::chart(&history(models, "Net force on the bulkhead", "force [N/m]", |done| cabin::net_force(&done.series)))?)
        h2 { "Energy of water and cabin" }
        (energies(models))
        (html::chart(&history(models, "Energy above that of the start", "energy [J/m]", above_the_start))?)
        @if !others.is_empty() { (convergence(models, others)?) }
        (fields(models, folder)?)
    })
}

fn runs(models: &[Model]) -> Markup {
    let head = [
        "model",
        "E [GPa]",
        "status",
        "simulated [s]",
        "wall-clock time [s]",
        "spacing [mm]",
        "particles",
        "passes per step",
    ];
    let row = |model: &Model| {
        let summary = &model.done.summary;
        let modulus = if model.youngs_modulus.is_finite() {
            format!("{:.1}", 1e-9 * model.youngs_modulus)
        } else {
            "rigid".to_string()
        };
        let number =
            |value: Option<f64>, factor: f64| value.map_or_else(|| "-".into(), |it| format!("{:.0}", factor * it));
        vec![
            model.name.to_string(),
            modulus,
            format!("{:?}", summary.status),
            format!("{:.3}", summary.simulated_seconds),
            format!("{:.0}", summary.wall_seconds),
            number(summary.spacing, 1e3),
            number(summary.particles, 1.0),
            format!("{:.2}", summary.coupling.mean_iterations),
        ]
    };
    let errors = models.iter().filter(|model| model.done.summary.status == Status::Failed);
    html! {
        (html::table(&head, &models.iter().map(row).collect::<Vec<_>>()))
        @for model in errors { p { "Model " (model.name) ": " (model.done.summary.error.as_deref().unwrap_or("failed")) } }
    }
}

fn table(models: &[Model]) -> Markup {
    let row = |(model, paper): (&Model, [f64; 4])| {
        let cell = |(own, other): (Option<f64>, f64)| {
            let own = own.map_or_else(|| "-".to_string(), |value| format!("{value:.2}"));
            format!("{own} ({other:.2})")
        };
        let cells = cabin::table_row(model).into_iter().zip(paper).map(cell);
        std::iter::once(model.name.to_string()).chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = models.iter().zip(TABLE).map(row).collect();
    html::table(&["model", "peak P1", "average P1", "peak P2", "average P2"], &rows)
}

fn trends(models: &[Model]) -> Markup {
    let row = |trend: cabin::Trend| {
        let found = match trend.found {
            Some(true) => "yes",
            Some(false) => "no",
            None => "-",
        };
        vec![trend.claim.to_string(), found.to_string(), trend.numbers]
    };
    let rows: Vec<Vec<String>> = cabin::trends(models).into_iter().map(row).collect();
    html::table(&["trend", "found", "ours, models I to IV"], &rows)
}

fn curve(label: String, done: &FinishedRun, variable: &str, factor: f64) -> Option<Curve> {
    let column = done.series.column(variable)?;
    let points = done.series.points(column).map(|(time, value)| (time, factor * value)).collect();
    Some(Curve { label, points, markers: false })
}

fn histories(models: &[Model]) -> Vec<Chart> {
    let chart = |(figure, title, variable, axis, factor): &(&str, &str, &str, &str, f64)| {
        let source = if figure.is_empty() { String::new() } else { format!(" (the paper's figure {figure})") };
        let of = |model: &Model| curve(format!("model {}", model.name), &model.done, variable, *factor);
        Chart {
            title: format!("{title}{source}"),
            x: "time [s]".to_string(),
            y: axis.to_string(),
            curves: models.iter().filter_map(of).collect(),
            band: None,
        }
    };
    HISTORIES.iter().map(chart).collect()
}

/// A history that is computed from the recorded ones.
fn history(models: &[Model], title: &str, axis: &str, of: impl Fn(&FinishedRun) -> Vec<(f64, f64)>) -> Chart {
    let curve =
        |model: &Model| Curve { label: format!("model {}", model.name), points: of(&model.done), markers: false };
    Chart {
        title: title.to_string(),
        x: "time [s]".to_string(),
        y: axis.to_string(),
        curves: models.iter().map(curve).collect(),
        band: None,
    }
}

fn profile(models: &[Model], title: &str, peak: bool) -> Chart {
    let curve = |model: &Model| {
        let points = cabin::along_bulkhead(model, true).into_iter();
        let points = points.map(|(height, most, mean)| (height, if peak { most } else { mean })).collect();
        Curve { label: format!("model {}", model.name), points, markers: false }
    };
    Chart {
        title: title.to_string(),
        x: "height above the inner bottom, over the bulkhead's [1]".to_string(),
        y: "pressure on the flooded face [kPa]".to_string(),
        curves: models.iter().map(curve).collect(),
        band: None,
    }
}

fn loads(models: &[Model]) -> Markup {
    let row = |model: &Model| {
        let (peak, time, impulse) = cabin::peak_and_impulse(&cabin::net_force(&model.done.series));
        vec![model.name.to_string(), format!("{peak:.0}"), format!("{time:.3}"), format!("{impulse:.1}")]
    };
    let rows: Vec<Vec<String>> = models.iter().map(row).collect();
    html::table(&["model", "peak [N/m]", "at [s]", "impulse [N s/m]"], &rows)
}

fn above_the_start(done: &FinishedRun) -> Vec<(f64, f64)> {
    let all = balance::energy(&done.series);
    let start = all.first().map_or(0.0, |it| it.1);
    all.into_iter().map(|(time, energy)| (time, energy - start)).collect()
}

fn energies(models: &[Model]) -> Markup {
    let row = |model: &Model| {
        let all = above_the_start(&model.done);
        let end = all.last().map_or(f64::NAN, |it| it.1);
        vec![model.name.to_string(), format!("{end:.2}"), format!("{:.3}", balance::largest_rise(&all))]
    };
    let rows: Vec<Vec<String>> = models.iter().map(row).collect();
    html::table(&["model", "at the end [J/m]", "largest rise above the lowest before [J/m]"], &rows)
}

/// Histories of model I at all spacings, and the figures of all models.
fn convergence(models: &[Model], others: &[(f64, Vec<Model>)]) -> Result<Markup, Failure> {
    let own = models.first().and_then(|model| model.done.summary.spacing).unwrap_or(f64::NAN);
    let mut all: Vec<(f64, &[Model])> = others.iter().map(|(spacing, models)| (*spacing, models.as_slice())).collect();
    all.push((own, models));
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let chart = |(_, title, variable, axis, factor): &(&str, &str, &str, &str, f64)| {
        let of = |(spacing, models): &(f64, &[Model])| {
            curve(format!("{:.0} mm", 1e3 * spacing), &models.first()?.done, variable, *factor)
        };
        let title = format!("{title}, model I");
        let (x, y) = ("time [s]".to_string(), axis.to_string());
        html::chart(&Chart { title, x, y, curves: all.iter().filter_map(of).collect(), band: None })
    };
    let charts: Result<Vec<Markup>, Failure> = HISTORIES[..5].iter().map(chart).collect();
    let row = |(spacing, model): (f64, &Model)| {
        let series = &model.done.series;
        let number =
            |value: Option<f64>, factor: f64| value.map_or_else(|| "-".into(), |it| format!("{:.3}", factor * it));
        let most = |name: &str| cabin::peak_and_mean(series, name).map(|it| it.0);
        vec![
            model.name.to_string(),
            format!("{:.0}", 1e3 * spacing),
            number(most("structure.body.cabin.bulkhead.deflection.middle"), 1e3),
            number(cabin::at_the_end(series, "fluid.region.flooded_compartment.mass"), 1.0),
            number(cabin::at_the_end(series, "structure.body.cabin.motion.theta"), 1.0),
            format!("{:.1}", cabin::peak_and_impulse(&cabin::net_force(series)).2),
        ]
    };
    let models = all.iter().flat_map(|(spacing, models)| models.iter().map(|model| (*spacing, model)));
    let rows: Vec<Vec<String>> = models.map(row).collect();
    let head = ["model", "spacing [mm]", "deflection [mm]", "flooded [kg/m]", "roll [rad]", "impulse [N s/m]"];
    Ok(html! {
        h2 { "Convergence" }
        p { "Largest deflection, and the others at " (PERIOD) " s." }
        (html::table(&head, &rows))
        @for chart in charts? { (chart) }
    })
}

/// Pressure and speed around every cabin at the paper's moment, and model I in motion.
fn fields(models: &[Model], folder: &Path) -> Result<Markup, Failure> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots)?;
    let mut pictures = Vec::new();
    let named = [(Quantity::Pressure, "pressure", "Pressure"), (Quantity::Speed, "speed", "Speed")];
    for (quantity, name, word) in named {
        let mut figure = FieldFigure { panels: Vec::new(), columns: 2, quantity };
        for model in models {
            let frames = Fields::open(&model.done.folder.join("frames"))?;
            let Some(&time) = frames.times().iter().min_by(|a, b| (*a - PERIOD).abs().total_cmp(&(*b - PERIOD).abs()))
            else {
                continue;
            };
            let panel = frames.panel(time, quantity)?;
            let centre = [0, 1].map(|axis| START[axis] + place(model, time)[axis]);
            figure.panels.push(panel.around(centre, AROUND, &format!("model {}, t = {time:.2} s", model.name)));
        }
        if !figure.panels.is_empty() {
            let path = figure.draw(&plots.join(name))?;
            pictures.push(html::picture(&path, &format!("{word} around the four cabins (the paper's figure 11)"))?);
        }
    }
    let first = models.first().map(|model| Fields::open(&model.done.folder.join("frames"))).transpose()?;
    let moving =
        first.map(|fields| movie(&fields, Some([0.8, 0.0, 3.2, 1.1]), &plots.join("movie.png"))).transpose()?;
    if let Some(path) = moving.flatten() {
        pictures.push(html::picture(&path, "Model I: pressure; the bar at the bottom is time")?);
    }
    Ok(html! {
        @if !pictures.is_empty() { h2 { "The field" } }
        @for picture in pictures { (picture) }
    })
}

/// Sway and heave of the cabin at a time \[m\].
fn place(model: &Model, time: f64) -> [f64; 2] {
    let series = &model.done.series;
    ["structure.body.cabin.motion.x", "structure.body.cabin.motion.y"].map(|name| {
        let points = series.column(name).map(|column| series.points(column));
        let before = points.and_then(|points| points.take_while(|it| it.0 <= time * (1.0 + 1e-9)).last());
        before.map_or(0.0, |it| it.1)
    })
}
