//! What a command is about: a scene by name, a file, or the folder of an earlier run.

use crate::record::Recipe;
use crate::{pack, scene_case};
use std::error::Error;
use std::path::{Path, PathBuf};

/// A scene or case file with the changes of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Name of the scene or case.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Folder that its reference files are relative to.
    pub references: PathBuf,
    /// Changes of its values, `key.path=value`.
    pub set: Vec<String>,
}

impl Target {
    /// A path as it is, the run in a folder, or the scene of that name.
    ///
    /// # Errors
    /// Nothing has that name, or it cannot be read.
    pub fn find(target: &str) -> Result<Self, Box<dyn Error>> {
        let path = PathBuf::from(target);
        if path.is_dir() {
            return Self::of_run(&path);
        }
        let path = locate(path, target)?;
        let (name, text) = (scene::name_of(&path), scene::read_text(&path)?);
        let references = path.parent().unwrap_or(Path::new("")).to_path_buf();
        Ok(Self { name, path, text, references, set: Vec::new() })
    }

    fn of_run(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let recipe = Recipe::read(folder)?.ok_or_else(|| {
            format!("{} is a folder without {}: no run was done there", folder.display(), crate::record::RECIPE)
        })?;
        let path = Recipe::scene_in(folder);
        let text = scene::read_text(&path)?;
        Ok(Self { name: recipe.name, path, text, references: recipe.references, set: recipe.set })
    }

    /// The same with further changes.
    #[must_use]
    pub fn changed(mut self, set: &[String]) -> Self {
        self.set.extend_from_slice(set);
        self
    }

    /// The changes as pairs of key path and TOML value.
    ///
    /// # Errors
    /// A change that is no `key.path=value`.
    pub fn overrides(&self) -> Result<Vec<(String, String)>, scene::Error> {
        let mut pairs = Vec::new();
        for text in &self.set {
            pairs.extend(scene::parse_overrides(text)?);
        }
        Ok(pairs)
    }

    /// Whether it is a case rather than a scene.
    pub fn is_case(&self) -> bool {
        scene_case::is_case(&self.text)
    }
}

fn locate(path: PathBuf, target: &str) -> Result<PathBuf, Box<dyn Error>> {
    if path.is_file() {
        return Ok(path);
    }
    if path.exists() {
        // A pipe or a device.
        return Err(scene::read_text(&path).map_or_else(|error| error.to_string(), |_| String::new()).into());
    }
    let folder = pack::scenes_folder()?;
    let scene = folder.join(format!("{target}.toml"));
    if scene.is_file() {
        return Ok(scene);
    }
    let names: Vec<String> = pack::files_with(&folder, "toml")?.iter().map(|path| scene::name_of(path)).collect();
    let hint = scene::nearest(target, names.iter().map(String::as_str));
    let hint = hint.map_or_else(String::new, |name| format!("; did you mean '{name}'?"));
    let known = names.join(", ");
    Err(format!("'{target}' is neither a file nor a scene in {} ({known}){hint}", folder.display()).into())
}
