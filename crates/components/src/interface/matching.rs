//! Where the parts of a scene stand in the interface of an FMU that may have more.

use super::{Interface, MemberNames};
use crate::Error;

/// For everything that an FMU has its index in a scene, none where the scene has not got it; both have the same order
/// where an FMU was packed for the scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Matching {
    /// Coordinates.
    pub coordinates: Vec<Option<usize>>,
    /// Members, those of all bodies.
    pub members: Vec<Option<usize>>,
    /// Pressure probes.
    pub probes: Vec<Option<usize>>,
    /// Of those that give their largest pressure, too, the index among all probes of the scene.
    pub largest: Vec<Option<usize>>,
    /// The same of those that give an impulse.
    pub impulses: Vec<Option<usize>>,
    /// Regions.
    pub regions: Vec<Option<usize>>,
    /// Level gauges.
    pub gauges: Vec<Option<usize>>,
    /// Places where gas is read.
    pub chambers: Vec<Option<usize>>,
    /// Vents.
    pub vents: Vec<Option<usize>>,
}

impl Matching {
    /// Between an FMU and a scene.
    ///
    /// # Errors
    /// A variable of the scene that the FMU has not.
    pub fn new(fmu: &Interface, scene: &Interface) -> Result<Self, Error> {
        let coordinates = |interface: &Interface| -> Vec<String> {
            interface.layout().coordinates().map(|coordinate| interface.load(coordinate)).collect()
        };
        let members = |interface: &Interface| -> Vec<String> {
            interface
                .members()
                .map(|(body, member): (_, &MemberNames)| format!("body.{}.{}", body.name, member.name))
                .collect()
        };
        let named = |names: &[String], name: fn(&str) -> String| names.iter().map(|own| name(own)).collect::<Vec<_>>();
        let pair = |names: fn(&Interface) -> &[String], name| (named(names(fmu), name), named(names(scene), name));
        let matched = |(fmu, scene): (Vec<String>, Vec<String>)| matched(&fmu, &scene);
        let among_probes = |indices: Vec<Option<usize>>, names: &[String]| -> Vec<Option<usize>> {
            let probe = |index: usize| scene.probes.iter().position(|probe| *probe == names[index]);
            indices.into_iter().map(|index| index.and_then(probe)).collect()
        };
        Ok(Self {
            coordinates: matched((coordinates(fmu), coordinates(scene)))?,
            members: matched((members(fmu), members(scene)))?,
            probes: matched(pair(|interface| &interface.probes, Interface::pressure))?,
            largest: among_probes(matched(pair(|interface| &interface.largest, Interface::largest))?, &scene.largest),
            impulses: among_probes(
                matched(pair(|interface| &interface.impulses, Interface::impulse))?,
                &scene.impulses,
            ),
            regions: matched(pair(|interface| &interface.regions, Interface::mass))?,
            gauges: matched(pair(|interface| &interface.gauges, Interface::level))?,
            chambers: matched(pair(|interface| &interface.chambers, |name| Interface::chamber(name)[0].clone()))?,
            vents: matched(pair(|interface| &interface.vents, Interface::flow))?,
        })
    }

    /// Index of a coordinate of the FMU in the scene.
    pub fn coordinate(&self, index: usize) -> Option<usize> {
        self.coordinates.get(index).copied().flatten()
    }

    /// Coordinates of the scene, each with its index in the FMU first.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.coordinates.iter().enumerate().filter_map(|(own, of_scene)| Some((own, (*of_scene)?)))
    }
}

/// For each name of the FMU its index among those of the scene.
fn matched(fmu: &[String], scene: &[String]) -> Result<Vec<Option<usize>>, Error> {
    match scene.iter().find(|name| !fmu.contains(name)) {
        Some(name) => Err(Error::NotInInterface { name: name.clone() }),
        None => Ok(fmu.iter().map(|name| scene.iter().position(|other| other == name)).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::BodyNames;
    use super::*;

    fn interface(modes: &[(&str, usize)], probes: &[&str]) -> Interface {
        let member = |(name, modes): &(&str, usize)| MemberNames { name: (*name).to_string(), modes: *modes };
        let body = BodyNames { name: "cabin".to_string(), members: modes.iter().map(member).collect() };
        Interface {
            bodies: vec![body],
            probes: probes.iter().map(ToString::to_string).collect(),
            ..Interface::default()
        }
    }

    #[test]
    fn what_a_scene_has_is_found_by_its_name() {
        let fmu = interface(&[("deck", 2), ("bulkhead", 2)], &["a", "b"]);
        let same = Matching::new(&fmu, &fmu).unwrap();
        assert_eq!(same.coordinates, (0..7).map(Some).collect::<Vec<_>>());
        let less = Matching::new(&fmu, &interface(&[("bulkhead", 1)], &["b"])).unwrap();
        assert_eq!(less.coordinates, [Some(0), Some(1), Some(2), None, None, Some(3), None]);
        assert_eq!((less.members, less.probes), (vec![None, Some(0)], vec![None, Some(0)]));
        let more = Matching::new(&fmu, &interface(&[("deck", 3)], &[])).unwrap_err().to_string();
        assert!(more.contains("body.cabin.deck.load.q3"), "{more}");
    }
}
