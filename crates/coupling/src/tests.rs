//! The implicit step on small participants with known answers.

use crate::participant::{self, Causality, Description, Kind, Outcome, Participant, Value, Variable};
use crate::{Connection, Error, IterationRow, Parameters, StepReport, Stepper, System};
use scene::{Coupling, Method};

type Rule = Box<dyn Fn(&mut Vec<f64>, &[f64], f64) -> Result<Vec<f64>, String>>;

/// A participant made of one function: (state, inputs, duration) -> outputs. Inputs have the references 0.., outputs
/// 100.. .
struct Toy {
    name: String,
    description: Description,
    state: Vec<f64>,
    saved: Option<Vec<f64>>,
    inputs: Vec<f64>,
    outputs: Vec<f64>,
    /// What every directional derivative is.
    sensitivity: f64,
    rule: Rule,
}

impl Toy {
    fn boxed(name: &str, inputs: &[&str], outputs: &[&str], state: Vec<f64>, rule: Rule) -> Box<dyn Participant> {
        Box::new(Self::new(name, inputs, outputs, state, rule))
    }

    fn new(name: &str, inputs: &[&str], outputs: &[&str], state: Vec<f64>, rule: Rule) -> Self {
        let variable = |causality, first: u32| {
            move |(i, name): (usize, &&str)| Variable {
                name: (*name).to_string(),
                reference: first + i as u32,
                kind: Kind::Real,
                causality,
                unit: String::new(),
                description: String::new(),
                range: crate::participant::UNLIMITED,
            }
        };
        let ins = inputs.iter().enumerate().map(variable(Causality::Input, 0));
        let variables = ins.chain(outputs.iter().enumerate().map(variable(Causality::Output, 100))).collect();
        Self {
            name: name.to_string(),
            description: Description {
                variables,
                saves_states: true,
                serialises_states: true,
                variable_step: true,
                derivatives: false,
            },
            state,
            saved: None,
            inputs: vec![0.0; inputs.len()],
            outputs: vec![0.0; outputs.len()],
            sensitivity: 0.0,
            rule,
        }
    }
}

impl Participant for Toy {
    fn name(&self) -> &str {
        &self.name
    }
    fn description(&self) -> &Description {
        &self.description
    }
    fn set(&mut self, _: &Variable, _: &Value) -> Result<(), participant::Error> {
        Ok(())
    }
    fn get(&mut self, variable: &Variable) -> Result<Value, participant::Error> {
        Ok(Value::Real(self.outputs[variable.reference as usize - 100]))
    }
    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), participant::Error> {
        references.iter().zip(values).for_each(|(reference, value)| self.inputs[*reference as usize] = *value);
        Ok(())
    }
    fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), participant::Error> {
        let outputs = &self.outputs;
        references.iter().zip(values).for_each(|(reference, value)| *value = outputs[*reference as usize - 100]);
        Ok(())
    }
    fn enter_initialisation(&mut self, _: f64, _: f64) -> Result<(), participant::Error> {
        Ok(())
    }
    fn exit_initialisation(&mut self) -> Result<(), participant::Error> {
        Ok(())
    }
    fn step(&mut self, _: f64, duration: f64) -> Result<Outcome, participant::Error> {
        Ok(match (self.rule)(&mut self.state, &self.inputs, duration) {
            Ok(outputs) => {
                self.outputs = outputs;
                Outcome::Done
            }
            Err(reason) => Outcome::Refused { reason },
        })
    }
    fn save(&mut self, _: usize) -> Result<(), participant::Error> {
        self.saved = Some(self.state.clone());
        Ok(())
    }
    fn restore(&mut self, _: usize) -> Result<(), participant::Error> {
        self.state = self.saved.clone().expect("saved before");
        Ok(())
    }
    fn serialise(&mut self) -> Result<Vec<u8>, participant::Error> {
        Ok(self.state.iter().chain(&self.outputs).flat_map(|value| value.to_le_bytes()).collect())
    }
    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), participant::Error> {
        let values: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let (state, outputs) = values.split_at(self.state.len());
        (self.state, self.outputs) = (state.to_vec(), outputs.to_vec());
        Ok(())
    }
    fn release(&mut self) -> Result<(), participant::Error> {
        self.saved = None;
        Ok(())
    }
    fn directional_derivative(
        &mut self,
        _: &[u32],
        _: &[u32],
        _: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), participant::Error> {
        sensitivity.fill(self.sensitivity);
        Ok(())
    }
    fn terminate(&mut self) -> Result<(), participant::Error> {
        Ok(())
    }
}

/// Three masses on springs (unit mass, stiffness 100, Newmark with a held load): outputs the velocities.
fn springs(limit: f64) -> Box<dyn Participant> {
    let rule: Rule = Box::new(move |state, load, h| {
        if h > limit {
            return Err(format!("step {h} is above {limit}"));
        }
        for i in 0..3 {
            let (x, v) = (state[i], state[3 + i]);
            let a = load[i] - 100.0 * x;
            let next = (load[i] - 100.0 * (x + h * v + 0.25 * h * h * a)) / (1.0 + 25.0 * h * h);
            state[i] = x + h * v + 0.25 * h * h * (a + next);
            state[3 + i] = v + 0.5 * h * (a + next);
        }
        Ok(state[3..6].to_vec())
    });
    let state = vec![0.01, -0.02, 0.005, 0.0, 0.0, 0.0];
    Toy::boxed("springs", &["q1", "q2", "q3"], &["v1", "v2", "v3"], state, rule)
}

/// Water that answers the mean acceleration of a step with -A a; A has the largest eigenvalue `ratio`.
fn water(ratio: f64) -> Box<dyn Participant> {
    Box::new(water_toy(ratio))
}

fn water_toy(ratio: f64) -> Toy {
    let rule: Rule = Box::new(move |state, velocity, h| {
        let a: Vec<f64> = velocity.iter().zip(state.iter()).map(|(new, old)| (new - old) / h).collect();
        *state = velocity.to_vec();
        // Eigenvalues of [[4, 2, 0], [2, 4, 2], [0, 2, 4]] are 4 and 4 +- 2 sqrt(2); the largest is 6.828427.
        let scale = ratio / 6.828_427_124_746_19;
        let rows = [[4.0, 2.0, 0.0], [2.0, 4.0, 2.0], [0.0, 2.0, 4.0]];
        Ok(rows.iter().map(|row| -scale * row.iter().zip(&a).map(|(r, a)| r * a).sum::<f64>()).collect())
    });
    Toy::new("water", &["v1", "v2", "v3"], &["q1", "q2", "q3"], vec![0.0; 3], rule)
}

fn connect(participants: Vec<Box<dyn Participant>>) -> System {
    let link = |from: &str, to: &str, name: String| Connection {
        from: (from.to_string(), name.clone()),
        to: (to.to_string(), name),
    };
    let forward = (1..=3).map(|i| link("springs", "water", format!("v{i}")));
    let backward = (1..=3).map(|i| link("water", "springs", format!("q{i}")));
    let mut system = System::new(participants, &forward.chain(backward).collect::<Vec<_>>()).unwrap();
    system.initialise(0.0, 1.0).unwrap();
    system
}

fn parameters(method: Method, relaxation: f64) -> Parameters {
    let coupling = Coupling {
        added_mass: false,
        method,
        relaxation,
        tolerance_relative: 1e-8,
        tolerance_absolute: 1e-10,
        maximum_iterations: 100,
        smallest_step: 0.001,
        predictor_order: Some(0),
        reused_steps: 0,
    };
    Parameters { coupling, start: 0.0, end: 0.2, step: 0.01, tolerances: Vec::new() }
}

fn run(parameters: &Parameters, system: &mut System) -> Result<Vec<StepReport>, Error> {
    let mut stepper = Stepper::new(parameters, system)?;
    let mut reports = Vec::new();
    while !stepper.clock().finished() {
        reports.push(stepper.advance(system, &mut |_: &IterationRow| ())?);
    }
    Ok(reports)
}

fn most_iterations(method: Method, relaxation: f64, ratio: f64) -> Result<usize, Error> {
    let reports = run(&parameters(method, relaxation), &mut connect(vec![springs(1.0), water(ratio)]))?;
    Ok(reports.iter().map(|report| report.iterations).max().unwrap_or(0))
}

#[test]
fn the_fixed_point_diverges_when_the_added_mass_is_larger() {
    // The error factor of a fixed-point pass is the mass ratio: 1e-8 takes about 8 passes at 0.1, none suffice at 10.
    let few = most_iterations(Method::Constant, 1.0, 0.1).unwrap();
    assert!((7..=11).contains(&few), "{few}");
    let refused = most_iterations(Method::Constant, 1.0, 10.0).unwrap_err();
    let Error::NotConverged { time, duration, iterations, residuals } = &refused else { panic!("{refused}") };
    // 0.01 s halved three times is the last step above the floor of 0.001 s.
    assert_eq!((*time, *duration, *iterations, residuals.len()), (0.0, 0.00125, 100, 3));
    let text = refused.to_string();
    assert!(text.contains("t = 0 s") && text.contains("water.q1 residual"), "{text}");
}

#[test]
fn aitken_converges_for_every_mass_ratio() {
    let counts: Vec<usize> = [0.1, 1.0, 10.0].map(|ratio| most_iterations(Method::Aitken, 0.1, ratio).unwrap()).into();
    assert!(counts.iter().all(|count| *count <= 90), "{counts:?}");
    assert!(counts[2] > 10, "three modes at ratio 10 are hard for one factor: {counts:?}");
}

#[test]
fn quasi_newton_takes_unknowns_plus_two_passes() {
    // A linear problem with three unknowns: one relaxed pass, three columns, one confirmation.
    for ratio in [0.1, 1.0, 10.0] {
        assert!(most_iterations(Method::IqnIls, 0.1, ratio).unwrap() <= 6, "ratio {ratio}");
    }
}

#[test]
fn the_coupled_motion_is_that_of_the_heavier_masses() {
    // Along the eigenvector (1, sqrt 2, 1) of A the added mass is the ratio: omega = sqrt(100 / (1 + ratio)).
    let mut system = connect(vec![springs(1.0), water(3.0)]);
    let parameters = Parameters { end: 0.5, step: 0.001, ..parameters(Method::IqnIls, 0.1) };
    run(&parameters, &mut system).unwrap();
    let velocities: Vec<f64> = system
        .participants()
        .map(|p| {
            let mut values = [0.0; 3];
            if p.name() == "springs" {
                p.get_reals(&[100, 101, 102], &mut values).unwrap();
            }
            0.5 * (values[0] + std::f64::consts::SQRT_2 * values[1] + values[2])
        })
        .collect();
    let start = 0.5 * (0.01 - 0.02 * std::f64::consts::SQRT_2 + 0.005);
    let omega = (100.0_f64 / 4.0).sqrt();
    let exact = -start * omega * (omega * 0.5).sin();
    assert!((velocities[0] - exact).abs() < 1e-5 * exact.abs(), "{} {exact}", velocities[0]);
}

#[test]
fn a_refused_step_is_halved_and_grows_back() {
    let mut system = connect(vec![springs(0.006), water(0.5)]);
    let reports = run(&parameters(Method::IqnIls, 0.1), &mut system).unwrap();
    assert!(reports.iter().all(|report| report.duration == 0.005));
    assert!(reports[0].rollbacks == 1 && reports.iter().any(|report| report.rollbacks == 1));
    assert_eq!(reports.last().map(|report| report.time + report.duration), Some(0.2));
    let refused = run(&parameters(Method::IqnIls, 0.1), &mut connect(vec![springs(1e-4), water(0.5)])).unwrap_err();
    let text = refused.to_string();
    assert!(text.contains("springs") && text.contains("is above 0.0001"), "{text}");
}

#[test]
fn explicit_makes_one_pass_and_is_stable_for_light_water() {
    let mut system = connect(vec![springs(1.0), water(0.1)]);
    let reports = run(&parameters(Method::Explicit, 1.0), &mut system).unwrap();
    assert!(reports.len() == 20 && reports.iter().all(|report| report.iterations == 1));
}

/// Largest velocity at the end of 0.5 s with water of this mass ratio that saves no states.
fn largest_velocity(method: Method, order: Option<usize>, ratio: f64) -> f64 {
    let mut stateless = water_toy(ratio);
    stateless.description.saves_states = false;
    let mut system = connect(vec![springs(1.0), Box::new(stateless)]);
    let mut parameters = Parameters { end: 0.5, ..parameters(method, 1.0) };
    parameters.coupling.predictor_order = order;
    run(&parameters, &mut system).unwrap();
    let mut velocities = [0.0; 3];
    system.participants().next().unwrap().get_reals(&[100, 101, 102], &mut velocities).unwrap();
    velocities.iter().fold(0.0, |most: f64, velocity| most.max(velocity.abs()))
}

#[test]
fn an_exchange_without_iteration_extrapolates_only_when_asked() {
    // It multiplies errors by the mass ratio r, and with a load that is extrapolated linearly by r + sqrt(r^2 + r): 0.9
    // and 2.2, in 50 steps. The springs swing with 0.2 m/s.
    for method in [Method::Explicit, Method::Auto] {
        let kept = largest_velocity(method, None, 0.9);
        assert!(kept < 0.3, "{method:?}: {kept} m/s");
        assert!(largest_velocity(method, Some(1), 0.9) > 1e3, "{method:?}: it was asked to");
        assert_eq!(kept, largest_velocity(method, Some(0), 0.9), "{method:?}");
    }
}

#[test]
fn not_a_number_stops_with_its_name() {
    let rule: Rule = Box::new(|_, _, _| Ok(vec![0.0, f64::NAN, 0.0]));
    let broken = Toy::boxed("water", &["v1", "v2", "v3"], &["q1", "q2", "q3"], vec![], rule);
    let error = run(&parameters(Method::IqnIls, 0.1), &mut connect(vec![springs(1.0), broken])).unwrap_err();
    assert_eq!(error.to_string(), "water: variable 'q2' is NaN at t = 0.01 s");
}

/// A value that no other participant takes is found when it is read.
#[test]
fn infinity_stops_with_its_name() {
    let rule: Rule = Box::new(|_, _, _| Ok(vec![0.0, f64::NEG_INFINITY, 0.0]));
    let broken = Toy::boxed("water", &["v1", "v2", "v3"], &["q1", "q2", "q3"], vec![], rule);
    let error = run(&parameters(Method::IqnIls, 0.1), &mut connect(vec![springs(1.0), broken])).unwrap_err();
    assert_eq!(error.to_string(), "water: variable 'q2' is -inf at t = 0.01 s");

    let rule: Rule = Box::new(|_, _, _| Ok(vec![1.0, f64::INFINITY]));
    let mut system = System::new(vec![Toy::boxed("gas", &[], &["v", "p"], vec![], rule)], &[]).unwrap();
    system.pass(0.0, 0.01, &[]).unwrap();
    assert_eq!(system.read("gas", "p", 0.01).unwrap_err().to_string(), "gas: variable 'p' is inf at t = 0.01 s");
}

#[test]
fn an_infinite_derivative_stops_with_its_name() {
    let rule: Rule = Box::new(|_, _, _| Ok(vec![0.0; 3]));
    let toy = Toy::new("springs", &["q1", "q2", "q3"], &["v1", "v2", "v3"], vec![], rule);
    let broken = Box::new(Toy { sensitivity: f64::INFINITY, ..toy });
    let error = connect(vec![broken, water(1.0)]).jacobian(0.5).unwrap_err();
    assert_eq!(error.to_string(), "springs: variable 'derivative of v1' is inf at t = 0.5 s");
}

#[test]
fn wrong_connections_are_named() {
    let link = |from: (&str, &str), to: (&str, &str)| Connection {
        from: (from.0.into(), from.1.into()),
        to: (to.0.into(), to.1.into()),
    };
    let attempt = |connection| {
        System::new(vec![springs(1.0), water(1.0)], &[connection]).err().map(|error| error.to_string()).unwrap()
    };
    let unknown = attempt(link(("springs", "v11"), ("water", "v1")));
    assert!(unknown.contains("'v11'") && unknown.contains("did you mean 'v1'"), "{unknown}");
    let participant = attempt(link(("spring", "v1"), ("water", "v1")));
    assert!(participant.contains("known: springs, water"), "{participant}");
    let role = attempt(link(("springs", "q1"), ("water", "v1")));
    assert!(role.contains("expected the role 'output' and a number"), "{role}");
}
