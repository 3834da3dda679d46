//! `plimsoll compare`: histories of several runs, and of reference tables, over each other.

use crate::checks::interpolate;
use crate::record::{Column, Error, Recipe, Series, write_whole};
use crate::report::html::{self, Failure};
use crate::report::{Chart, Curve, MOST_MARKERS, Short};
use maud::{Markup, html};
use std::path::{Path, PathBuf};

/// What to compare.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct CompareArguments {
    /// Folders of runs, or tables as CSV with times first and `name [unit]` in the header; at least two.
    #[arg(required = true, num_args = 2.., value_name = "RUN-OR-CSV")]
    pub runs: Vec<PathBuf>,
    /// Variables to show, by the names in the tables, with commas between them; missing, all that two of them share.
    #[arg(long, value_delimiter = ',')]
    pub variables: Vec<String>,
    /// The page.
    #[arg(long, default_value = "compare.html")]
    pub out: PathBuf,
}

/// A table and how it is called.
struct Source {
    label: String,
    series: Series,
    /// What a run was made of; none of a table.
    recipe: Option<Recipe>,
}

/// Writes the page; gives its path.
///
/// # Errors
/// A table that cannot be read, a variable that no two tables share, or a page that cannot be written.
pub fn compare(arguments: &CompareArguments) -> Result<PathBuf, Failure> {
    let sources = arguments.runs.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
    let names = if arguments.variables.is_empty() { shared(&sources) } else { arguments.variables.clone() };
    if let Some(name) = names.iter().find(|name| columns(&sources, name).count() < 2) {
        return Err(format!("variable '{name}': expected in at least two tables; {}", offer(&sources)).into());
    }
    if names.is_empty() {
        return Err(format!("the tables have no variable in common; {}", offer(&sources)).into());
    }
    let charts: Vec<Chart> =
        names.iter().filter(|name| varies(&sources, name)).map(|name| chart(&sources, name)).collect();
    let body = html! {
        (made_of(&sources))
        p { "Differences are those from " b { (sources[0].label) } ", at its times within the other's." }
        (differences(&sources, &names))
        @for (index, chart) in charts.iter().enumerate() { (html::interactive(chart, &format!("chart-{index}"))) }
    };
    let text = html::interactive_page("Comparison", &body);
    write_whole(&arguments.out, text)?;
    Ok(arguments.out.clone())
}

fn read(path: &Path) -> Result<Source, Error> {
    let folder = path.is_dir();
    let table = if folder { path.join("results.csv") } else { path.to_path_buf() };
    let name = if folder { path.file_name() } else { path.file_stem() };
    let label = name.map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    let recipe = if folder { Recipe::read(path)? } else { None };
    Ok(Source { label, series: Series::read(&table)?, recipe })
}

/// What each run is and which values were changed.
fn made_of(sources: &[Source]) -> Markup {
    let row = |source: &Source| {
        let recipe = source.recipe.as_ref()?;
        let changes = if recipe.set.is_empty() { "none".to_string() } else { recipe.set.join("; ") };
        Some(vec![source.label.clone(), recipe.name.clone(), changes, recipe.version.clone(), recipe.date.clone()])
    };
    let rows: Vec<Vec<String>> = sources.iter().filter_map(row).collect();
    html! { @if !rows.is_empty() { (html::table(&["run", "scene", "changed values", "version", "date"], &rows)) } }
}

fn columns<'a>(sources: &'a [Source], name: &str) -> impl Iterator<Item = (&'a Source, &'a Column)> {
    sources.iter().filter_map(move |source| Some((source, source.series.column(name)?)))
}

/// Names in at least two tables, in the order of their first appearance.
fn shared(sources: &[Source]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for column in sources.iter().flat_map(|source| &source.series.columns) {
        if columns(sources, &column.name).count() > 1 && !names.contains(&column.name) {
            names.push(column.name.clone());
        }
    }
    names
}

fn offer(sources: &[Source]) -> String {
    let known = |source: &Source| {
        let names: Vec<&str> = source.series.columns.iter().map(|column| column.name.as_str()).collect();
        format!("{} has {}", source.label, names.join(", "))
    };
    sources.iter().map(known).collect::<Vec<_>>().join("; ")
}

fn varies(sources: &[Source], name: &str) -> bool {
    let mut values = columns(sources, name).flat_map(|(_, column)| &column.values);
    let first = values.next();
    values.any(|value| Some(value) != first)
}

fn chart(sources: &[Source], name: &str) -> Chart {
    let curve = |(source, column): (&Source, &Column)| Curve {
        label: source.label.clone(),
        points: source.series.points(column).collect(),
        markers: source.series.times.len() <= MOST_MARKERS,
    };
    let unit = columns(sources, name).next().map_or("", |(_, column)| column.unit.as_str());
    Chart {
        title: name.to_string(),
        x: "time [s]".to_string(),
        y: format!("[{unit}]"),
        curves: columns(sources, name).map(curve).collect(),
        band: None,
    }
}

/// Largest and root-mean-square difference of every table from the first one.
fn differences(sources: &[Source], names: &[String]) -> Markup {
    let mut rows = Vec::new();
    for name in names.iter().filter(|name| varies(sources, name)) {
        let mut all = columns(sources, name);
        let Some((first, reference)) = all.next() else { continue };
        for (source, column) in all {
            let points: Vec<(f64, f64)> = source.series.points(column).collect();
            let other = |time: f64| interpolate(&points, time);
            let pairs = first.series.points(reference).filter_map(|(time, value)| Some(other(time)? - value));
            let differences: Vec<f64> = pairs.collect();
            let count = differences.len().max(1) as f64;
            let square = differences.iter().map(|it| it * it).sum::<f64>();
            let largest = differences.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
            let unit = reference.unit.clone();
            let numbers = [Short(largest).to_string(), Short((square / count).sqrt()).to_string()];
            rows.push([name.clone(), source.label.clone()].into_iter().chain(numbers).chain([unit]).collect());
        }
    }
    html::table(&["variable", "table", "largest difference", "root mean square", "unit"], &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_tables_become_a_page_with_their_differences() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let one = write("one.csv", "time [s],a.x [m],a.y [m]\n0,0,1\n1,10,1\n2,20,1\n");
        let two = write("two.csv", "time [s],a.x [m],b.z [m]\n0,0,1\n2,26,1\n");
        let out = folder.path().join("page.html");
        let mut arguments = CompareArguments { runs: vec![one, two], variables: Vec::new(), out: out.clone() };
        compare(&arguments).unwrap();
        let page = std::fs::read_to_string(&out).unwrap();
        assert!(page.contains("chart-0") && !page.contains("chart-1") && page.contains("<td>6.000</td>"));
        arguments.variables = vec!["a.y".to_string()];
        let text = compare(&arguments).unwrap_err().to_string();
        assert!(text.contains("'a.y'") && text.contains("two has a.x, b.z"), "{text}");
    }
}
