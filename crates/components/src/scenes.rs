//! From the string parameter `scene` to a scene.

use crate::Error;
use scene::Scene;
use std::path::{Path, PathBuf};

/// Reads the scene called `name`: a path to a scene file, or the name of a scene packed in `resources/scenes`.
/// `overrides` is a text of the form `key.path=value; key.path=value`.
pub fn find_scene(name: &str, overrides: &str, resources: Option<&Path>) -> Result<Scene, Error> {
    let overrides = scene::parse_overrides(overrides)?;
    let path = locate(name, resources)?;
    Ok(Scene::from_file_with(&path, &overrides)?)
}

fn locate(name: &str, resources: Option<&Path>) -> Result<PathBuf, Error> {
    let not_found = |reason: String| Error::SceneNotFound { name: name.to_string(), reason };
    if name.trim().is_empty() {
        return Err(not_found("the parameter `scene` is empty, expected a name or a path".to_string()));
    }
    let path = Path::new(name);
    if path.is_file() {
        return Ok(path.to_path_buf());
    }
    let is_path = name.contains(['/', '\\']) || path.extension().is_some();
    if is_path {
        return Err(not_found("there is no such file".to_string()));
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
        return Ok(packed);
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
