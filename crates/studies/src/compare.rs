//! `plimsoll compare`: histories of several runs, and of reference tables, over each other; figures of two ensembles.

use crate::ensemble::{Ensemble, differences as differences_of_ensembles};
use maud::{Markup, html};
use report::checks::interpolate;
use report::html::{self, Failure};
use report::record::{Column, Error, Recipe, Series, write_whole};
use report::{Chart, Curve, MOST_MARKERS, Short};
use std::path::{Path, PathBuf};

/// What to compare.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct CompareArguments {
    /// Folders of runs, or tables as CSV with times first and `name [unit]` in the header, at least two; or the folders of two
    /// ensembles.
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
    if let Some(page) = of_ensembles(arguments)? {
        return Ok(page);
    }
    let sources = arguments.runs.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
    let names = if arguments.variables.is_empty() { shared(&sources) } else { arguments.variables.clone() };
    if let Some(name) = names.iter().find(|name| columns(&sources, name).count() < 2) {
        return Err(format!("variable '{name}': expected in at least two tables; {}", offer(&sources)).into());
    }
    if names.is_empty() {
        return Err(format!("the tables have no variable in common; {}", offer(&sources)).into());
    }
    names.iter().try_for_each(|name| same_unit(&sources, name))?;
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

/// The page of two ensembles; none where the folders are those of runs.
fn of_ensembles(arguments: &CompareArguments) -> Result<Option<PathBuf>, Failure> {
    let all = arguments.runs.iter().map(|folder| Ensemble::read(folder)).collect::<Result<Vec<_>, _>>()?;
    let found: Vec<&Ensemble> = all.iter().flatten().collect();
    let (one, other) = match (found.as_slice(), all.len()) {
        ([], _) => return Ok(None),
        ([one, other], 2) => (*one, *other),
        _ => return Err("an ensemble is compared with one other ensemble: expected the folders of two".into()),
    };
    let labels = [0, 1].map(|index| label(&arguments.runs[index]));
    let [first, second] = &labels;
    let runs = |ensemble: &Ensemble| ensemble.members.iter().filter(|member| member.error.is_none()).count();
    let body = html! {
        p { (first) ": " (runs(one)) " runs of " (one.scene) ". " (second) ": " (runs(other)) " runs of " (other.scene) "." }
        (differences_of_ensembles([first, second], [one, other]))
    };
    write_whole(&arguments.out, html::page("Comparison of two ensembles", &body))?;
    Ok(Some(arguments.out.clone()))
}

/// What a folder or table is called.
fn label(path: &Path) -> String {
    let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
    name.map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn read(path: &Path) -> Result<Source, Error> {
    let folder = path.is_dir();
    let table = if folder { path.join("results.csv") } else { path.to_path_buf() };
    let label = label(path);
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

/// Refuses a variable that two tables have in different units.
fn same_unit(sources: &[Source], name: &str) -> Result<(), Failure> {
    let mut all = columns(sources, name);
    let Some((first, reference)) = all.next() else { return Ok(()) };
    match all.find(|(_, column)| column.unit != reference.unit) {
        None => Ok(()),
        Some((other, column)) => Err(format!(
            "variable '{name}': [{}] in {}, but [{}] in {}: expected one unit; convert one of the tables, or leave the \
             variable out with --variables",
            reference.unit, first.label, column.unit, other.label
        )
        .into()),
    }
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
            let numbers = measures(&pairs.collect::<Vec<f64>>());
            let unit = reference.unit.clone();
            rows.push([name.clone(), source.label.clone()].into_iter().chain(numbers).chain([unit]).collect());
        }
    }
    html::table(&["variable", "table", "largest difference", "root mean square", "unit"], &rows)
}

/// Largest and root-mean-square size of some differences, in words; there are none where the times do not overlap.
fn measures(differences: &[f64]) -> [String; 2] {
    if differences.is_empty() {
        return ["no time in common", "-"].map(str::to_string);
    }
    let square = differences.iter().map(|it| it * it).sum::<f64>();
    let largest = differences.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
    [largest, (square / differences.len() as f64).sqrt()].map(|number| Short(number).to_string())
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

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let pair = |one: &str, two: &str, variables: &[&str]| {
            let runs = [("one", one), ("two", two)].map(|(name, text)| {
                let path = folder.path().join(format!("{name}.csv"));
                std::fs::write(&path, text).unwrap();
                path
            });
            let variables = variables.iter().map(ToString::to_string).collect();
            let arguments = CompareArguments { runs: runs.to_vec(), variables, out: folder.path().join("page.html") };
            compare(&arguments).map(|path| std::fs::read_to_string(path).unwrap()).map_err(|error| error.to_string())
        };
        let metres = "time [s],a.x [m],a.y [m]\n0,0,1\n1,10,2\n";
        let millimetres = "time [s],a.x [mm],a.y [m]\n0,0,1\n1,10000,2\n";
        let text = pair(metres, millimetres, &[]).unwrap_err();
        assert!(text.contains("'a.x': [m] in one, but [mm] in two"), "{text}");
        assert!(pair(metres, millimetres, &["a.y"]).is_ok(), "the other variable has one unit");
        let text = pair(metres, "time [s],a.x [m]\n1,10\n0,0\n", &[]).unwrap_err();
        assert!(text.contains("two.csv: row 2: time 0 s after 1 s"), "{text}");
        let text = pair(metres, "time [ms],a.x [m]\n0,0\n1000,10\n", &[]).unwrap_err();
        assert!(text.contains("two.csv: `time [ms]`: expected times in [s]"), "{text}");
        // Times without overlap have no difference, which is not a difference of 0.
        let page = pair(metres, "time [s],a.x [m]\n5,3\n6,4\n", &[]).unwrap();
        assert!(page.contains("<td>no time in common</td>"));
    }
}
