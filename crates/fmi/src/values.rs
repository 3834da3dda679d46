//! Getting and setting variables by reference.

use crate::{Access, Causality, Component, Failure, Instance, Mode, Reference, Variable};

impl<C: Component> Instance<C> {
    /// Numbers of these variables.
    pub fn get_real(&mut self, references: &[Reference], values: &mut [f64]) -> Result<(), Failure> {
        self.refresh()?;
        for (&reference, value) in references.iter().zip(values) {
            let variable = self.find(reference, "real", |access| matches!(access, Access::Real { .. }))?;
            if let Access::Real { get, .. } = variable.access {
                *value = get(&self.component, variable.index);
            }
        }
        Ok(())
    }

    /// Whole numbers of these variables.
    pub fn get_integer(&mut self, references: &[Reference], values: &mut [i32]) -> Result<(), Failure> {
        self.refresh()?;
        for (&reference, value) in references.iter().zip(values) {
            let variable = self.find(reference, "integer", |access| matches!(access, Access::Integer { .. }))?;
            if let Access::Integer { get, .. } = variable.access {
                *value = get(&self.component, variable.index);
            }
        }
        Ok(())
    }

    /// Texts of these variables.
    pub fn get_string(&mut self, references: &[Reference]) -> Result<Vec<String>, Failure> {
        self.refresh()?;
        let mut texts = Vec::with_capacity(references.len());
        for &reference in references {
            let variable = self.find(reference, "string", |access| matches!(access, Access::Text { .. }))?;
            if let Access::Text { get, .. } = variable.access {
                texts.push(get(&self.component, variable.index));
            }
        }
        Ok(texts)
    }

    /// Sets numbers. A value that is not a finite number breaks the instance; one out of range is discarded.
    pub fn set_real(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Failure> {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.find(reference, "real", |access| matches!(access, Access::Real { .. }))?;
            let Access::Real { set, minimum, maximum, .. } = variable.access else { continue };
            let set = self.settable(variable, set)?;
            if !value.is_finite() {
                let failure = Failure::broken(format!("{} = {value}: expected a finite number", variable.name));
                return self.note(Err(failure));
            }
            let (low, high) = (minimum.unwrap_or(f64::NEG_INFINITY), maximum.unwrap_or(f64::INFINITY));
            if value < low || value > high {
                return Err(out_of_range(&variable.name, value, low, high));
            }
            let (index, parameter) = (variable.index, variable.causality == Causality::Parameter);
            set(&mut self.component, index, value);
            self.stale |= parameter;
        }
        Ok(())
    }

    /// Sets whole numbers. A value out of range is discarded.
    pub fn set_integer(&mut self, references: &[Reference], values: &[i32]) -> Result<(), Failure> {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.find(reference, "integer", |access| matches!(access, Access::Integer { .. }))?;
            let Access::Integer { set, minimum, maximum, .. } = variable.access else { continue };
            let set = self.settable(variable, set)?;
            let (low, high) = (minimum.unwrap_or(i32::MIN), maximum.unwrap_or(i32::MAX));
            if value < low || value > high {
                return Err(out_of_range(&variable.name, value, low, high));
            }
            let index = variable.index;
            set(&mut self.component, index, value);
            self.stale = true;
        }
        Ok(())
    }

    /// Sets texts.
    pub fn set_string(&mut self, references: &[Reference], values: &[&str]) -> Result<(), Failure> {
        for (&reference, value) in references.iter().zip(values) {
            let variable = self.find(reference, "string", |access| matches!(access, Access::Text { .. }))?;
            let Access::Text { set, .. } = variable.access else { continue };
            let set = self.settable(variable, set)?;
            let index = variable.index;
            set(&mut self.component, index, value);
            self.stale = true;
        }
        Ok(())
    }

    /// d unknown(t + H) / d known . seed, the known ones held over the last step.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seed: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        self.refresh()?;
        if !self.model.directional_derivatives {
            return Err(Failure::refused("directional derivatives are not provided by this model"));
        }
        let is_real = |access: &Access<C>| matches!(access, Access::Real { .. });
        for (references, causality) in [(unknowns, Causality::Output), (knowns, Causality::Input)] {
            for &reference in references {
                let variable = self.find(reference, "real", is_real)?;
                if variable.causality != causality {
                    let name = &variable.name;
                    let message = format!("directional derivative: {name} is no {causality:?}").to_lowercase();
                    return Err(Failure::refused(message));
                }
            }
        }
        let matrix = self.component.derivatives(unknowns, knowns)?;
        let columns = knowns.len();
        let row = |i: usize| matrix[i * columns..(i + 1) * columns].iter().zip(seed).map(|(a, b)| a * b).sum();
        Ok((0..unknowns.len()).map(row).collect())
    }

    fn find(&self, reference: Reference, kind: &str, fits: fn(&Access<C>) -> bool) -> Result<&Variable<C>, Failure> {
        self.model
            .variables
            .iter()
            .find(|variable| variable.reference == reference && fits(&variable.access))
            .ok_or_else(|| Failure::refused(format!("no {kind} variable has the value reference {reference}")))
    }

    /// The setter, when the variable may be set in this mode. Inputs are taken in every mode that allows setting: two
    /// importers set them right after instantiation.
    fn settable<F>(&self, variable: &Variable<C>, set: Option<F>) -> Result<F, Failure> {
        let name = &variable.name;
        match (variable.causality, set) {
            (Causality::Input, Some(set)) => Ok(set),
            (Causality::Parameter, Some(set)) if matches!(self.mode, Mode::Instantiated | Mode::Initialization) => {
                Ok(set)
            }
            (Causality::Parameter, Some(_)) => {
                Err(Failure::refused(format!("{name} is a fixed parameter: set it before the initialisation ends")))
            }
            _ => Err(Failure::refused(format!("{name} is an output and cannot be set"))),
        }
    }
}

fn out_of_range(
    name: &str,
    value: impl std::fmt::Display,
    low: impl std::fmt::Display,
    high: impl std::fmt::Display,
) -> Failure {
    Failure::discard(format!("{name} = {value}: expected a value from {low} to {high}; the old one is kept"))
}
