//! From text to a scene, with overrides.

use crate::document::{file_name, from_toml, read_text};
use crate::{Error, Scene};
use std::path::Path;

/// Parses `key.path=value; key.path=value` into pairs.
pub fn parse_overrides(text: &str) -> Result<Vec<(String, String)>, Error> {
    text.split(';').map(str::trim).filter(|part| !part.is_empty()).map(parse_override).collect()
}

fn parse_override(text: &str) -> Result<(String, String), Error> {
    let (key, value) = text.split_once('=').ok_or_else(|| Error::Override {
        text: text.to_string(),
        reason: "expected key.path=value, for example fluid.spacing=0.002".to_string(),
    })?;
    Ok((key.trim().to_string(), value.trim().to_string()))
}

impl Scene {
    /// Reads and validates a scene file.
    pub fn from_file(path: &Path) -> Result<Self, Error> {
        Self::from_file_with(path, &[])
    }

    /// Reads a scene file, applies overrides (key path, TOML value) and validates.
    pub fn from_file_with(path: &Path, overrides: &[(String, String)]) -> Result<Self, Error> {
        Self::with_overrides(&read_text(path)?, &file_name(path), overrides)
    }

    /// Parses and validates the text of a scene called `name`.
    #[allow(clippy::should_implement_trait, reason = "takes a name for its messages")]
    pub fn from_str(text: &str, name: &str) -> Result<Self, Error> {
        Self::with_overrides(text, name, &[])
    }

    /// Parses the text, applies overrides (key path, TOML value), those of its quick variant first if that is active,
    /// validates.
    pub fn with_overrides(text: &str, name: &str, overrides: &[(String, String)]) -> Result<Self, Error> {
        refuse_old_form(text, name)?;
        let mut scene: Scene = from_toml(text, name, overrides)?;
        if scene.quick.active {
            let mut all = scene.quick.overrides(name)?;
            all.extend_from_slice(overrides);
            scene = from_toml(text, name, &all)?;
            scene.keep_quick_checks();
        }
        scene.validate(name).map_err(|error| error.located(text, overrides))?;
        Ok(scene)
    }
}

/// A scene of the form with one structure is refused with what to write before anything else that is wrong with it.
fn refuse_old_form(text: &str, name: &str) -> Result<(), Error> {
    let table = text.parse::<toml::Table>().unwrap_or_default();
    if !table.contains_key("structure") {
        return Ok(());
    }
    let message = "unknown key `structure`: a [structure] is a [[body]] with a `name` now, its beam a [[body.member]] with a \
                   `name`, its integrator stands in [integrator], and on_body = true is on_body = \"NAME\"";
    let line = crate::place::line_of(text, "structure").unwrap_or(1);
    Err(Error::Parse { name: name.to_string(), line, message: message.to_string(), hint: String::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = 'tank'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.01\n\
        water = [{ polygon = [[0,0],[1,0],[1,0.5],[0,0.5]] }]\n";

    #[test]
    fn unknown_key_names_line_and_nearest() {
        let text = SCENE.replace("spacing = 0.01", "spacing = 0.01\ndensty = 3.0");
        let message = Scene::from_str(&text, "tank.toml").unwrap_err().to_string();
        assert!(message.contains("line 7") && message.contains("`density`"), "{message}");
    }

    #[test]
    fn overrides_reach_nested_and_indexed_keys() {
        let overrides = parse_overrides("fluid.spacing=0.02; fluid.mps.alpha = 0.05; title=other").unwrap();
        let scene = Scene::with_overrides(SCENE, "tank.toml", &overrides).unwrap();
        let fluid = scene.fluid.unwrap();
        assert_eq!((fluid.spacing, fluid.mps.alpha, scene.title.as_str()), (0.02, 0.05, "other"));
        let bad = Scene::with_overrides(SCENE, "t", &[("fluid.spacin".into(), "1".into())]).unwrap_err();
        assert!(bad.to_string().contains("`spacing`"), "{bad}");
    }

    #[test]
    fn old_names_say_the_new_ones() {
        for (old, new) in [("accurate", "voronoi"), ("paper", "mps")] {
            for change in [format!("scheme = '{old}'"), format!("{old} = {{ alpha = 0.01 }}")] {
                let text = SCENE.replace("spacing = 0.01", &format!("spacing = 0.01\n{change}"));
                let message = Scene::from_str(&text, "tank.toml").unwrap_err().to_string();
                let expected = format!("`{old}` is called `{new}` now");
                assert!(message.contains(&expected) && message.contains("line 7"), "{message}");
            }
        }
    }

    #[test]
    fn an_old_structure_is_told_what_to_write() {
        let text = format!("{SCENE}[structure]\nfree = ['y']\n");
        let message = Scene::from_str(&text, "tank.toml").unwrap_err().to_string();
        assert!(
            message.contains("a [structure] is a [[body]] with a `name` now") && message.contains("line 8"),
            "{message}"
        );
        for (old, expected) in [
            ("[body]\nname = 'b'\n", "a body is written [[body]]"),
            ("[[body]]\nname = 'b'\nrho_infinity = 0.5\n", "stands in [integrator]"),
            ("[[region]]\nname = 'r'\n", "did you mean"),
        ] {
            let message = Scene::from_str(&format!("{SCENE}{old}"), "tank.toml").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let carried =
            SCENE.replace("spacing = 0.01", "spacing = 0.01\nprobe = [{ name = 'p', point = [0, 0], on_body = true }]");
        let message = Scene::from_str(&carried, "tank.toml").unwrap_err().to_string();
        assert!(message.contains("name the body: on_body = \"NAME\""), "{message}");
        let text = format!("{SCENE}[[body]]\nname = 'box'\n[body.beam]\nlength = 1.0\n");
        let message = Scene::from_str(&text, "tank.toml").unwrap_err().to_string();
        assert!(message.contains("a beam is a [[body.member]] with a `name` now"), "{message}");
    }

    #[test]
    fn entries_of_a_list_go_by_their_index_or_their_name() {
        let text = format!("{SCENE}[[body]]\nname = 'left box'\nfree = ['y']\nmass = 1.0\n");
        for (key, value) in [
            ("body.0.mass", "2.0"),
            ("body.left box.mass", "2.0"),
            ("body.left_box.mass", "2.0"),
            ("body[0].mass", "2.0"),
        ] {
            let scene = Scene::with_overrides(&text, "t", &[(key.into(), value.into())]).unwrap();
            assert_eq!(scene.body[0].mass, 2.0, "{key}");
        }
        let message = Scene::with_overrides(&text, "t", &[("body.box.mass".into(), "2".into())]).unwrap_err();
        assert!(message.to_string().contains("`box`: expected an index below 1 or a name: left box"), "{message}");
    }

    #[test]
    fn out_of_range_says_what_is_expected() {
        let error = Scene::with_overrides(SCENE, "t", &[("fluid.spacing".into(), "-1".into())]).unwrap_err();
        assert!(error.to_string().contains("fluid.spacing = -1"), "{error}");
    }
}
