//! `plimsoll new` and `plimsoll schema`: help with writing scenes.

use super::Failure;
use crate::answer;
use crate::case::Case;
use scene::Scene;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Name of the schema beside a new scene.
const SCHEMA: &str = "plimsoll-scene.schema.json";

/// A scene to begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    /// A tank with a column of water.
    Tank,
    /// The same with an elastic plate.
    Plate,
    /// A floating cabin with a hole and a flexible bulkhead.
    Cabin,
}

/// What file to begin.
#[derive(Debug, clap::Args)]
pub(super) struct NewArguments {
    /// Name of the scene, or path of its file.
    name: PathBuf,
    /// What it begins with.
    #[arg(long, value_enum, default_value = "tank")]
    kind: Kind,
}

/// Files that have a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum SchemaOf {
    /// Scene files.
    Scene,
    /// Case files.
    Case,
}

impl Kind {
    fn template(self) -> &'static str {
        match self {
            Self::Tank => include_str!("templates/tank.toml"),
            Self::Plate => include_str!("templates/plate.toml"),
            Self::Cabin => include_str!("templates/cabin.toml"),
        }
    }
}

pub(super) fn create(arguments: &NewArguments) -> Result<ExitCode, Failure> {
    let path = with_extension(&arguments.name);
    let name = scene::name_of(&path);
    let wrong = |path: &Path, error: std::io::Error| format!("{} cannot be written: {error}", path.display());
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("the folder {} cannot be made: {error}", folder.display()))?;
    }
    let mut file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|error| wrong(&path, error))?;
    let quoted = name.replace(['"', '\\'], "'");
    file.write_all(arguments.kind.template().replace("NAME", &quoted).as_bytes())
        .map_err(|error| wrong(&path, error))?;
    let beside = path.with_file_name(SCHEMA);
    std::fs::write(&beside, schema_text(SchemaOf::Scene)?).map_err(|error| wrong(&beside, error))?;
    answer!("{}", path.display());
    let word = quoted_for_shell(&path);
    answer!("next: plimsoll check {word}; plimsoll run {word}");
    Ok(ExitCode::SUCCESS)
}

/// The path with .toml at its end; a dot within the name stays.
fn with_extension(path: &Path) -> PathBuf {
    if path.extension().is_some_and(|extension| extension == "toml") {
        return path.to_path_buf();
    }
    let mut name = path.as_os_str().to_os_string();
    name.push(".toml");
    name.into()
}

/// A path as one word of a shell's command.
fn quoted_for_shell(path: &Path) -> String {
    let text = path.display().to_string();
    shlex::try_quote(&text).map_or_else(|_| text.clone(), |quoted| quoted.into_owned())
}

pub(super) fn schema(what: SchemaOf) -> Result<ExitCode, Failure> {
    answer!("{}", schema_text(what)?.trim_end());
    Ok(ExitCode::SUCCESS)
}

/// The JSON schema of a kind of file, from the types that read it.
fn schema_text(what: SchemaOf) -> Result<String, serde_json::Error> {
    let schema = match what {
        SchemaOf::Scene => schemars::schema_for!(Scene),
        SchemaOf::Case => schemars::schema_for!(Case),
    };
    // Comments escape square brackets for the documentation; editors show the text as it is.
    let text = serde_json::to_string_pretty(&schema)?.replace("\\\\[", "[").replace("\\\\]", "]");
    Ok(text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_is_a_scene_that_can_be_set_up() {
        for kind in [Kind::Tank, Kind::Plate, Kind::Cabin] {
            let scene = Scene::from_str(kind.template(), "template").unwrap();
            assert!(components::fluid_set_up(&scene).unwrap().0.len() > 100, "{kind:?}");
            components::structure_set_up(&scene).unwrap();
        }
    }

    #[test]
    fn names_with_blanks_are_one_word_and_dots_stay() {
        assert_eq!(quoted_for_shell(Path::new("a/b.toml")), "a/b.toml");
        assert_eq!(quoted_for_shell(Path::new("my scenes/tank 2.toml")), "'my scenes/tank 2.toml'");
        assert_eq!(with_extension(Path::new("tank")), Path::new("tank.toml"));
        assert_eq!(with_extension(Path::new("tank.toml")), Path::new("tank.toml"));
        assert_eq!(with_extension(Path::new("a/v1.2")), Path::new("a/v1.2.toml"));
    }

    #[test]
    fn water_over_a_plate_as_thin_as_the_spacing_is_refused() {
        let wider = [("[0.3, 0.0], [0.3, 0.25]", "[0.7, 0.0], [0.7, 0.25]"), ("thickness = 0.008", "thickness = 0.01")];
        let template = Kind::Plate.template().to_string();
        let text = wider.iter().fold(template, |text, (from, to)| text.replace(from, to));
        let scene = Scene::from_str(&text, "template").unwrap();
        let message = components::fluid_set_up(&scene).unwrap_err().to_string();
        assert!(message.contains("(0.595, 0.005)") && message.contains("surface of the structure"), "{message}");
    }

    #[test]
    fn the_committed_schemas_are_those_of_the_types() {
        for (what, name) in [(SchemaOf::Scene, "scene"), (SchemaOf::Case, "case")] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/schema/{name}.schema.json"));
            let committed = std::fs::read_to_string(&path).unwrap();
            assert!(committed == schema_text(what).unwrap(), "stale: plimsoll schema {name} > {}", path.display());
        }
    }

    #[test]
    fn the_schema_accepts_every_scene_and_refuses_unknown_keys() {
        let schema = serde_json::from_str(&schema_text(SchemaOf::Scene).unwrap()).unwrap();
        let validator = jsonschema::validator_for(&schema).unwrap();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
        for path in crate::pack::files_with(&folder, "toml").unwrap() {
            let value: serde_json::Value = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
            let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{}: {errors:?}", path.display());
            let mut wrong = value.clone();
            wrong["run"]["ende"] = 1.0.into();
            assert!(!validator.is_valid(&wrong));
            let mut wrong = value;
            wrong["run"]["end"] = "long".into();
            assert!(!validator.is_valid(&wrong));
        }
    }
}
