//! Wall-clock time by stage. Participants tell theirs by real outputs called `stage.*`, in seconds.

use crate::record::STAGE;
use coupling::System;
use coupling::participant::{Causality, Kind, Value};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Times of a run \[s\].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Stages {
    /// In accepted and repeated steps, participants included.
    pub advancing: f64,
    /// Reading and writing results.
    pub recording: f64,
    /// In the steps of participants, from outside.
    pub stepping: f64,
    /// As participants tell, by stage.
    pub told: BTreeMap<String, f64>,
}

impl Stages {
    /// Adds what the participants spent in this process, once; one that cannot answer any more (after an error) counts
    /// for nothing.
    pub fn collect(&mut self, system: &mut System) {
        self.stepping += system.step_seconds();
        for participant in system.participants() {
            let variables = participant.description().variables.clone();
            let stages = variables.iter().filter(|variable| {
                variable.name.starts_with(STAGE)
                    && variable.kind == Kind::Real
                    && variable.causality == Causality::Output
            });
            for variable in stages {
                let Ok(Value::Real(seconds)) = participant.get(variable) else { continue };
                let stage = &variable.name[STAGE.len()..];
                // A stage that is the whole step is better called by the participant's name.
                let stage = if stage == "step" { participant.name() } else { stage };
                *self.told.entry(stage.to_string()).or_default() += seconds;
            }
        }
    }

    /// All stages: those told, plus coupling (everything in a step outside the participants), output (with what
    /// participants write), and other (time in participants that they do not tell).
    pub fn table(&self) -> BTreeMap<String, f64> {
        let mut table = self.told.clone();
        let told: f64 = self.told.values().sum();
        *table.entry("output".to_string()).or_default() += self.recording;
        *table.entry("coupling".to_string()).or_default() += (self.advancing - self.stepping).max(0.0);
        *table.entry("other".to_string()).or_default() += (self.stepping - told).max(0.0);
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_adds_up_to_the_run() {
        let told = BTreeMap::from([("solve".to_string(), 5.0), ("output".to_string(), 1.0)]);
        let stages = Stages { advancing: 9.0, recording: 0.5, stepping: 8.0, told };
        let table = stages.table();
        assert_eq!((table["solve"], table["output"], table["coupling"], table["other"]), (5.0, 1.5, 1.0, 2.0));
        assert_eq!(table.values().sum::<f64>(), 9.5);
    }
}
