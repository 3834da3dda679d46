//! A toy model.

use fmi::{Component, DefaultExperiment, Experiment, Failure, Logger, Model, Reference, Setup, Unit, Variable};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Integrates its input: dx/dt = gain u. Panics at u = 666, discards at u = 13, fails at u = 14.
pub struct Toy {
    pub state: ToyState,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToyState {
    gain: f64,
    order: i32,
    name: String,
    input: f64,
    output: f64,
}

impl Component for Toy {
    type State = ToyState;

    type Interface = usize;

    /// One output more than the resources' folder has in its name.
    fn interface(resources: Option<&Path>) -> Result<usize, Failure> {
        let name = resources.and_then(Path::file_name).map_or("1".into(), |name| name.to_string_lossy());
        name.parse().map_err(|_| Failure::refused(format!("resources '{name}': expected a number")))
    }

    fn model(&outputs: &usize) -> Model<Self> {
        let mut variables = vec![
            Variable::real(1, "gain", "factor, <1 & >0", "", |this: &Self, _| this.state.gain)
                .real_parameter(2.0, |this, _, value| this.state.gain = value)
                .within(0.0, 10.0),
            Variable::integer(1, "order", "a number", |this: &Self, _| this.state.order)
                .integer_parameter(1, |this, _, value| this.state.order = value)
                .within(0.0, 3.0),
            Variable::text_parameter(
                1,
                "name",
                "a text",
                "toy",
                |this: &Self, _| this.state.name.clone(),
                |this, _, text| this.state.name = text.to_string(),
            ),
            Variable::real(2, "u", "input", "", |this: &Self, _| this.state.input)
                .input(|this, _, value| this.state.input = value),
        ];
        for index in 0..=outputs {
            let reference = 10 + index as Reference;
            variables.push(Variable::real(reference, format!("x[{index}]"), "output", "", |this, _| this.state.output));
        }
        Model {
            identifier: "toy",
            name: "Toy",
            description: "integrator",
            units: vec![Unit { name: "m", exponents: Some([0, 1, 0, 0]) }],
            types: Vec::new(),
            variables,
            experiment: DefaultExperiment { stop: 1.0, step: 0.1 },
            directional_derivatives: false,
            annotations: Vec::new(),
        }
    }

    fn new(_setup: &Setup<usize>) -> Self {
        Self { state: ToyState { gain: 0.0, order: 0, name: String::new(), input: 0.0, output: -1.0 } }
    }

    fn initialise(&mut self, _experiment: &Experiment, log: &Logger) -> Result<(), Failure> {
        if self.state.name == "bad" {
            return Err(Failure::refused("name = 'bad': expected another"));
        }
        self.state.output = self.state.gain * 100.0;
        log.event("ready at 100 %");
        Ok(())
    }

    fn do_step(&mut self, time: f64, step: f64, _log: &Logger) -> Result<(), Failure> {
        match self.state.input {
            666.0 => panic!("the toy broke at {time}"),
            13.0 => Err(Failure::discard("u = 13 needs a shorter step")),
            14.0 => Err(Failure::broken("u = 14 cannot be done")),
            input => {
                self.state.output += step * self.state.gain * input;
                Ok(())
            }
        }
    }

    fn terminate(&mut self, _log: &Logger) -> Result<(), Failure> {
        Ok(())
    }

    fn save(&self) -> ToyState {
        self.state.clone()
    }

    fn restore(&mut self, state: &ToyState) -> Result<(), Failure> {
        self.state = state.clone();
        Ok(())
    }

    fn derivatives(&mut self, _unknowns: &[Reference], _knowns: &[Reference]) -> Result<Vec<f64>, Failure> {
        Err(Failure::refused("none"))
    }
}
