//! The record as a page of Markdown and as a table.

use super::{Record, Row};
use crate::bench::machine;
use fluid::StageTimes;
use report::record::Error;
use std::path::{Path, PathBuf};

const HEADER: [&str; 14] = [
    "case",
    "threads",
    "particles",
    "internal steps",
    "neighbours [ns]",
    "assembly [ns]",
    "solve [ns]",
    "gradient [ns]",
    "other [ns]",
    "total [ns]",
    "particle-steps per second [1/s]",
    "pressure iterations per step",
    "memory per particle [bytes]",
    "ratio to the record compared with",
];

/// Times of an earlier table: case, threads, time per particle and step \[ns\].
pub fn read(path: &Path) -> Result<Vec<(String, usize, f64)>, Error> {
    let wrong = |error: csv::Error| Error::new(path, error);
    let mut reader = csv::Reader::from_path(path).map_err(wrong)?;
    reader
        .records()
        .map(|record| {
            let record = record.map_err(wrong)?;
            let number = |k: usize| record.get(k).and_then(|text| text.parse::<f64>().ok()).unwrap_or(f64::NAN);
            Ok((record.get(0).unwrap_or_default().to_string(), number(1) as usize, number(9)))
        })
        .collect()
}

/// Writes page and table; gives the path of the page.
pub fn write(record: &Record, folder: &Path) -> Result<PathBuf, Box<dyn std::error::Error>> {
    let table = folder.join("speed.csv");
    let wrong = |error: csv::Error| Error::new(&table, error);
    let mut writer = csv::Writer::from_path(&table).map_err(wrong)?;
    writer.write_record(HEADER).map_err(wrong)?;
    for row in &record.rows {
        writer.write_record(cells(row)).map_err(wrong)?;
    }
    writer.flush().map_err(|error| Error::new(&table, error))?;
    let page = folder.join("speed.md");
    std::fs::write(&page, markdown(record)).map_err(|error| Error::new(&page, error))?;
    Ok(page)
}

fn cells(row: &Row) -> [String; 14] {
    let timing = &row.timing;
    let nanoseconds = |seconds: f64| format!("{:.1}", timing.per_particle_step(seconds));
    let StageTimes { neighbours, assembly, solve, gradient, other } = timing.stages;
    let memory = timing.memory.map_or_else(String::new, |bytes| format!("{:.0}", bytes / timing.particles as f64));
    [
        row.name.clone(),
        row.threads.to_string(),
        timing.particles.to_string(),
        timing.steps.to_string(),
        nanoseconds(neighbours),
        nanoseconds(assembly),
        nanoseconds(solve),
        nanoseconds(gradient),
        nanoseconds(other),
        format!("{:.1}", row.total()),
        format!("{:.3e}", 1e9 / row.total()),
        format!("{:.2}", timing.iterations as f64 / timing.steps as f64),
        memory,
        row.before.map_or_else(String::new, |before| format!("{:.2}", row.total() / before)),
    ]
}

fn markdown(record: &Record) -> String {
    let mut text = "# Cost of an internal step\n\n".to_string();
    text += &machine::table(&record.circumstances, record.load, record.repeats);
    text += "## Stages\n\nTimes per particle and internal step, wall-clock. Memory is the growth of the process over \
             particles; it says something for many particles, run first.\n\n";
    text += &format!("| {} |\n|{}\n", HEADER.join(" | "), "---|".repeat(HEADER.len()));
    for row in &record.rows {
        text += &format!("| {} |\n", cells(row).join(" | "));
    }
    text += &speed_up(record);
    text += &features(record);
    if let Some([first, later]) = record.passes {
        text += &format!(
            "\n## Passes of a coupling\n\nA plate that answers, 4 mm: the first pass of a communication step takes {:.2} ms, a \
             repeat from the same state to another motion {:.2} ms, {:.2} of it.\n",
            1e3 * first / super::STEPS as f64,
            1e3 * later / super::STEPS as f64,
            later / first
        );
    }
    text
}

/// Speed-up of the cases that ran on one thread and on more, and the serial share that explains it (Amdahl 1967).
fn speed_up(record: &Record) -> String {
    let mut text = "\n## Speed-up\n\n| case | threads | speed-up | serial share |\n|---|---|---|---|\n".to_string();
    for row in record.rows.iter().filter(|row| row.threads > 1) {
        let Some(single) = record.rows.iter().find(|other| other.name == row.name && other.threads == 1) else {
            continue;
        };
        let (ratio, threads) = (single.total() / row.total(), row.threads as f64);
        let serial = (threads / ratio - 1.0) / (threads - 1.0);
        text += &format!("| {} | {} | {ratio:.2} | {:.0} % |\n", row.name, row.threads, 100.0 * serial.max(0.0));
    }
    text
}

fn features(record: &Record) -> String {
    if record.features.is_empty() {
        return String::new();
    }
    let mut text =
        "\n## What a scene pays for\n\nTime per particle and internal step on one thread \\[ns\\].\n\n| part | with \
                    | without | cost |\n|---|---|---|---|\n"
            .to_string();
    for cost in &record.features {
        let (with, without) = (cost.with, cost.without);
        text += &format!("| {} | {with:.0} | {without:.0} | {:.0} |\n", cost.feature.name, with - without);
    }
    text
}
