//! One row of the table of variables. The table yields XML, getters, setters and documentation: a row is all that a variable
//! needs.
//!
//! ```
//! use fmi::{Access, Variable};
//! struct Tank {
//!     level: f64,
//! }
//! let row = Variable::real(42, "level", "height of the water", "Length", |tank: &Tank, _| tank.level);
//! let Access::Real { get, .. } = row.access else { panic!("a number") };
//! assert_eq!(get(&Tank { level: 0.3 }, row.index), 0.3);
//! ```

use crate::Reference;

/// Role of a variable (FMI 2.0.5, section 2.2.7; the same in 3.0).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set before the run.
    Parameter,
    /// Set at communication points.
    Input,
    /// Read at communication points.
    Output,
}

/// When a variable may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variability {
    /// Not after initialisation.
    Fixed,
    /// At communication points only.
    Discrete,
    /// At any time.
    Continuous,
}

/// How a variable gets its first value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// From its start value.
    Exact,
    /// Computed from other variables.
    Calculated,
}

/// Type, start value and access functions. The second argument of the functions is the variable's `index`, so that
/// the elements of an array share one function.
#[allow(missing_docs, reason = "the fields are the same in every member and named after the standard's attributes")]
pub enum Access<C> {
    /// A number.
    Real {
        get: fn(&C, usize) -> f64,
        set: Option<fn(&mut C, usize, f64)>,
        start: Option<f64>,
        minimum: Option<f64>,
        maximum: Option<f64>,
        nominal: Option<f64>,
        /// Name of one of the model's simple types; it brings quantity and unit.
        simple_type: Option<&'static str>,
    },
    /// A whole number.
    Integer {
        get: fn(&C, usize) -> i32,
        set: Option<fn(&mut C, usize, i32)>,
        start: Option<i32>,
        minimum: Option<i32>,
        maximum: Option<i32>,
    },
    /// A text.
    Text { get: fn(&C, usize) -> String, set: Option<fn(&mut C, usize, &str)>, start: Option<&'static str> },
}

/// One variable of a model `C`.
pub struct Variable<C> {
    /// Value reference, unique in the model.
    pub reference: Reference,
    /// Name by the structured naming convention.
    pub name: String,
    /// Meaning, in one sentence.
    pub description: String,
    /// Role.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Passed to the access functions.
    pub index: usize,
    /// Inputs on which an output depends at the same communication point, by reference; empty for an output of the
    /// state alone.
    pub dependencies: Vec<Reference>,
    /// Type and access.
    pub access: Access<C>,
}

impl<C> Variable<C> {
    fn new(reference: Reference, name: impl Into<String>, description: impl Into<String>, access: Access<C>) -> Self {
        let variability =
            if matches!(access, Access::Real { .. }) { Variability::Continuous } else { Variability::Discrete };
        Self {
            reference,
            name: name.into(),
            description: description.into(),
            causality: Causality::Output,
            variability,
            index: 0,
            dependencies: Vec::new(),
            access,
        }
    }

    /// A real output.
    pub fn real(
        reference: Reference,
        name: impl Into<String>,
        description: impl Into<String>,
        simple_type: &'static str,
        get: fn(&C, usize) -> f64,
    ) -> Self {
        let access = Access::Real {
            get,
            set: None,
            start: None,
            minimum: None,
            maximum: None,
            nominal: None,
            simple_type: (!simple_type.is_empty()).then_some(simple_type),
        };
        Self::new(reference, name, description, access)
    }

    /// An integer output.
    pub fn integer(
        reference: Reference,
        name: impl Into<String>,
        description: impl Into<String>,
        get: fn(&C, usize) -> i32,
    ) -> Self {
        Self::new(
            reference,
            name,
            description,
            Access::Integer { get, set: None, start: None, minimum: None, maximum: None },
        )
    }

    /// A string parameter, set before the run.
    pub fn text_parameter(
        reference: Reference,
        name: impl Into<String>,
        description: impl Into<String>,
        start: &'static str,
        get: fn(&C, usize) -> String,
        set: fn(&mut C, usize, &str),
    ) -> Self {
        let access = Access::Text { get, set: Some(set), start: Some(start) };
        Self::new(reference, name, description, access).into_parameter()
    }

    fn into_parameter(mut self) -> Self {
        self.causality = Causality::Parameter;
        self.variability = Variability::Fixed;
        self
    }

    /// Turns a real variable into an input that starts at 0.
    pub fn input(mut self, setter: fn(&mut C, usize, f64)) -> Self {
        self.causality = Causality::Input;
        if let Access::Real { set, start, .. } = &mut self.access {
            *set = Some(setter);
            *start = Some(0.0);
        }
        self
    }

    /// Turns a real variable into a parameter.
    pub fn real_parameter(mut self, value: f64, setter: fn(&mut C, usize, f64)) -> Self {
        if let Access::Real { set, start, .. } = &mut self.access {
            *set = Some(setter);
            *start = Some(value);
        }
        self.into_parameter()
    }

    /// Turns an integer variable into a parameter.
    pub fn integer_parameter(mut self, value: i32, setter: fn(&mut C, usize, i32)) -> Self {
        if let Access::Integer { set, start, .. } = &mut self.access {
            *set = Some(setter);
            *start = Some(value);
        }
        self.into_parameter()
    }

    /// Sets the index passed to the access functions.
    pub fn at(mut self, index: usize) -> Self {
        self.index = index;
        self
    }

    /// Limits a variable of either number type; the limits belong to the range.
    pub fn within(mut self, least: f64, greatest: f64) -> Self {
        match &mut self.access {
            Access::Real { minimum, maximum, .. } => {
                *minimum = least.is_finite().then_some(least);
                *maximum = greatest.is_finite().then_some(greatest);
            }
            Access::Integer { minimum, maximum, .. } => {
                *minimum = least.is_finite().then_some(least as i32);
                *maximum = greatest.is_finite().then_some(greatest as i32);
            }
            Access::Text { .. } => {}
        }
        self
    }

    /// Gives the typical size of a real variable, for tolerances of importers.
    pub fn nominal(mut self, size: f64) -> Self {
        if let Access::Real { nominal, .. } = &mut self.access {
            *nominal = Some(size);
        }
        self
    }

    /// Says that a real variable changes at communication points only.
    pub fn discrete(mut self) -> Self {
        self.variability = Variability::Discrete;
        self
    }

    /// The attribute `initial`; none on inputs, as the standard wants.
    pub fn initial(&self) -> Option<Initial> {
        match self.causality {
            Causality::Parameter => Some(Initial::Exact),
            Causality::Input => None,
            Causality::Output => Some(Initial::Calculated),
        }
    }
}
