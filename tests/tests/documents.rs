//! What documents name is there: source files, and what they are said to hold.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn collect(folder: &Path, extension: &str, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        // Dated records name what was there on their day.
        if name.starts_with('.') || name.starts_with("20") || ["target", "results", "fmus"].contains(&name.as_str()) {
            continue;
        }
        if path.is_dir() {
            collect(&path, extension, out);
        } else if path.extension().is_some_and(|found| found == extension) {
            out.push(path);
        }
    }
}

/// Source files that a text names in backquotes, each with the names that it is said to hold: `file.rs`: `name`, `name`.
fn named(text: &str) -> Vec<(String, Vec<String>)> {
    let parts: Vec<&str> = text.split('`').collect();
    let mut found = Vec::new();
    for k in (1..parts.len()).step_by(2) {
        let is_file = Path::new(parts[k]).extension().is_some_and(|extension| extension == "rs");
        if !is_file || parts[k].contains(' ') {
            continue;
        }
        let mut names = Vec::new();
        let mut next = k + 1;
        while let Some((&between, &name)) = parts.get(next).zip(parts.get(next + 1)) {
            let expected = if names.is_empty() { ": " } else { ", " };
            if between != expected || name.contains(['.', ' ']) {
                break;
            }
            names.push(name.rsplit("::").next().unwrap().to_string());
            next += 2;
        }
        found.push((parts[k].to_string(), names));
    }
    found
}

#[test]
fn documents_name_files_that_are_there_and_hold_what_they_are_said_to() {
    let (mut documents, mut sources) = (Vec::new(), Vec::new());
    collect(&root(), "md", &mut documents);
    collect(&root(), "rs", &mut sources);
    let (mut wrong, mut count) = (Vec::new(), 0);
    for document in documents {
        for (file, names) in named(&std::fs::read_to_string(&document).unwrap()) {
            count += 1;
            let texts = sources.iter().filter(|source| source.ends_with(&file));
            let texts: Vec<String> = texts.map(|source| std::fs::read_to_string(source).unwrap()).collect();
            if texts.is_empty() {
                wrong.push(format!("{}: {file} is not there", document.display()));
            }
            let lost = names.iter().filter(|name| !texts.iter().any(|text| text.contains(name.as_str())));
            wrong.extend(lost.map(|name| format!("{}: {file} has no {name}", document.display())));
        }
    }
    assert!(count > 30, "{count} files are named");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_and_names_are_found_in_a_text() {
    let text = "see `a/b.rs`: `one`, `Two::two`; the rest (`c.rs`, `d.rs`) and `no file`";
    let found = named(text);
    assert_eq!(found[0], ("a/b.rs".to_string(), vec!["one".to_string(), "two".to_string()]));
    assert_eq!(found[1..], [("c.rs".to_string(), vec![]), ("d.rs".to_string(), vec![])]);
}
