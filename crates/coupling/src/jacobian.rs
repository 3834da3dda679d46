//! Derivative of the iterated quantities by themselves, through one pass.

use crate::system::{Node, Source};
use crate::{Error, System};
use nalgebra::DMatrix;

impl System {
    /// dQ~/dQ of the last pass: each iterated quantity is varied, and the variation goes through the participants in
    /// their order by their directional derivatives. `time` \[s\] is for messages.
    pub fn jacobian(&mut self, time: f64) -> Result<DMatrix<f64>, Error> {
        let size = self.iterated.len();
        let mut jacobian = DMatrix::zeros(size, size);
        for column in 0..size {
            let mut variations: Vec<Vec<f64>> = Vec::with_capacity(self.nodes.len());
            for node in &mut self.nodes {
                let seed: Vec<f64> = node
                    .sources
                    .iter()
                    .map(|source| match source {
                        Source::Fresh(other, place) => variations[*other][*place],
                        Source::Iterated(quantity) => f64::from(u8::from(*quantity == column)),
                    })
                    .collect();
                variations.push(node.vary(&seed, time)?);
            }
            for (row, (node, place)) in self.iterated.iter().enumerate() {
                jacobian[(row, column)] = variations[*node][*place];
            }
        }
        Ok(jacobian)
    }
}

impl Node {
    /// Change of the connected outputs for a change of the connected inputs.
    fn vary(&mut self, seed: &[f64], time: f64) -> Result<Vec<f64>, Error> {
        let mut change = vec![0.0; self.outputs.len()];
        if !self.outputs.is_empty() && seed.iter().any(|value| *value != 0.0) {
            self.participant.directional_derivative(&self.outputs, &self.inputs, seed, &mut change)?;
        }
        if let Some((value, name)) = change.iter().zip(&self.names).find(|(value, _)| !value.is_finite()) {
            let (participant, variable) = (self.participant.name().to_string(), format!("derivative of {name}"));
            return Err(Error::NotFinite { participant, variable, value: *value, time });
        }
        Ok(change)
    }
}
