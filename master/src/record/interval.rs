//! Columns whose rows stand for all of the interval since the row before: means, and largest values.

use coupling::System;
use coupling::participant::Variable;
use serde::{Deserialize, Serialize};

/// What a column makes of the values since its last row.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Mean,
    Largest,
}

/// A column and its variable.
#[derive(Debug)]
struct Gathered {
    kind: Kind,
    /// Index of the participant.
    participant: usize,
    variable: Variable,
    /// Index of the column.
    column: usize,
}

/// What was gathered since the last row.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Time of the last row, and up to which values were gathered \[s\].
    since: f64,
    until: f64,
    values: Vec<f64>,
}

/// Gathers values between rows.
#[derive(Debug)]
pub struct Interval {
    columns: Vec<Gathered>,
    /// What was gathered.
    pub memory: Memory,
}

impl Interval {
    /// For those of the columns `recorded` of each participant whose names are among `means` or `maxima`, from `start` \[s\] on.
    pub fn new(recorded: &[Vec<(String, Variable)>], means: &[String], maxima: &[String], start: f64) -> Self {
        let all = recorded
            .iter()
            .enumerate()
            .flat_map(|(participant, part)| part.iter().map(move |entry| (participant, entry)));
        let columns = all.enumerate().filter_map(|(column, (participant, (name, variable)))| {
            let kind = match (means.contains(name), maxima.contains(name)) {
                (true, _) => Kind::Mean,
                (_, true) => Kind::Largest,
                _ => return None,
            };
            Some(Gathered { kind, participant, variable: variable.clone(), column })
        });
        let mut interval =
            Self { columns: columns.collect(), memory: Memory { since: start, until: start, values: Vec::new() } };
        interval.begin(start);
        interval
    }

    fn begin(&mut self, time: f64) {
        let empty = |gathered: &Gathered| if gathered.kind == Kind::Mean { 0.0 } else { f64::NEG_INFINITY };
        self.memory = Memory { since: time, until: time, values: self.columns.iter().map(empty).collect() };
    }

    /// Takes the values at `time` \[s\], which stand for the time since the last ones.
    pub fn gather(&mut self, system: &mut System, time: f64) -> Result<(), coupling::Error> {
        let duration = time - self.memory.until;
        if self.columns.is_empty() || duration <= 0.0 {
            return Ok(());
        }
        for (index, participant) in system.participants().enumerate() {
            let of_it =
                self.columns.iter().zip(&mut self.memory.values).filter(|(gathered, _)| gathered.participant == index);
            for (gathered, sum) in of_it {
                let value = participant.get(&gathered.variable)?.number().unwrap_or(f64::NAN);
                match gathered.kind {
                    Kind::Mean => *sum += value * duration,
                    Kind::Largest => *sum = sum.max(value),
                }
            }
        }
        self.memory.until = time;
        Ok(())
    }

    /// Puts what was gathered into a row, and begins anew.
    pub fn close(&mut self, row: &mut [f64]) {
        let Memory { since, until, values } = &self.memory;
        if until > since {
            for (gathered, value) in self.columns.iter().zip(values) {
                row[gathered.column] = if gathered.kind == Kind::Mean { value / (until - since) } else { *value };
            }
        }
        self.begin(*until);
    }
}
