//! Which files of a folder belong to its run.
//!
//! Names are relative to the folder, with `/` between folders; `*` in a listed name stands for a number. A file that was
//! being written when a run was killed has its listed name with the extension `part`.

use super::lock;
use crate::checkpoint;
use crate::record::{Error, RECIPE, Recipe};
use std::path::Path;

/// Extension of work in progress.
const PART: &str = ".part";
/// Names that may stand in a folder whatever is listed: what is there before the list is, and packed FMUs, which serve
/// the next run.
const ALWAYS: [&str; 4] = [RECIPE, lock::FILE_NAME, "fmus-*-modes/fluid.fmu", "fmus-*-modes/structure.fmu"];

/// Files that every run may write but its pictures, whose names depend on the variables.
pub fn tables() -> Vec<String> {
    let names = [
        RECIPE,
        "scene.toml",
        "log.txt",
        "results.csv",
        "results.parquet",
        "iterations.csv",
        "summary.json",
        "summary.md",
        "report.html",
        checkpoint::FILE_NAME,
        "frames/walls.vtu",
        "frames/particles.pvd",
        "frames/particles_*.vtu",
        "frames/structure.pvd",
        "frames/structure_*.vtu",
    ];
    names.map(str::to_string).into()
}

/// Files of pictures with these stems.
pub fn plots(stems: &[String]) -> Vec<String> {
    stems.iter().flat_map(|stem| ["png", "svg"].map(|extension| format!("plots/{stem}.{extension}"))).collect()
}

/// Whether a file is one of the listed ones, or one of them in the making.
pub(super) fn is_listed(file: &str, listed: &[impl AsRef<str>]) -> bool {
    listed.iter().any(|entry| is(file, entry.as_ref()))
}

fn is(file: &str, entry: &str) -> bool {
    if matches(file, entry) {
        return true;
    }
    let (Some(stem), Some((entry, _))) = (file.strip_suffix(PART), entry.rsplit_once('.')) else { return false };
    // FMUs are packed under the number of the process first.
    let without_number = stem.rsplit_once('.').filter(|(_, end)| is_number(end)).map(|(start, _)| start);
    matches(stem, entry) || without_number.is_some_and(|stem| matches(stem, entry))
}

fn matches(file: &str, entry: &str) -> bool {
    let Some((before, after)) = entry.split_once('*') else { return file == entry };
    let middle = file.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
    middle.is_some_and(is_number)
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Folders that the listed files lie in.
pub(super) fn folders(listed: &[impl AsRef<str>]) -> Vec<&str> {
    let mut folders: Vec<&str> =
        listed.iter().filter_map(|entry| entry.as_ref().rsplit_once('/').map(|(folder, _)| folder)).collect();
    folders.sort_unstable();
    folders.dedup();
    folders
}

/// Refuses a folder that holds anything that its run did not write.
pub(super) fn check(folder: &Path, recipe: Option<&Recipe>) -> Result<(), Error> {
    let listed = recipe.map_or(&[][..], |recipe| &recipe.files);
    let known = |file: &String| is_listed(file, listed) || is_listed(file, &ALWAYS);
    let mut strange: Vec<String> = files(folder)?.into_iter().filter(|file| !known(file)).collect();
    strange.sort();
    let Some(first) = strange.first() else { return Ok(()) };
    let path = folder.join(first);
    let what = if path.is_dir() { "a directory" } else { "a file" };
    let more = match strange.len() {
        1 => String::new(),
        count => format!(" ({} more like it)", count - 1),
    };
    let why = match recipe {
        None => format!("the folder has no {RECIPE}"),
        Some(recipe) if recipe.files.is_empty() => format!("{RECIPE} lists no files, as an earlier version wrote it"),
        Some(_) => format!("{RECIPE} does not list it"),
    };
    Err(Error::new(
        &path,
        format!("is {what} that no run wrote{more}: {why}; nothing was removed, choose another folder with --out"),
    ))
}

/// All files below a folder, relative to it; a folder that none of our files lies in counts as one.
pub(super) fn files(folder: &Path) -> Result<Vec<String>, Error> {
    let mut found = Vec::new();
    for name in entries(folder)? {
        let path = folder.join(&name);
        let ours = name == "frames" || name == "plots" || matches(&name, "fmus-*-modes");
        // A link to a folder is not followed: what lies behind it is not ours.
        if ours && path.symlink_metadata().is_ok_and(|data| data.is_dir()) {
            found.extend(entries(&path)?.into_iter().map(|inner| format!("{name}/{inner}")));
        } else {
            found.push(name);
        }
    }
    Ok(found)
}

fn entries(folder: &Path) -> Result<Vec<String>, Error> {
    let wrong = |error: std::io::Error| Error::new(folder, error);
    let name = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    std::fs::read_dir(folder).map_err(wrong)?.map(|entry| entry.map(name).map_err(wrong)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_the_list_and_in_the_making_are_ours() {
        let listed = [tables(), plots(&["field".to_string()])].concat();
        for file in ["results.csv", "frames/particles_000012.vtu", "frames/particles_1234567.vtu", "plots/field.svg"] {
            assert!(is_listed(file, &listed), "{file}");
        }
        for part in ["results.part", "checkpoint.part", "frames/particles_000012.part", "plots/field.part"] {
            assert!(is_listed(part, &listed), "{part}");
        }
        assert!(is_listed("fmus-3-modes/fluid.4711.part", &ALWAYS));
        let strange = ["thesis.tex", "results.csv.bak", "frames/particles_.vtu", "frames/particles_1a.vtu"];
        for file in
            [&strange[..], &["plots/mine.png", "thesis.part", "frames/results.csv", "notes/results.csv"]].concat()
        {
            assert!(!is_listed(file, &listed), "{file}");
        }
    }

    #[test]
    fn folders_come_once() {
        assert_eq!(folders(&["a.txt", "frames/x", "frames/y", "plots/z"]), ["frames", "plots"]);
    }
}
