//! Parts of a page that opens by itself: charts as vectors, pictures inside the text.

use crate::record::Error;
use crate::report::Chart;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
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
    std::fs::write(&path, text).map_err(|error| Error::new(&path, error))?;
    Ok(path)
}
