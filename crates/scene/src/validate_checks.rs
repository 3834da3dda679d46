//! The ranges of the figures that a scene asks of its own result.

use crate::validate::Checker;
use crate::{Check, Error, QuickCheck};

/// Checks the figures that a scene or case asks for; `name` is used in messages.
///
/// # Errors
/// A number out of its range, or a name that two of them have.
pub fn validate_checks(checks: &[Check], name: &str) -> Result<(), Error> {
    checks.iter().enumerate().try_for_each(|(index, figure)| figure.validate(name, index))?;
    Checker { name }.unique("check", checks.iter().map(|check| check.name.as_str()).enumerate())
}

impl QuickCheck {
    fn validate(&self, check: &Checker, key: &str) -> Result<(), Error> {
        for (name, value) in [("reference", self.reference), ("from", self.from), ("to", self.to)] {
            check.finite_if(&format!("{key}.{name}"), value)?;
        }
        check.within(&format!("{key}.limit"), self.limit.unwrap_or(0.0), 0.0, f64::MAX)
    }
}

impl Check {
    /// Checks every number of the check with this index; `name` is used in messages.
    pub fn validate(&self, name: &str, index: usize) -> Result<(), Error> {
        let check = Checker { name };
        let key = |field: &str| format!("check[{index}].{field}");
        check.finite_if(&key("from"), self.from)?;
        check.finite_if(&key("to"), self.to)?;
        if let (Some(from), Some(to)) = (self.from, self.to)
            && to < from
        {
            check.fail(&key("to"), to, &format!("at least {from}, where the window starts"))?;
        }
        check.finite_if(&key("scale"), self.scale)?;
        check.finite_if(&key("offset"), self.offset)?;
        check.positive(&key("time_scale"), self.time_scale)?;
        check.finite_if(&key("reference"), self.reference)?;
        check.within(&key("limit"), self.limit.unwrap_or(0.0), 0.0, f64::MAX)?;
        check.points(&key("points"), &self.points, 0)?;
        check.positive(&key("window"), self.window.unwrap_or(1.0))?;
        check.finite_if(&key("level"), self.level)?;
        check.finite_if(&key("rest"), self.rest)?;
        self.quick.as_ref().map_or(Ok(()), |quick| quick.validate(&check, &key("quick")))?;
        check.positive(&key("depth"), self.depth.unwrap_or(1.0))
    }
}
