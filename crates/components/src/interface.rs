//! Which variables the FMUs of a scene have, and what they are called. An input of one is an output of the other; names,
//! references and units are the same at both ends.
//!
//! The names are those of the scene: `body.cabin.motion.x`, `body.cabin.bulkhead.load.q1`, `probe.P1.pressure`. This is the
//! one place that makes them.

mod matching;
mod rows;

pub use matching::Matching;
pub use rows::{ANSWER, LOADS, MOTIONS, added_masses, family};

use crate::Error;
use fmi::{Failure, Reference};
use kinematics::{Coordinate, CoordinateLayout, Part};
use scene::{Scene, identifier};
use serde::{Deserialize, Serialize};

/// Reference of the position of the first coordinate; the others follow in the order of [`CoordinateLayout`].
pub const POSITION: Reference = 1_000_000;
/// Reference of the rate of the first coordinate.
pub const VELOCITY: Reference = 2_000_000;
/// Reference of the second derivative of the first coordinate.
pub const ACCELERATION: Reference = 3_000_000;
/// Reference of the load on the first coordinate.
pub const LOAD: Reference = 4_000_000;
/// Reference of the first of the accelerations that the load belongs to.
pub const LOAD_ACCELERATION: Reference = 5_000_000;
/// Reference of the first pressure.
pub const PROBE: Reference = 6_000_000;
/// References of the first largest pressure and of the first impulse.
pub const LARGEST: Reference = 6_300_000;
/// See [`LARGEST`].
pub const IMPULSE: Reference = 6_600_000;
/// Reference of the first mass of water in a region.
pub const REGION: Reference = 7_000_000;
/// Reference of the first water level.
pub const GAUGE: Reference = 8_000_000;
/// Reference of the pressure of the gas at the first chamber; its volume and mass follow, then those of the others.
pub const CHAMBER: Reference = 8_300_000;
/// Reference of the flow through the first vent.
pub const VENT: Reference = 8_600_000;
/// Reference of the deflection of the middle of the first member; that of its tip follows, then those of the others.
pub const DEFLECTION: Reference = 9_000_000;
/// Reference of Young's modulus of the first member.
pub const MODULUS: Reference = 10_000_000;
/// Reference of the first entry of the added mass; entries of a row follow, rows are [`ROW`] apart.
pub const ADDED_MASS: Reference = 100_000_000;
/// Distance between the references of two rows of the added mass.
pub const ROW: Reference = 10_000;

/// Resource of an FMU in which its interface stands; one without it has the interface of [`crate::DEFAULT_SCENE`].
pub const INTERFACE_FILE: &str = "interface.toml";

/// What of a scene decides the variables of its FMUs: words of its names, as [`identifier`] makes them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// Pressure probes, point by point.
    #[serde(default)]
    pub probes: Vec<String>,
    /// Those of them that give their largest pressure, too.
    #[serde(default)]
    pub largest: Vec<String>,
    /// Those of them that give an impulse beyond a threshold.
    #[serde(default)]
    pub impulses: Vec<String>,
    /// Regions.
    #[serde(default)]
    pub regions: Vec<String>,
    /// Level gauges.
    #[serde(default)]
    pub gauges: Vec<String>,
    /// Whether there is gas.
    #[serde(default)]
    pub gas: bool,
    /// Places where gas is read.
    #[serde(default)]
    pub chambers: Vec<String>,
    /// Vents.
    #[serde(default)]
    pub vents: Vec<String>,
    /// Bodies.
    #[serde(default)]
    pub bodies: Vec<BodyNames>,
}

/// A body of an interface.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyNames {
    /// Its word.
    pub name: String,
    /// Its members.
    #[serde(default)]
    pub members: Vec<MemberNames>,
}

/// A member of an interface.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemberNames {
    /// Its word.
    pub name: String,
    /// Number of its modes.
    pub modes: usize,
}

impl Interface {
    /// The interface of a validated scene.
    pub fn of(scene: &Scene) -> Self {
        let (fluid, gas) = (|| scene.fluid.iter(), || scene.gas.iter());
        let member = |member: &scene::Member| MemberNames { name: identifier(&member.name), modes: member.modes };
        let body = |body: &scene::Body| BodyNames {
            name: identifier(&body.name),
            members: body.member.iter().map(member).collect(),
        };
        let labels = |wanted: fn(&scene::Probe) -> bool| {
            let probes = fluid().flat_map(|fluid| &fluid.probe).filter(move |probe| wanted(probe));
            probes.flat_map(scene::Probe::labels).map(|label| identifier(&label)).collect()
        };
        Self {
            probes: labels(|_| true),
            largest: labels(|probe| probe.largest),
            impulses: labels(|probe| probe.threshold.is_some()),
            regions: fluid().flat_map(|fluid| &fluid.region).map(|region| identifier(&region.name)).collect(),
            gauges: fluid().flat_map(|fluid| &fluid.gauge).map(|gauge| identifier(&gauge.name)).collect(),
            gas: scene.gas.is_some(),
            chambers: gas().flat_map(|gas| &gas.chamber).map(|chamber| identifier(&chamber.name)).collect(),
            vents: gas().flat_map(|gas| &gas.vent).map(|vent| identifier(&vent.name)).collect(),
            bodies: scene.body.iter().map(body).collect(),
        }
    }

    /// The bodies alone: what a structure sees of a scene.
    #[must_use]
    pub fn of_bodies(&self) -> Self {
        Self { bodies: self.bodies.clone(), ..Self::default() }
    }

    /// The interface of the FMU with these resources, a folder.
    ///
    /// # Errors
    /// A file that cannot be read, or is not one of this program.
    pub fn of_resources(resources: Option<&std::path::Path>) -> Result<Self, Error> {
        let file = resources.map(|folder| folder.join(INTERFACE_FILE)).filter(|file| file.is_file());
        match file {
            Some(file) => {
                let interface: Self = scene::from_toml(&scene::read_text(&file)?, INTERFACE_FILE, &[])?;
                interface.check()?;
                Ok(interface)
            }
            None => Ok(Self::of(&crate::default_scene()?)),
        }
    }

    /// Refuses what no scene can have, before memory is taken for it.
    fn check(&self) -> Result<(), Error> {
        let most = scene::Member::RANGES.iter().find(|key| key.name == "modes").map_or(0.0, |key| key.high);
        let many = self.members().find(|(_, member)| member.modes as f64 > most);
        let (key, got, expected) = match many {
            Some((_, member)) => ("modes", member.modes, most),
            None if self.layout().size() > ROW as usize => ("coordinates", self.layout().size(), f64::from(ROW)),
            None => return Ok(()),
        };
        let expected = format!("at most {expected}: {INTERFACE_FILE} was changed");
        Err(Error::Value { key: key.to_string(), got: got.to_string(), expected })
    }

    /// The same as the text of [`INTERFACE_FILE`].
    pub fn to_text(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// Which coordinate is what.
    pub fn layout(&self) -> CoordinateLayout {
        let modes = |body: &BodyNames| body.members.iter().map(|member| member.modes).collect();
        CoordinateLayout::new(self.bodies.iter().map(modes).collect())
    }

    /// Members of all bodies, each with the name of its body.
    pub fn members(&self) -> impl Iterator<Item = (&BodyNames, &MemberNames)> {
        self.bodies.iter().flat_map(|body| body.members.iter().map(move |member| (body, member)))
    }

    /// Names of the motion of a coordinate: itself, its rate, its second derivative.
    pub fn motion(&self, coordinate: Coordinate) -> [String; 3] {
        let (owner, ending) = (self.owner(coordinate), ending(coordinate.part));
        ["", "v", "a"].map(|order| format!("{owner}.motion.{order}{ending}"))
    }

    /// Name of the load on a coordinate.
    pub fn load(&self, coordinate: Coordinate) -> String {
        let ending = match coordinate.part {
            Part::X => "fx".to_string(),
            Part::Y => "fy".to_string(),
            Part::Theta => "mz".to_string(),
            part @ Part::Mode { .. } => ending(part),
        };
        format!("{}.load.{ending}", self.owner(coordinate))
    }

    /// Name of the acceleration that the load on a coordinate belongs to.
    pub fn load_acceleration(&self, coordinate: Coordinate) -> String {
        format!("{}.load.a{}", self.owner(coordinate), ending(coordinate.part))
    }

    /// Name of the added mass between two coordinates.
    pub fn added_mass(&self, row: Coordinate, column: Coordinate) -> String {
        let word = |coordinate| {
            let owner = self.owner(coordinate);
            format!("{}.{}", owner.trim_start_matches("body."), ending(coordinate.part))
        };
        format!("added_mass.{}.{}", word(row), word(column))
    }

    /// Names of the deflections of a member: of its middle, of its end at +y.
    pub fn deflections(body: &BodyNames, member: &MemberNames) -> [String; 2] {
        ["middle", "tip"].map(|place| format!("body.{}.{}.deflection.{place}", body.name, member.name))
    }

    /// Name of the modulus of a member.
    pub fn youngs_modulus(body: &BodyNames, member: &MemberNames) -> String {
        format!("body.{}.{}.youngs_modulus", body.name, member.name)
    }

    /// Name of the mean pressure at a probe.
    pub fn pressure(probe: &str) -> String {
        format!("probe.{probe}.pressure")
    }

    /// Name of the largest pressure at a probe.
    pub fn largest(probe: &str) -> String {
        format!("probe.{probe}.largest")
    }

    /// Name of the impulse of the pressure beyond the threshold at a probe.
    pub fn impulse(probe: &str) -> String {
        format!("probe.{probe}.impulse")
    }

    /// Name of the mass of water in a region.
    pub fn mass(region: &str) -> String {
        format!("region.{region}.mass")
    }

    /// Name of the level at a gauge.
    pub fn level(gauge: &str) -> String {
        format!("gauge.{gauge}.level")
    }

    /// Names of what is read of the gas at a place: pressure, volume, mass.
    pub fn chamber(chamber: &str) -> [String; 3] {
        ["pressure", "volume", "mass"].map(|what| format!("chamber.{chamber}.{what}"))
    }

    /// Name of the flow through a vent.
    pub fn flow(vent: &str) -> String {
        format!("vent.{vent}.flow")
    }

    /// The body of a coordinate, and its member if it is a mode.
    fn owner(&self, coordinate: Coordinate) -> String {
        let body = &self.bodies[coordinate.body];
        match coordinate.part {
            Part::Mode { member, .. } => format!("body.{}.{}", body.name, body.members[member].name),
            _ => format!("body.{}", body.name),
        }
    }
}

/// A coordinate without its owner.
fn ending(part: Part) -> String {
    match part {
        Part::X => "x".to_string(),
        Part::Y => "y".to_string(),
        Part::Theta => "theta".to_string(),
        Part::Mode { mode, .. } => format!("q{}", mode + 1),
    }
}

/// Which family a reference belongs to and which of `size` coordinates it is.
pub fn coordinate(reference: Reference, size: usize) -> Option<(Reference, usize)> {
    [POSITION, VELOCITY, ACCELERATION, LOAD, LOAD_ACCELERATION].into_iter().find_map(|family| {
        let index = reference.checked_sub(family)? as usize;
        (index < size).then_some((family, index))
    })
}

/// Refuses numbers of a state of which one is not finite; `name` is used in messages.
pub fn finite(name: &str, values: &[f64]) -> Result<(), Failure> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(Failure::refused(format!("{name}[{index}] = {}: expected a finite number", values[index]))),
    }
}

/// Refuses a list of a state that has another length than its model; `what` is used in messages.
pub fn length(what: &str, got: usize, expected: usize) -> Result<(), Failure> {
    if got == expected {
        return Ok(());
    }
    Err(Failure::refused(format!("length of {what} = {got}: expected {expected}")))
}

/// Refuses a motion of another number of coordinates, or with a number that is not finite; `name` is used in messages.
pub fn check_motion(name: &str, motion: &kinematics::Motion, size: usize) -> Result<(), Failure> {
    for (part, values) in
        [("position", &motion.position), ("velocity", &motion.velocity), ("acceleration", &motion.acceleration)]
    {
        length(&format!("{name}.{part}"), values.len(), size)?;
        finite(&format!("{name}.{part}"), values.as_slice())?;
    }
    Ok(())
}
