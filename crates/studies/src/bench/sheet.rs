//! The record as a table for other programs: one row per run and figure.

use super::Record;
use super::comparison::Comparison;
use super::trial::Trial;
use report::record::Error;
use std::path::Path;

const HEADER: [&str; 20] = [
    "scene",
    "figure",
    "unit",
    "scheme",
    "spacing [m]",
    "error",
    "order since the coarser run",
    "order by least squares",
    "wall-clock time [s]",
    "processor time [s]",
    "threads",
    "internal steps",
    "particles",
    "particle-steps",
    "particle-steps per second [1/s]",
    "pressure iterations",
    "particles lost",
    "area change",
    "end [s]",
    "problem",
];

/// Writes the table.
pub fn write(record: &Record, path: &Path) -> Result<(), Error> {
    let wrong = |error: csv::Error| Error::new(path, error);
    let mut writer = csv::Writer::from_path(path).map_err(wrong)?;
    writer.write_record(HEADER).map_err(wrong)?;
    for comparison in &record.comparisons {
        for (figure, trial) in
            (0..comparison.plan.figures.len()).flat_map(|it| comparison.trials.iter().map(move |t| (it, t)))
        {
            writer.write_record(row(comparison, figure, trial)).map_err(wrong)?;
        }
    }
    writer.flush().map_err(|error| Error::new(path, error))
}

fn row(comparison: &Comparison, figure: usize, trial: &Trial) -> [String; 20] {
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value}"));
    let (plan, work) = (&comparison.plan, &trial.work);
    [
        plan.scene.to_string(),
        plan.figures[figure].to_string(),
        trial.units[figure].clone(),
        trial.scheme.name().to_string(),
        format!("{}", trial.spacing),
        optional(trial.errors[figure]),
        optional(comparison.order_since(trial, figure)),
        optional(comparison.order(trial.scheme, figure)),
        format!("{:.3}", trial.wall),
        trial.processor.map_or_else(String::new, |seconds| format!("{seconds:.3}")),
        format!("{}", trial.threads),
        format!("{}", work.steps),
        format!("{}", work.particles),
        format!("{}", work.particle_steps),
        format!("{:.0}", work.particle_steps / trial.seconds()),
        format!("{}", work.iterations),
        format!("{}", work.lost),
        optional(work.area_change),
        format!("{}", plan.end.unwrap_or(comparison.scene_end)),
        trial.problem.clone(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::comparison::tests::example;
    use report::machine::Circumstances;

    #[test]
    fn every_run_has_a_row_that_reads_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("accuracy.csv");
        let mut comparison = example();
        comparison.trials[1].problem = "failed at 1 s: \"a, b\"".to_string();
        comparison.trials[1].errors = vec![None];
        let (circumstances, load) = (Circumstances::now(), (None, None));
        write(&Record { circumstances, load, repeats: 1, comparisons: vec![comparison] }, &path).unwrap();
        let mut reader = csv::Reader::from_path(&path).unwrap();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 6);
        assert_eq!((&rows[0][3], &rows[0][4], &rows[0][15]), ("voronoi", "0.4", "0"));
        assert_eq!((&rows[1][5], &rows[1][19]), ("", "failed at 1 s: \"a, b\""));
        assert!((rows[4][6].parse::<f64>().unwrap() - 2.0).abs() < 1e-12);
    }
}
