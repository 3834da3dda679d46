//! Parts of a page that opens by itself: charts as vectors, pictures inside the text.

use super::chart::COLOURS;
use super::{Band, Chart};
use crate::record::{Error, write_whole};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use plotly::common::{Fill, Line, Mode};
use plotly::layout::Axis;
use plotly::{Layout, Plot, Scatter};
use std::path::{Path, PathBuf};

/// What can go wrong on the way to a page.
pub type Failure = Box<dyn std::error::Error>;

const STYLE: &str = "body { font-family: sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em; line-height: 1.4 } \
                     table { border-collapse: collapse; margin: 1em 0 } td, th { border: 1px solid #bbb; padding: 0.2em 0.6em; \
                     text-align: right } td:first-child, th:first-child { text-align: left } svg, img { max-width: 100%; height: auto } \
                     figure { margin: 1em 0 } figcaption { color: #555; font-size: 0.9em }";

/// A whole page.
pub fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head { meta charset="utf-8"; title { (title) } style { (PreEscaped(STYLE)) } }
            body { h1 { (title) } (body) footer { p { "plimsoll " (env!("CARGO_PKG_VERSION")) } } }
        }
    };
    page.into_string()
}

/// A table.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> Markup {
    html! {
        table {
            tr { @for cell in head { th { (cell) } } }
            @for row in rows { tr { @for cell in row { td { (cell) } } } }
        }
    }
}

/// The same with the plotting library in it: several megabytes, and interactive charts without a network.
pub fn interactive_page(title: &str, body: &Markup) -> String {
    // What follows the first script typesets formulas, of which there are none.
    let sources = plotly::Plot::offline_js_sources();
    let library = sources.split_inclusive("</script>").next().unwrap_or_default();
    page(title, &html! { (PreEscaped(library)) (body) })
}

/// A chart to zoom into and read values from; nothing where it has no curve. `id` is unique within the page.
pub fn interactive(chart: &Chart, id: &str) -> Markup {
    if chart.curves.iter().all(|curve| curve.points.is_empty()) {
        return html! {};
    }
    let mut plot = Plot::new();
    if let Some(band) = &chart.band {
        add_band(&mut plot, band);
    }
    for (curve, colour) in chart.curves.iter().zip(COLOURS.iter().cycle()) {
        let (x, y): (Vec<f64>, Vec<f64>) = curve.points.iter().copied().unzip();
        let colour = format!("rgb({}, {}, {})", colour.0, colour.1, colour.2);
        let mode = if curve.markers { Mode::Markers } else { Mode::Lines };
        plot.add_trace(Scatter::new(x, y).mode(mode).name(&curve.label).line(Line::new().color(colour)));
    }
    let axis = |title: &str| Axis::new().title(title.to_string());
    plot.set_layout(Layout::new().title(chart.title.clone()).height(420).x_axis(axis(&chart.x)).y_axis(axis(&chart.y)));
    html! { figure { (PreEscaped(plot.to_inline_html(Some(id)))) } }
}

fn add_band(plot: &mut Plot, band: &Band) {
    let times: Vec<f64> = band.points.iter().map(|it| it.0).collect();
    let low = band.points.iter().map(|it| it.1).collect();
    let high = band.points.iter().map(|it| it.2).collect();
    let line = Line::new().color("#bbbbbb").width(0.0);
    plot.add_trace(Scatter::new(times.clone(), low).mode(Mode::Lines).line(line.clone()).show_legend(false));
    let upper = Scatter::new(times, high).mode(Mode::Lines).line(line).name(&band.label);
    plot.add_trace(upper.fill(Fill::ToNextY).fill_color("rgba(150, 150, 150, 0.4)"));
}

/// A chart as vectors; nothing where it has no curve.
pub fn chart(chart: &Chart) -> Result<Markup, Failure> {
    if chart.curves.iter().all(|curve| curve.points.is_empty()) {
        return Ok(html! {});
    }
    let svg = chart.svg()?;
    Ok(html! { figure { (PreEscaped(svg)) } })
}

/// A picture from a PNG file, animated or not.
pub fn picture(path: &Path, caption: &str) -> Result<Markup, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Error::new(path, error))?;
    let source = format!("data:image/png;base64,{}", STANDARD.encode(bytes));
    Ok(html! { figure { img src=(source) alt=(caption); figcaption { (caption) } } })
}

/// Writes a page as `folder/report.html`; gives its path.
pub fn write(folder: &Path, text: &str) -> Result<PathBuf, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Error::new(folder, error))?;
    let path = folder.join("report.html");
    write_whole(&path, text)?;
    Ok(path)
}
