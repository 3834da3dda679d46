//! What an FMU brings along that was packed for scenes of the repository: variables, GUID, resources.

use crate::root;
use components::{INTERFACE_FILE, Interface};
use fmi::Component;
use fmi2::describe;
use scene::Scene;
use std::path::PathBuf;

/// An FMU with the variables of some scenes, those of the first one first; with those of none where there are none.
pub struct Packed {
    /// Its variables.
    pub interface: Interface,
    /// Its resources.
    pub folder: PathBuf,
}

impl Packed {
    /// For these scenes, by their names; what is no scene of the repository counts for nothing.
    pub fn of(scenes: &[&str]) -> Self {
        let file = |name: &&str| root().join(format!("scenes/{name}.toml"));
        let known = scenes.iter().map(file).filter_map(|path| Scene::from_file(&path).ok());
        let all = known.map(|scene| Interface::of(&scene)).reduce(joined);
        let Some(interface) = all else {
            let interface = Interface::of_resources(None).expect("the default scene is a part of the program");
            return Self { interface, folder: root() };
        };
        let guid = describe::guid(&components::FluidComponent::model(&interface)).expect("a description");
        let folder = std::env::temp_dir().join(format!("plimsoll-resources-{guid}"));
        std::fs::create_dir_all(&folder).expect("a folder for temporary files");
        // Several tests may do this at once, with the same content.
        let _ = std::os::unix::fs::symlink(root().join("scenes"), folder.join("scenes"));
        let part = tempfile::NamedTempFile::new_in(&folder).expect("a temporary file");
        std::fs::write(part.path(), interface.to_text()).expect("a small file");
        part.persist(folder.join(INTERFACE_FILE)).expect("a small file");
        Self { interface, folder }
    }

    /// GUID of the component.
    pub fn guid<C: Component<Interface = Interface>>(&self) -> String {
        describe::guid(&C::model(&self.interface)).expect("a description").to_string()
    }

    /// The resources as an importer gives them.
    pub fn location(&self) -> String {
        format!("file://{}", self.folder.display())
    }
}

/// All that one of the two has, or the other.
fn joined(mut all: Interface, other: Interface) -> Interface {
    fn add(names: &mut Vec<String>, others: Vec<String>) {
        let new: Vec<String> = others.into_iter().filter(|name| !names.contains(name)).collect();
        names.extend(new);
    }
    add(&mut all.probes, other.probes);
    add(&mut all.regions, other.regions);
    add(&mut all.gauges, other.gauges);
    for body in other.bodies {
        let Some(known) = all.bodies.iter_mut().find(|known| known.name == body.name) else {
            all.bodies.push(body);
            continue;
        };
        for member in body.members {
            match known.members.iter_mut().find(|known| known.name == member.name) {
                Some(known) => known.modes = known.modes.max(member.modes),
                None => known.members.push(member),
            }
        }
    }
    all
}
