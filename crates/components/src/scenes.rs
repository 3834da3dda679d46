//! From the string parameter `scene` to a scene.

use crate::{Error, INTERFACE_FILE};
use scene::Scene;
use std::path::{Path, PathBuf};

/// Scene that an FMU was packed for, in its resources.
pub const OWN_SCENE: &str = "scene.toml";
/// Scene of an FMU that was packed for none.
pub const DEFAULT_SCENE: &str = "dam_break_plate";
const DEFAULT_TEXT: &str = include_str!("../../../scenes/dam_break_plate.toml");

/// The scene of an FMU that was packed for none.
///
/// # Errors
/// None that a test would not find: the scene is a part of the program.
pub fn default_scene() -> Result<Scene, Error> {
    Ok(Scene::from_str(DEFAULT_TEXT, DEFAULT_SCENE)?)
}

/// Reads the scene called `name`: a path to a scene file, or the name of a scene packed in `resources/scenes`. An empty
/// name stands for the scene that the FMU was packed for, or else for dam_break_plate.
/// `overrides` is a text of the form `key.path=value; key.path=value`.
pub fn find_scene(name: &str, overrides: &str, resources: Option<&Path>) -> Result<Scene, Error> {
    let overrides = scene::parse_overrides(overrides)?;
    match locate(name, resources)? {
        Some(path) => Ok(Scene::from_file_with(&path, &overrides)?),
        None => Ok(Scene::with_overrides(DEFAULT_TEXT, DEFAULT_SCENE, &overrides)?),
    }
}

/// The file of a scene; none for the one that is a part of the program.
fn locate(name: &str, resources: Option<&Path>) -> Result<Option<PathBuf>, Error> {
    let not_found = |reason: String| Error::SceneNotFound { name: name.to_string(), reason };
    let own = resources.map(|resources| resources.join(OWN_SCENE)).filter(|path| path.is_file());
    if name.trim().is_empty() {
        // What was packed for a scene must not begin with another one.
        let packed = resources.is_some_and(|resources| resources.join(INTERFACE_FILE).is_file());
        return match own {
            None if packed => {
                Err(not_found(format!("the resources have no {OWN_SCENE}; give the path of a scene file")))
            }
            own => Ok(own),
        };
    }
    let path = Path::new(name);
    if path.is_file() {
        return Ok(Some(path.to_path_buf()));
    }
    let is_path = name.contains(['/', '\\']) || path.extension().is_some();
    if is_path {
        let other = path.exists().then(|| scene::check_file(path).err()).flatten();
        return Err(not_found(other.unwrap_or_else(|| "there is no such file".to_string())));
    }
    let Some(resources) = resources else {
        return Err(not_found(
            "the importer gave no fmuResourceLocation, so packed scenes are out of reach; give the path of a scene file"
                .to_string(),
        ));
    };
    let folder = resources.join("scenes");
    let packed = folder.join(format!("{name}.toml"));
    if packed.is_file() {
        return Ok(Some(packed));
    }
    let known = names(&folder);
    let known = if known.is_empty() { "none".to_string() } else { known.join(", ") };
    Err(not_found(format!("no such file, and the scenes packed in {} are: {known}", folder.display())))
}

fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.strip_suffix(".toml").map(str::to_string))
        .collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_say_where_was_looked() {
        let message = find_scene("tank", "", None).unwrap_err().to_string();
        assert!(message.contains("fmuResourceLocation") && message.contains("path"), "{message}");
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let message = find_scene("tank", "", Some(&scenes)).unwrap_err().to_string();
        assert!(message.contains("hydrostatic"), "{message}");
        let message = find_scene("no/such.toml", "", Some(&scenes)).unwrap_err().to_string();
        assert!(message.contains("no such file"), "{message}");
    }

    #[test]
    fn packed_scene_with_overrides() {
        let resources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let scene = find_scene("hydrostatic", "fluid.spacing=0.05", Some(&resources)).unwrap();
        assert_eq!(scene.fluid.unwrap().spacing, 0.05);
    }
}
