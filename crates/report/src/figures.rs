//! Which pictures a run gets: families of recorded variables, references of checks, iterations, and the field.

use super::chart::{Band, Chart, Curve};
use super::field::{FieldFigure, Quantity};
use super::{Error, Fields, movie};
use crate::checks::{self, Reference};
use crate::record::{Column, Series};
use scene::Check;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const TIME: &str = "time [s]";
/// File of the animation.
pub(super) const MOVIE: &str = "movie.png";
/// Files of the field at some moments and at the end.
const FIELD: &str = "field";
const LAST: &str = "field-last";
/// Moments shown side by side.
const MOMENTS: usize = 4;
/// Most points of a reference that are drawn one by one; more are drawn as a line.
pub const MOST_MARKERS: usize = 60;
/// Variables, by how their names go on after the participant, that a run without a choice of its own plots only when a
/// check asks for them: book-keeping, and figures of special scenes.
const ASIDE: [&str; 10] = [
    "particles.",
    "solver.",
    "time_step.",
    "momentum.",
    "extent.",
    "farthest",
    "angular_momentum",
    "area",
    "impulse.",
    "work.",
];

/// What was drawn of a run.
#[derive(Debug, Default)]
pub struct Pictures {
    /// Charts by the names of their files.
    pub charts: Vec<(String, Chart)>,
    /// Files of charts, fields and the animation.
    pub files: Vec<PathBuf>,
    /// What could not be drawn.
    pub failures: Vec<Error>,
}

/// What is wanted on charts.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Figures that the scene asks for.
    pub check: &'a [Check],
    /// Variables to plot, by name; empty for a default choice.
    pub plot: &'a [String],
    /// Labels of variables by their names.
    pub labels: &'a BTreeMap<String, String>,
    /// Time at the end of each accepted step \[s\], and its passes.
    pub passes: &'a [(f64, f64)],
}

/// The charts of a run, by the names of their files: reference files of checks are looked for in `references`.
pub fn charts(wanted: &Wanted, series: &Series, references: &Path) -> Vec<(String, Chart)> {
    let mut charts: Vec<(String, Chart)> = Vec::new();
    charts.extend(wanted.check.iter().filter_map(|check| against_reference(check, series, references)));
    charts.extend(families(wanted, series));
    if wanted.passes.iter().any(|(_, passes)| *passes > 1.0) {
        charts.push(("iterations".to_string(), iterations(wanted.passes)));
    }
    charts
}

/// Names, without extension, of all files that [`draw_all`] may write into `plots`.
pub fn stems(charts: &[(String, Chart)]) -> Vec<String> {
    let fields = [FIELD, LAST, MOVIE.trim_end_matches(".png")];
    fields.iter().copied().chain(charts.iter().map(|(name, _)| name.as_str())).map(str::to_string).collect()
}

/// Draws all pictures into `folder/plots`. Frames are looked for in `folder/frames`. A picture that cannot be drawn does not
/// keep the others from being drawn.
pub fn draw_all(charts: Vec<(String, Chart)>, folder: &Path) -> Pictures {
    super::prepare_font();
    let plots = folder.join("plots");
    if let Err(error) = std::fs::create_dir_all(&plots) {
        return Pictures { failures: vec![Error::unwritten(&plots, &error)], ..Pictures::default() };
    }
    let mut drawn: Vec<Result<PathBuf, Error>> = pictures(&folder.join("frames"), &plots);
    drawn.extend(charts.iter().map(|(name, chart)| chart.draw(&plots.join(name))));
    let (good, bad): (Vec<_>, Vec<_>) = drawn.into_iter().partition(Result::is_ok);
    Pictures {
        charts,
        files: good.into_iter().flatten().collect(),
        failures: bad.into_iter().filter_map(Result::err).collect(),
    }
}

/// Name of a file: letters, digits and dashes.
fn slug(text: &str) -> String {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_lowercase()
}

fn against_reference(check: &Check, series: &Series, folder: &Path) -> Option<(String, Chart)> {
    let reference = checks::reference(check, folder).ok()??;
    let whole = Check { from: None, to: None, ..check.clone() };
    let computed = checks::points(&whole, series).ok()?;
    let scaled = computed.iter().map(|(time, value)| (time * check.time_scale, *value)).collect();
    let mut curves = vec![Curve { label: "computed".to_string(), points: scaled, markers: false }];
    let label = if check.source.is_empty() { "reference" } else { check.source.split(',').next().unwrap_or("") };
    let mut band = None;
    match reference {
        Reference::Curve(points) => {
            let markers = points.len() <= MOST_MARKERS;
            curves.push(Curve { label: label.to_string(), points, markers });
        }
        Reference::Band(rows) => {
            let points = rows.iter().map(|row| (row[0], row[2], row[3])).collect();
            band = Some(Band { label: "smallest to largest published".to_string(), points });
            let mean = rows.iter().map(|row| (row[0], row[1])).collect();
            curves.push(Curve { label: "mean of published".to_string(), points: mean, markers: false });
        }
    }
    let x = if check.time_scale == 1.0 { TIME.to_string() } else { format!("time, times {}", check.time_scale) };
    let unit = match series.column(&check.variable) {
        Some(column) if check.relative && check.scale == 1.0 => &column.unit,
        _ if check.relative => "1",
        _ => &check.unit,
    };
    let y = format!("{} [{unit}]", expression(check));
    Some((format!("check-{}", slug(&check.name)), Chart { title: check.name.clone(), x, y, curves, band }))
}

/// What a check makes of its variable, in words.
fn expression(check: &Check) -> String {
    let name = &check.variable;
    let moved = match check.offset {
        0.0 => name.clone(),
        offset if offset < 0.0 => format!("{name} - {}", -offset),
        offset => format!("{name} + {offset}"),
    };
    match check.scale {
        1.0 => moved,
        scale if check.offset == 0.0 => format!("{moved} times {scale}"),
        scale => format!("({moved}) times {scale}"),
    }
}

/// Whether a variable is plotted when the case makes no choice.
fn is_plain(column: &Column, checks: &[Check]) -> bool {
    let varies = column.values.windows(2).any(|pair| pair[0] != pair[1]);
    let name = column.name.split_once('.').map_or(column.name.as_str(), |(_, name)| name);
    let aside = ASIDE.iter().any(|prefix| name.starts_with(prefix));
    varies && (!aside || checks.iter().any(|check| check.variable == column.name))
}

/// Variables of one participant whose names differ in the last part only, with one unit, share a picture.
fn families(wanted: &Wanted, series: &Series) -> Vec<(String, Chart)> {
    let chosen = |column: &&Column| {
        let chosen = wanted.plot;
        if chosen.is_empty() { is_plain(column, wanted.check) } else { chosen.contains(&column.name) }
    };
    let mut families: Vec<(String, Vec<&Column>)> = Vec::new();
    for column in series.columns.iter().filter(chosen) {
        let key = family(column);
        match families.iter_mut().find(|(known, _)| *known == key) {
            Some((_, members)) => members.push(column),
            None => families.push((key, vec![column])),
        }
    }
    let chart = |(key, members): (String, Vec<&Column>)| {
        let label = |column: &Column| wanted.labels.get(&column.name).cloned().unwrap_or_else(|| column.name.clone());
        // Beside the potential energy nothing else could be seen: energies are drawn from their start.
        let from_start = stem(&members[0].name).ends_with(".energy");
        let curve = |column: &&Column| {
            let start = column.values.first().copied().filter(|_| from_start).unwrap_or(0.0);
            let points = series.points(column).map(|(time, value)| (time, value - start)).collect();
            Curve { label: label(column), points, markers: false }
        };
        let title = if members.len() == 1 { label(members[0]) } else { title(members[0]) };
        let title = if from_start { format!("{title}, change since the start") } else { title };
        let unit = if members[0].unit.is_empty() { "1" } else { &members[0].unit };
        let curves = members.iter().map(curve).collect();
        (slug(&key), Chart { title, x: TIME.to_string(), y: format!("[{unit}]"), curves, band: None })
    };
    families.sort_by_key(|(_, members)| rank(&members[0].name));
    let mut charts: Vec<(String, Chart)> = families.into_iter().map(chart).collect();
    // Names that differ in the case of their letters only are one name of a file.
    for index in 1..charts.len() {
        let (before, rest) = charts.split_at_mut(index);
        let number = before.iter().filter(|(stem, _)| stem.split('~').next() == Some(rest[0].0.as_str())).count();
        if number > 0 {
            rest[0].0 += &format!("~{}", number + 1);
        }
    }
    charts
}

/// Place of a variable's chart: what is looked for first stands first, modal coordinates last.
fn rank(name: &str) -> usize {
    const FIRST: [&str; 7] = [".deflection", ".probe.", ".region.", ".gauge.", ".chamber.", ".vent.", ".motion."];
    if [".motion.q", ".motion.vq", ".motion.aq"].iter().any(|mode| name.contains(mode)) {
        return FIRST.len() + 1;
    }
    FIRST.iter().position(|part| name.contains(part)).unwrap_or(FIRST.len())
}

fn title(column: &Column) -> String {
    stem(&column.name).replace('.', " ")
}

/// What variables share that differ in their last part, or in the place where they are read.
fn stem(name: &str) -> String {
    let parts: Vec<&str> = name.split('.').collect();
    match parts.as_slice() {
        [participant, kind @ ("probe" | "region" | "gauge" | "chamber" | "vent"), _, quantity] => {
            format!("{participant}.{kind}.{quantity}")
        }
        [all @ .., _] => all.join("."),
        [] => String::new(),
    }
}

fn family(column: &Column) -> String {
    let stem = stem(&column.name);
    // A variable directly below its participant has a picture of its own.
    let stem = if stem.contains('.') { stem.as_str() } else { &column.name };
    format!("{stem} {}", column.unit)
}

fn iterations(passes: &[(f64, f64)]) -> Chart {
    let curve = Curve { label: "iterations".to_string(), points: passes.to_vec(), markers: false };
    Chart {
        title: "coupling iterations per step".to_string(),
        x: TIME.to_string(),
        y: "iterations [1]".to_string(),
        curves: vec![curve],
        band: None,
    }
}

/// Some moments side by side, the last one large, and all of them in motion.
fn pictures(folder: &Path, plots: &Path) -> Vec<Result<PathBuf, Error>> {
    let fields = match Fields::open(folder) {
        Ok(fields) => fields,
        Err(reason) => return vec![Err(Error::new(folder, reason))],
    };
    let times = fields.times();
    let Some(last) = times.last() else { return Vec::new() };
    let draw = |times: &[f64], columns: usize, name: &str| {
        let panels = times.iter().map(|&time| fields.panel(time, Quantity::Pressure)).collect::<Result<Vec<_>, _>>();
        let panels = panels.map_err(|reason| Error::new(folder, reason))?;
        FieldFigure { panels, columns, ..FieldFigure::default() }.draw(&plots.join(name))
    };
    let mut all = vec![draw(&moments(&times), 2, FIELD), draw(&[*last], 1, LAST)];
    all.extend(movie(&fields, None, &plots.join(MOVIE)).transpose());
    all
}

/// Some times at equal distances, the last one among them; the first one is the start, which everybody knows.
fn moments(times: &[f64]) -> Vec<f64> {
    let count = MOMENTS.min(times.len());
    (1..=count).map(|i| times[(times.len() * i / count) - 1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_share_a_picture() {
        let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into(), values: vec![] };
        assert_eq!(family(&column("fluid.probe.P2.pressure", "Pa")), "fluid.probe.pressure Pa");
        assert_eq!(family(&column("structure.body.cabin.motion.x", "m")), "structure.body.cabin.motion m");
        assert_eq!(family(&column("fluid.energy.kinetic", "J/m")), "fluid.energy J/m");
        assert_eq!(family(&column("fluid.maximum_speed", "m/s")), "fluid.maximum_speed m/s");
        assert_eq!(slug("fluid.probe.pressure Pa"), "fluid-probe-pressure-pa");
    }

    #[test]
    fn book_keeping_is_plotted_only_when_a_check_asks_for_it() {
        let column = |name: &str| Column { name: name.into(), unit: String::new(), values: vec![1.0, 2.0] };
        let check: Check =
            toml::from_str("name = 'c'\nkind = 'series_mean'\nvariable = 'fluid.extent.top'\noffset = -0.5").unwrap();
        assert_eq!(expression(&check), "fluid.extent.top - 0.5");
        assert_eq!(expression(&Check { scale: 2.0, ..check.clone() }), "(fluid.extent.top - 0.5) times 2");
        let plain = |name: &str| is_plain(&column(name), std::slice::from_ref(&check));
        assert!(plain("fluid.gauge.g.level") && plain("fluid.energy.total") && plain("structure.body.cabin.motion.x"));
        assert!(plain("fluid.extent.top") && !plain("fluid.extent.left") && !plain("fluid.solver.iterations"));
        let constant = Column { values: vec![1.0, 1.0], ..column("fluid.gauge.g.level") };
        assert!(!is_plain(&constant, &[]));
    }

    #[test]
    fn moments_end_with_the_last() {
        let times: Vec<f64> = (0..11).map(f64::from).collect();
        assert_eq!(moments(&times), [1.0, 4.0, 7.0, 10.0]);
        assert_eq!(moments(&times[..2]).len(), 2);
    }
}
