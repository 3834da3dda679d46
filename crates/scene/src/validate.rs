//! The ranges of every value of a scene. Geometry that needs more than one part is checked where it is built.

use crate::gas::{carried, validate_gas};
use crate::validate_bodies::validate_bodies;
use crate::*;
use digits::six;
use keys::{ABOVE_ZERO, OutOfRange};
use std::collections::BTreeMap;

/// Particles that a scene may ask for; more is a slip in the spacing rather than a wish.
const MOST_PARTICLES: f64 = 1e7;
/// Communication steps of a run.
const MOST_STEPS: f64 = 1e9;
/// Letters of a name.
const LONGEST_NAME: usize = 60;
/// Points of one line probe.
const MOST_PROBE_POINTS: f64 = 1000.0;

pub(crate) struct Checker<'a> {
    pub(crate) name: &'a str,
}

impl Checker<'_> {
    pub(crate) fn fail(&self, key: &str, got: impl ToString, expected: &str) -> Result<(), Error> {
        Err(Error::Range {
            name: self.name.to_string(),
            key: key.to_string(),
            got: got.to_string(),
            expected: expected.to_string(),
        })
    }

    pub(crate) fn within(&self, key: &str, value: f64, low: f64, high: f64) -> Result<(), Error> {
        if value.is_finite() && (low..=high).contains(&value) {
            return Ok(());
        }
        match high {
            f64::MAX => self.fail(key, six(value), &format!("a finite number of at least {}", six(low))),
            _ => self.fail(key, six(value), &format!("a number from {} to {}", six(low), six(high))),
        }
    }

    /// What a struct of keys below `table` said of its numbers.
    pub(crate) fn keys(&self, table: &str, checked: Result<(), OutOfRange>) -> Result<(), Error> {
        checked.or_else(|out| {
            let key = if table.is_empty() { out.path() } else { format!("{table}.{}", out.path()) };
            match [out.key.low, out.key.high] {
                ABOVE_ZERO => self.positive(&key, out.got),
                [low, high] => self.within(&key, out.got, low, high),
            }
        })
    }

    pub(crate) fn positive(&self, key: &str, value: f64) -> Result<(), Error> {
        let [low, high] = ABOVE_ZERO;
        if (low..=high).contains(&value) {
            return Ok(());
        }
        self.fail(key, six(value), &format!("a number above 0, from {low:e} to {high:e}"))
    }

    /// An optional number, or one with a default.
    pub(crate) fn finite_if(&self, key: &str, value: impl Into<Option<f64>>) -> Result<(), Error> {
        match value.into().filter(|value| !value.is_finite()) {
            Some(value) => self.fail(key, value, "a finite number"),
            None => Ok(()),
        }
    }

    pub(crate) fn point(&self, key: &str, point: Point) -> Result<(), Error> {
        if point.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        self.fail(key, digits::list(&point), "finite coordinates")
    }

    pub(crate) fn points(&self, key: &str, points: &[Point], least: usize) -> Result<(), Error> {
        if points.len() < least {
            return self.fail(key, format!("{} points", points.len()), &format!("at least {least} points"));
        }
        points.iter().enumerate().try_for_each(|(i, point)| self.point(&format!("{key}[{i}]"), *point))
    }

    /// Refuses names that give no word for a variable, and two entries of a list with one such word.
    pub(crate) fn names<'a>(&self, list: &str, names: impl Iterator<Item = (usize, &'a str)>) -> Result<(), Error> {
        let mut known: BTreeMap<String, (usize, &str)> = BTreeMap::new();
        for (index, name) in names {
            let (key, got, word) = (format!("{list}[{index}].name"), format!("'{name}'"), identifier(name));
            if word.is_empty() {
                self.fail(&key, &got, "a name with a letter from a to z or a digit")?;
            }
            if word.len() > LONGEST_NAME {
                let expected =
                    format!("a name of at most {LONGEST_NAME} letters, since it is a part of names of files");
                self.fail(&key, format!("{} letters", word.len()), &expected)?;
            }
            if let Some((first, other)) = known.insert(word.clone(), (index, name)) {
                let expected = match other == name {
                    true => format!("a name that is used once; {list}[{first}] has it too"),
                    false => format!(
                        "a name with other letters and digits than '{other}' of {list}[{first}]: both are {word} as variables"
                    ),
                };
                return self.fail(&key, got, &expected);
            }
        }
        Ok(())
    }

    /// Refuses two entries of a list with one name.
    pub(crate) fn unique<'a>(&self, list: &str, names: impl Iterator<Item = (usize, &'a str)>) -> Result<(), Error> {
        let mut known = BTreeMap::new();
        for (index, name) in names {
            if let Some(first) = known.insert(name, index) {
                let expected = format!("a name that is used once; {list}[{first}] has it too");
                return self.fail(&format!("{list}[{index}].name"), format!("'{name}'"), &expected);
            }
        }
        Ok(())
    }
}

impl Scene {
    /// Checks every value against its range; `name` is used in messages.
    pub fn validate(&self, name: &str) -> Result<(), Error> {
        let check = Checker { name };
        self.run.validate(name, 0.0)?;
        check.keys("", self.check())?;
        self.output.validate(name)?;
        if self.fluid.is_none() && self.body.is_empty() {
            check.fail("fluid, body", "none", "at least one of [fluid] and [[body]]")?;
        }
        if let Some(fluid) = &self.fluid {
            validate_fluid(&check, fluid, &self.body)?;
        }
        validate_gas(&check, self)?;
        validate_bodies(&check, &self.body)?;
        check.keys("integrator", self.integrator.check())?;
        self.coupling.validate(name, self.run.communication_step)?;
        self.watch.validate(name)?;
        validate_checks(&self.check, name)
    }
}

impl Polygon {
    /// Area that it encloses \[m2\].
    pub fn area(&self) -> f64 {
        area(&self.polygon)
    }
}

impl Run {
    /// Checks end and step of a run that starts at `start` \[s\]; `name` is used in messages.
    pub fn validate(&self, name: &str, start: f64) -> Result<(), Error> {
        let check = Checker { name };
        if !(self.end.is_finite() && self.end > start) {
            check.fail("run.end", six(self.end), &format!("a finite number above the start, {} s", six(start)))?;
        }
        let duration = self.end - start;
        check.within("run.communication_step", self.communication_step, duration / MOST_STEPS, duration)
    }
}

impl Output {
    /// Checks the intervals; `name` is used in messages.
    pub fn validate(&self, name: &str) -> Result<(), Error> {
        Checker { name }.keys("output", self.check())
    }
}

impl Watch {
    /// Checks every number; `name` is used in messages.
    pub fn validate(&self, name: &str) -> Result<(), Error> {
        Checker { name }.keys("watch", self.check())
    }
}

impl Coupling {
    /// Checks every number, for a communication step of this length \[s\]; `name` is used in messages.
    pub fn validate(&self, name: &str, communication_step: f64) -> Result<(), Error> {
        let check = Checker { name };
        check.keys("coupling", self.check())?;
        if self.tolerance_relative == 0.0 && self.tolerance_absolute == 0.0 {
            check.fail("coupling.tolerance_relative, tolerance_absolute", "0, 0", "at least one above 0")?;
        }
        check.within("coupling.smallest_step", self.smallest_step, 0.0, communication_step)
    }
}

fn validate_fluid(check: &Checker, fluid: &Fluid, bodies: &[Body]) -> Result<(), Error> {
    check.keys("fluid", fluid.check())?;
    validate_forcing(check, fluid)?;
    check.keys("fluid.voronoi", fluid.voronoi.check())?;
    check.keys("fluid.mps", fluid.mps.check())?;
    check.keys("fluid.solve", fluid.solve.check())?;
    if fluid.water.is_empty() {
        check.fail("fluid.water", "empty", "at least one polygon of water")?;
    }
    for (i, water) in fluid.water.iter().enumerate() {
        check.points(&format!("fluid.water[{i}].polygon"), &water.polygon, 3)?;
    }
    validate_spacing(check, fluid)?;
    for (i, wall) in fluid.wall.iter().enumerate() {
        check.points(&format!("fluid.wall[{i}].points"), &wall.points, 2)?;
    }
    for (i, region) in fluid.region.iter().enumerate() {
        check.points(&format!("fluid.region[{i}].polygon"), &region.polygon, 3)?;
    }
    for (i, gauge) in fluid.gauge.iter().enumerate() {
        check.keys(&format!("fluid.gauge[{i}]"), gauge.check())?;
    }
    fluid.probe.iter().enumerate().try_for_each(|(i, probe)| validate_probe(check, i, probe))?;
    validate_instruments(check, fluid, bodies)
}

/// Names of what is read from the water, and the bodies that carry it.
fn validate_instruments(check: &Checker, fluid: &Fluid, bodies: &[Body]) -> Result<(), Error> {
    let labels: Vec<_> = fluid.probe.iter().map(Probe::labels).enumerate().collect();
    let labels = labels.iter().flat_map(|(i, labels)| labels.iter().map(|label| (*i, label.as_str())));
    check.names("fluid.probe", labels)?;
    check.names("fluid.gauge", fluid.gauge.iter().map(|gauge| gauge.name.as_str()).enumerate())?;
    check.names("fluid.region", fluid.region.iter().map(|region| region.name.as_str()).enumerate())?;
    let probes = fluid.probe.iter().map(|probe| &probe.on_body).enumerate().map(|(i, on)| ("probe", i, on));
    let regions = fluid.region.iter().map(|region| &region.on_body).enumerate().map(|(i, on)| ("region", i, on));
    for (list, index, carrier) in probes.chain(regions) {
        carried(check, &format!("fluid.{list}[{index}]"), carrier.as_ref(), bodies)?;
    }
    Ok(())
}

/// What moves the water besides gravity.
fn validate_forcing(check: &Checker, fluid: &Fluid) -> Result<(), Error> {
    check.keys("fluid.start", fluid.start.check())?;
    for (i, zone) in fluid.damping.iter().enumerate() {
        let table = format!("fluid.damping[{i}]");
        check.keys(&table, zone.check())?;
        if zone.from == zone.to {
            check.fail(&format!("{table}.to"), zone.to, "another X than `from`")?;
        }
    }
    check.keys("fluid.shaking", fluid.shaking.check())
}

/// Refuses a spacing that would fill the memory before anything could be said about it, and water without area.
fn validate_spacing(check: &Checker, fluid: &Fluid) -> Result<(), Error> {
    let mut around = 0.0;
    for (i, water) in fluid.water.iter().enumerate() {
        let [width, height] = extent(&water.polygon);
        let area = area(&water.polygon);
        if area <= 1e-9 * width.hypot(height).powi(2) {
            let expected = format!("a polygon that encloses an area; its corners span {width} x {height} m");
            check.fail(&format!("fluid.water[{i}].polygon"), format!("{area} m2"), &expected)?;
        }
        around += width * height;
    }
    let least = (around / MOST_PARTICLES).sqrt();
    if fluid.spacing >= least {
        return Ok(());
    }
    let expected = format!("at least {least} m: {MOST_PARTICLES:e} particles in {around} m2 around the water");
    check.fail("fluid.spacing", fluid.spacing, &expected)
}

/// Width and height of the box around a polygon \[m\].
pub(crate) fn extent(polygon: &[Point]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let values = polygon.iter().map(|point| point[axis]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    })
}

/// Area of a closed polygon of at least one corner \[m2\], from its first corner so that a far origin costs no digits.
fn area(polygon: &[Point]) -> f64 {
    let [x, y] = polygon.first().copied().unwrap_or_default();
    let triangle = |pair: &[Point]| (pair[0][0] - x) * (pair[1][1] - y) - (pair[0][1] - y) * (pair[1][0] - x);
    0.5 * polygon.windows(2).map(triangle).sum::<f64>().abs()
}

fn validate_probe(check: &Checker, index: usize, probe: &Probe) -> Result<(), Error> {
    let key = |field: &str| format!("fluid.probe[{index}].{field}");
    for (field, point) in [("point", probe.point), ("from", probe.from), ("to", probe.to)] {
        check.point(&key(field), point.unwrap_or_default())?;
    }
    check.within(&key("size"), probe.size, 0.0, 1e9)?;
    if let Some(threshold) = probe.threshold {
        check.within(&key("threshold"), threshold, -1e12, 1e12)?;
    }
    match (probe.point, probe.from, probe.to) {
        (None, Some(_), Some(_)) => check.within(&key("count"), probe.count as f64, 1.0, MOST_PROBE_POINTS),
        (Some(_), None, None) => check.within(&key("count"), probe.count as f64, 0.0, 1.0),
        _ => check.fail(
            &format!("fluid.probe[{index}]"),
            "no single place",
            "either `point`, or `from`, `to` and `count`",
        ),
    }
}
