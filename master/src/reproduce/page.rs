//! The report of the cabins: one HTML file with its pictures in it.

use super::Model;
use super::cabin::{self, PERIOD, TABLE};
use crate::record::Error;
use crate::report::{Chart, Curve};
use std::path::{Path, PathBuf};

/// Histories: the paper's figure, title, variable, axis, factor.
const HISTORIES: [(&str, &str, &str, &str, f64); 7] = [
    ("6", "Deflection of the bulkhead's middle", "structure.deflection.middle", "deflection [mm]", 1e3),
    ("7", "Water in the flooded compartment", "fluid.region.mass[1]", "mass [kg/m]", 1.0),
    ("8", "Roll, to the damaged side", "structure.motion.theta", "roll [rad]", 1.0),
    ("", "Heave", "structure.motion.y", "heave [m]", 1.0),
    ("", "Sway", "structure.motion.x", "sway [m]", 1.0),
    ("12", "Pressure at P1", "fluid.probe.pressure[1]", "pressure [kPa]", 1e-3),
    ("12", "Pressure at P2", "fluid.probe.pressure[2]", "pressure [kPa]", 1e-3),
];
/// What differs from the paper and why.
const ASSUMPTIONS: [&str; 6] = [
    "The paper does not give the walls, the places of opening, bulkhead and probes, the centre of gravity, the moment of inertia and the \
     tank; the scene file says what was put in their place, and every such number is ours.",
    "The printed frequencies (508.4, 1401.5, 2747.5 rad/s) are those of one beam and cannot hold for all four moduli: they hold here for \
     model I, and rise with the square root of the modulus.",
    "The printed thickness of 0.04 mm fits no bulkhead of this cabin; 17.96 mm gives the printed frequencies.",
    "The compartments are open to the air: the paper's fluid has no air either.",
    "The paper's averages in table 2 exceed the static head at the keel; absolute values deserve care.",
    "The bulkhead is a linear Euler-Bernoulli beam, and its faces are where the pressure is read; stations move with the rigid cabin.",
];

/// Writes charts and the page; gives the path of the page.
pub fn write(models: &[Model], spacing: f64, folder: &Path) -> Result<PathBuf, Box<dyn std::error::Error>> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|error| Error::new(&plots, error))?;
    let mut text = head(spacing);
    text += &runs(models);
    text += &table(models);
    text += &trends(models);
    text += "<h2>Histories</h2>\n";
    for (index, (figure, title, variable, axis, factor)) in HISTORIES.iter().enumerate() {
        let curve = |model: &Model| {
            let column = model.series.column(variable)?;
            let points = model.series.points(column).map(|(time, value)| (time, factor * value)).collect();
            Some(Curve { label: format!("model {}", model.name), points, markers: false })
        };
        let source = if figure.is_empty() { String::new() } else { format!(" (the paper's figure {figure})") };
        let chart = Chart {
            title: format!("{title}{source}"),
            x: "time [s]".to_string(),
            y: axis.to_string(),
            curves: models.iter().filter_map(curve).collect(),
            band: None,
        };
        text += &picture(&chart, &plots.join(format!("history-{index}")))?;
    }
    text += "<h2>Along the bulkhead</h2>\n";
    for (name, peak) in [("Average pressure (the paper's figure 9)", false), ("Peak pressure (figure 10)", true)] {
        text += &picture(&profile(models, name, peak), &plots.join(format!("bulkhead-{peak}")))?;
    }
    text += "<h2>Assumptions and differences</h2>\n<ul>\n";
    ASSUMPTIONS.iter().for_each(|line| text += &format!("<li>{line}</li>\n"));
    text += "</ul>\n</body>\n</html>\n";
    let page = folder.join("report.html");
    std::fs::write(&page, text).map_err(|error| Error::new(&page, error))?;
    Ok(page)
}

fn head(spacing: f64) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>The damaged cabin</title>\n<style>\nbody {{ \
         font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }}\ntable {{ border-collapse: collapse }}\ntd, \
         th {{ border: 1px solid #bbb; padding: 0.2em 0.6em; text-align: right }}\nsvg {{ max-width: 100%; height: auto \
         }}\n</style>\n</head>\n<body>\n<h1>The damaged cabin, models I to IV</h1>\n<p>Particle spacing {} mm, plimsoll {}. Peaks \
         and averages are taken up to {PERIOD} s.</p>\n",
        1e3 * spacing,
        env!("CARGO_PKG_VERSION")
    )
}

fn runs(models: &[Model]) -> String {
    let mut text = "<h2>Runs</h2>\n<table>\n<tr><th>model</th><th>E [GPa]</th><th>status</th><th>simulated [s]</th><th>wall-clock \
                    time [s]</th><th>particles</th><th>passes per step</th></tr>\n"
        .to_string();
    for model in models {
        let summary = &model.summary;
        let modulus = if model.youngs_modulus.is_finite() {
            format!("{:.1}", 1e-9 * model.youngs_modulus)
        } else {
            "rigid".into()
        };
        text += &format!(
            "<tr><td>{}</td><td>{modulus}</td><td>{:?}</td><td>{:.3}</td><td>{:.0}</td><td>{:.0}</td><td>{:.2}</td></tr>\n",
            model.name,
            summary.status,
            summary.simulated_seconds,
            summary.wall_seconds,
            summary.particles.unwrap_or(f64::NAN),
            summary.coupling.mean_iterations
        );
    }
    text + "</table>\n"
}

fn table(models: &[Model]) -> String {
    let mut text =
        "<h2>Table 2: pressures at P1 and P2 [kPa], ours (the paper's)</h2>\n<table>\n<tr><th>model</th><th>peak \
                    P1</th><th>average P1</th><th>peak P2</th><th>average P2</th></tr>\n"
            .to_string();
    for (model, paper) in models.iter().zip(TABLE) {
        text += &format!("<tr><td>{}</td>", model.name);
        for (own, other) in cabin::table_row(model).into_iter().zip(paper) {
            let own = own.map_or_else(|| "-".to_string(), |value| format!("{value:.2}"));
            text += &format!("<td>{own} ({other:.2})</td>");
        }
        text += "</tr>\n";
    }
    text + "</table>\n"
}

fn trends(models: &[Model]) -> String {
    let mut text =
        "<h2>The paper's trends</h2>\n<table>\n<tr><th>trend</th><th>found</th><th>ours, models I to IV</th></tr>\n"
            .to_string();
    for trend in cabin::trends(models) {
        let found = match trend.found {
            Some(true) => "yes",
            Some(false) => "no",
            None => "-",
        };
        text += &format!("<tr><td>{}</td><td>{found}</td><td>{}</td></tr>\n", trend.claim, trend.numbers);
    }
    text + "</table>\n"
}

fn profile(models: &[Model], title: &str, peak: bool) -> Chart {
    let curve = |model: &Model, flooded: bool| {
        let points = cabin::along_bulkhead(model, flooded);
        let points = points.into_iter().map(|(height, most, mean)| (height, if peak { most } else { mean })).collect();
        let face = if flooded { "flooded face" } else { "other face" };
        Curve { label: format!("model {}, {face}", model.name), points, markers: false }
    };
    Chart {
        title: title.to_string(),
        x: "height above the inner bottom, over the bulkhead's [1]".to_string(),
        y: "pressure [kPa]".to_string(),
        curves: models.iter().map(|model| curve(model, true)).collect(),
        band: None,
    }
}

/// Draws a chart; gives its drawing for the page.
fn picture(chart: &Chart, stem: &Path) -> Result<String, Box<dyn std::error::Error>> {
    chart.draw(stem)?;
    let path = stem.with_extension("svg");
    let drawing = std::fs::read_to_string(&path).map_err(|error| Error::new(&path, error))?;
    Ok(format!("<p>{drawing}</p>\n"))
}
