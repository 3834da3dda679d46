use super::*;
use std::fs;

fn recipe(files: &[&str]) -> Recipe {
    let fmus = [("a", Path::new("a.fmu"))].into_iter();
    let recipe = Recipe::new("c", &[], None, Path::new(""), fmus, tables());
    Recipe { files: files.iter().map(ToString::to_string).collect(), ..recipe }
}

fn refused(folder: &Path) -> String {
    RunFolder::open(folder).unwrap_err().to_string()
}

#[test]
fn a_folder_with_anything_else_is_refused_and_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("results.csv"), "mine").unwrap();
    let message = refused(at);
    assert!(
        message.contains("results.csv: is a file that no run wrote") && message.contains("no run.json"),
        "{message}"
    );
    recipe(&["run.json", "results.csv"]).write(at, "").unwrap();
    fs::remove_file(at.join("scene.toml")).unwrap();
    assert!(RunFolder::open(at).is_ok());
    fs::create_dir(at.join("thesis")).unwrap();
    assert!(refused(at).contains("thesis: is a directory that no run wrote"));
    fs::remove_dir(at.join("thesis")).unwrap();
    fs::create_dir(at.join("plots")).unwrap();
    fs::write(at.join("plots/mine.png"), "").unwrap();
    let message = refused(at);
    assert!(message.contains("mine.png") && message.contains("does not list it"), "{message}");
    assert!(!at.join("run.lock").exists() && at.join("results.csv").exists());
}

#[test]
fn a_record_of_another_program_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("run.json"), "{ \"name\": 1 }").unwrap();
    assert!(refused(folder.path()).contains("run.json"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn only_listed_files_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    recipe(&["run.json", "scene.toml", "results.csv", "frames/particles_*.vtu"]).write(at, "x").unwrap();
    fs::create_dir(at.join("frames")).unwrap();
    for name in ["results.csv", "frames/particles_000001.vtu", "frames/particles_000002.part"] {
        fs::write(at.join(name), "").unwrap();
    }
    let run = RunFolder::open(at).unwrap();
    // Somebody else's, put there since.
    fs::write(at.join("frames/mine.vtu"), "").unwrap();
    run.clear().unwrap();
    let mut left = names::files(at).unwrap();
    left.sort();
    assert_eq!(left, ["frames/mine.vtu", "run.json", "run.lock"]);
}

#[test]
fn a_lock_keeps_the_second_out_and_a_dead_one_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let first = RunFolder::open(folder.path()).unwrap();
    assert_eq!(first.note(), None);
    let message = refused(folder.path());
    assert!(message.contains("a run is at work there (process ") && message.contains("--out"), "{message}");
    drop(first);
    assert!(!folder.path().join("run.lock").exists());
    fs::write(folder.path().join("run.lock"), "process 1234567\n").unwrap();
    let after = RunFolder::open(folder.path()).unwrap();
    assert!(after.note().is_some_and(|note| note.contains("process 1234567")), "{:?}", after.note());
}

#[test]
fn a_complete_run_is_replaced_on_demand_only() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut made = recipe(&["run.json", "scene.toml"]);
    made.write(at, "").unwrap();
    let allowed = |resume, overwrite| RunFolder::open(at).unwrap().allow(Wish { resume, overwrite });
    assert!(allowed(false, false).is_ok(), "one that was stopped");
    made.end(at).unwrap();
    let message = allowed(false, false).unwrap_err().to_string();
    assert!(message.contains("holds a complete run; --overwrite replaces it"), "{message}");
    assert!(allowed(true, false).unwrap_err().to_string().contains("of other inputs"));
    assert!(allowed(false, true).is_ok());
}

#[test]
fn what_a_kill_at_the_very_end_has_left_is_cleared_away() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.lock", "checkpoint.bin", "results.csv"] {
        fs::write(folder.path().join(name), "process 1\n").unwrap();
    }
    tidy(folder.path()).unwrap();
    assert_eq!(names::files(folder.path()).unwrap(), ["results.csv"]);
}

#[test]
fn places_that_belong_to_more_than_a_run_are_nonsense() {
    let root = if cfg!(windows) { "C:\\" } else { "/" };
    assert!(refused(Path::new(root)).contains("is the root of the file system"));
    assert!(refused(Path::new("..")).contains("is above the"));
    let home = std::env::home_dir().filter(|home| home.parent().is_some() && home.is_dir());
    assert!(home.is_none_or(|home| refused(&home).contains("is the home folder")));
}
