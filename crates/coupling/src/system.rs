//! Participants and the connections between them.

use crate::Error;
use crate::participant::{Causality, Description, Kind, Outcome, Participant, Variable};
use std::time::Instant;

/// State slot that holds the start of the step.
const START_OF_STEP: usize = 0;

/// A connection from an output to an input, by names.
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// Source participant and variable.
    pub from: (String, String),
    /// Destination participant and variable.
    pub to: (String, String),
}

/// How a pass through all participants ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Pass {
    /// All stepped.
    Done,
    /// One refused the step.
    Refused {
        /// Name of the participant.
        participant: String,
        /// What it said.
        reason: String,
    },
}

pub(crate) enum Source {
    /// An output of an earlier participant in this pass: node and place among its connected outputs.
    Fresh(usize, usize),
    /// An iterated quantity.
    Iterated(usize),
}

pub(crate) struct Node {
    pub(crate) participant: Box<dyn Participant>,
    pub(crate) inputs: Vec<u32>,
    pub(crate) sources: Vec<Source>,
    staged: Vec<f64>,
    pub(crate) outputs: Vec<u32>,
    pub(crate) names: Vec<String>,
    values: Vec<f64>,
    /// Wall-clock time spent in steps \[s\].
    seconds: f64,
}

/// Participants in the order in which they step, with their connections.
pub struct System {
    pub(crate) nodes: Vec<Node>,
    /// Node and place among its connected outputs, for every iterated quantity.
    pub(crate) iterated: Vec<(usize, usize)>,
}

impl System {
    /// Connects participants; they step in the order given.
    pub fn new(participants: Vec<Box<dyn Participant>>, connections: &[Connection]) -> Result<Self, Error> {
        let nodes = participants.into_iter().map(Node::new).collect();
        let mut system = Self { nodes, iterated: Vec::new() };
        for connection in connections {
            system.connect(connection)?;
        }
        Ok(system)
    }

    /// Makes one more connection.
    pub fn connect(&mut self, connection: &Connection) -> Result<(), Error> {
        let (from, to) = (&connection.from, &connection.to);
        let (source, target) = (self.find(connection, &from.0)?, self.find(connection, &to.0)?);
        let output = self.variable(source, connection, &from.1, Causality::Output)?;
        let input = self.variable(target, connection, &to.1, Causality::Input)?;
        // A participant that says no unit is taken at its word.
        if output.unit != input.unit && !output.unit.is_empty() && !input.unit.is_empty() {
            let reason = format!("the units differ: '{}' and '{}'", output.unit, input.unit);
            return Err(refusal(connection, reason));
        }
        if self.nodes[target].inputs.contains(&input.reference) {
            return Err(refusal(connection, "the input has a connection already".to_string()));
        }
        let place = self.nodes[source].output_place(&output);
        let link = if source < target { Source::Fresh(source, place) } else { self.iterate(source, place) };
        let node = &mut self.nodes[target];
        node.inputs.push(input.reference);
        node.staged.push(0.0);
        node.sources.push(link);
        Ok(())
    }

    fn iterate(&mut self, node: usize, place: usize) -> Source {
        let known = self.iterated.iter().position(|quantity| *quantity == (node, place));
        Source::Iterated(known.unwrap_or_else(|| {
            self.iterated.push((node, place));
            self.iterated.len() - 1
        }))
    }

    fn find(&self, connection: &Connection, name: &str) -> Result<usize, Error> {
        let names = || self.nodes.iter().map(|node| node.participant.name());
        names().position(|known| known == name).ok_or_else(|| {
            let known = names().collect::<Vec<_>>().join(", ");
            refusal(connection, format!("there is no participant '{name}'; known: {known}"))
        })
    }

    fn variable(&self, node: usize, connection: &Connection, name: &str, role: Causality) -> Result<Variable, Error> {
        let participant = &self.nodes[node].participant;
        let variable = participant.description().variable(participant.name(), name)?;
        if variable.kind != Kind::Real || variable.causality != role {
            let is = format!("of role '{}' and takes {}", variable.causality.name(), variable.kind.words());
            let reason = format!("'{name}' is {is}, expected the role '{}' and a number", role.name());
            return Err(refusal(connection, reason));
        }
        Ok(variable.clone())
    }

    /// Names of the iterated quantities, `participant.variable`.
    pub fn iterated_names(&self) -> Vec<String> {
        let name = |(node, place): &(usize, usize)| {
            let node = &self.nodes[*node];
            format!("{}.{}", node.participant.name(), node.names[*place])
        };
        self.iterated.iter().map(name).collect()
    }

    /// Values of the iterated quantities as the last pass gave them.
    pub fn produced(&self) -> Vec<f64> {
        self.iterated.iter().map(|(node, place)| self.nodes[*node].values[*place]).collect()
    }

    /// A real variable of a participant at `time` \[s\], both by name.
    pub fn read(&mut self, participant: &str, variable: &str, time: f64) -> Result<f64, Error> {
        let unknown = || crate::participant::Error::UnknownVariable {
            participant: participant.to_string(),
            variable: variable.to_string(),
            hint: "; no participant has that name".to_string(),
        };
        let found = self.nodes.iter_mut().find(|node| node.participant.name() == participant).ok_or_else(unknown)?;
        let variable = found.participant.description().variable(participant, variable)?.clone();
        let mut value = [0.0];
        found.participant.get_reals(&[variable.reference], &mut value)?;
        if value[0].is_finite() {
            return Ok(value[0]);
        }
        let (participant, variable) = (participant.to_string(), variable.name);
        Err(Error::NotFinite { participant, variable, value: value[0], time })
    }

    /// The participants in their order.
    pub fn participants(&mut self) -> impl Iterator<Item = &mut Box<dyn Participant>> {
        self.nodes.iter_mut().map(|node| &mut node.participant)
    }

    /// Descriptions of the participants with their names, in order.
    pub fn descriptions(&self) -> impl Iterator<Item = (&str, &Description)> {
        self.nodes.iter().map(|node| (node.participant.name(), node.participant.description()))
    }

    /// Initialises all participants and passes their start values along the connections.
    pub fn initialise(&mut self, start: f64, stop: f64) -> Result<(), Error> {
        for node in &mut self.nodes {
            node.participant.enter_initialisation(start, stop)?;
            node.read()?;
        }
        // Twice: the second round carries values against the order of the participants.
        for _ in 0..2 {
            for index in 0..self.nodes.len() {
                let iterated = self.produced();
                self.stage(index, &iterated)?;
                self.nodes[index].read()?;
                self.nodes[index].check_finite(start)?;
            }
        }
        for node in &mut self.nodes {
            node.participant.exit_initialisation()?;
        }
        Ok(())
    }

    /// Steps all participants once from `time` by `duration`, with the iterated quantities guessed as `iterated`.
    pub fn pass(&mut self, time: f64, duration: f64, iterated: &[f64]) -> Result<Pass, Error> {
        for index in 0..self.nodes.len() {
            self.stage(index, iterated)?;
            let node = &mut self.nodes[index];
            let start = Instant::now();
            let outcome = node.participant.step(time, duration)?;
            node.seconds += start.elapsed().as_secs_f64();
            if let Outcome::Refused { reason } = outcome {
                return Ok(Pass::Refused { participant: node.participant.name().to_string(), reason });
            }
            node.read()?;
            node.check_finite(time + duration)?;
        }
        Ok(Pass::Done)
    }

    /// Wall-clock time spent in the steps of all participants \[s\].
    pub fn step_seconds(&self) -> f64 {
        self.nodes.iter().map(|node| node.seconds).sum()
    }

    fn stage(&mut self, index: usize, iterated: &[f64]) -> Result<(), Error> {
        let (earlier, rest) = self.nodes.split_at_mut(index);
        let Some(node) = rest.first_mut() else { return Ok(()) };
        for (value, source) in node.staged.iter_mut().zip(&node.sources) {
            *value = match source {
                Source::Fresh(other, place) => earlier[*other].values[*place],
                Source::Iterated(quantity) => iterated[*quantity],
            };
        }
        if !node.inputs.is_empty() {
            node.participant.set_reals(&node.inputs, &node.staged)?;
        }
        Ok(())
    }

    /// Saves the states of all participants.
    pub fn save(&mut self) -> Result<(), Error> {
        self.participants().try_for_each(|participant| participant.save(START_OF_STEP)).map_err(Error::from)
    }

    /// Restores the states of the last [`System::save`].
    pub fn restore(&mut self) -> Result<(), Error> {
        self.participants().try_for_each(|participant| participant.restore(START_OF_STEP)).map_err(Error::from)
    }

    /// Whether all participants can write their states as bytes.
    pub fn serialises(&self) -> bool {
        self.descriptions().all(|(_, description)| description.serialises_states)
    }

    /// The states of all participants as bytes.
    pub fn serialise(&mut self) -> Result<Vec<Vec<u8>>, Error> {
        self.participants().map(|participant| participant.serialise().map_err(Error::from)).collect()
    }

    /// Puts all participants, initialised and in the same order, into states that were serialised.
    pub fn deserialise(&mut self, states: &[Vec<u8>]) -> Result<(), Error> {
        for (node, bytes) in self.nodes.iter_mut().zip(states) {
            node.participant.deserialise(bytes)?;
            node.read()?;
        }
        Ok(())
    }

    /// Frees all saved states and ends the participants; the first failure is reported after all were tried.
    pub fn terminate(&mut self) -> Result<(), Error> {
        let mut first = Ok(());
        for participant in self.participants() {
            let ended = participant.release().and_then(|()| participant.terminate());
            first = first.and(ended);
        }
        first.map_err(Error::from)
    }
}

fn refusal(connection: &Connection, reason: String) -> Error {
    let join = |end: &(String, String)| format!("{}.{}", end.0, end.1);
    Error::Connection { from: join(&connection.from), to: join(&connection.to), reason }
}

impl Node {
    fn new(participant: Box<dyn Participant>) -> Self {
        Self {
            participant,
            inputs: Vec::new(),
            sources: Vec::new(),
            staged: Vec::new(),
            outputs: Vec::new(),
            names: Vec::new(),
            values: Vec::new(),
            seconds: 0.0,
        }
    }

    fn output_place(&mut self, variable: &Variable) -> usize {
        self.outputs.iter().position(|known| *known == variable.reference).unwrap_or_else(|| {
            self.outputs.push(variable.reference);
            self.names.push(variable.name.clone());
            self.values.push(0.0);
            self.outputs.len() - 1
        })
    }

    fn read(&mut self) -> Result<(), Error> {
        if !self.outputs.is_empty() {
            self.participant.get_reals(&self.outputs, &mut self.values)?;
        }
        Ok(())
    }

    fn check_finite(&self, time: f64) -> Result<(), Error> {
        match self.values.iter().zip(&self.names).find(|(value, _)| !value.is_finite()) {
            None => Ok(()),
            Some((value, name)) => Err(Error::NotFinite {
                participant: self.participant.name().to_string(),
                variable: name.clone(),
                value: *value,
                time,
            }),
        }
    }
}
