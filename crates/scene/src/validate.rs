//! The ranges of every value of a scene. Geometry that needs more than one part is checked where it is built.

use crate::*;

struct Checker<'a> {
    name: &'a str,
}

impl Checker<'_> {
    fn fail(&self, key: &str, got: impl ToString, expected: &str) -> Result<(), Error> {
        Err(Error::Range {
            name: self.name.to_string(),
            key: key.to_string(),
            got: got.to_string(),
            expected: expected.to_string(),
        })
    }

    fn within(&self, key: &str, value: f64, low: f64, high: f64) -> Result<(), Error> {
        if value.is_finite() && (low..=high).contains(&value) {
            return Ok(());
        }
        self.fail(key, value, &format!("a number from {low} to {high}"))
    }

    fn positive(&self, key: &str, value: f64) -> Result<(), Error> {
        if value.is_finite() && value > 0.0 { Ok(()) } else { self.fail(key, value, "a finite number above 0") }
    }

    fn points(&self, key: &str, points: &[Point], least: usize) -> Result<(), Error> {
        if points.len() < least {
            return self.fail(key, format!("{} points", points.len()), &format!("at least {least} points"));
        }
        match points.iter().find(|p| !p[0].is_finite() || !p[1].is_finite()) {
            Some(point) => self.fail(key, format!("{point:?}"), "finite coordinates"),
            None => Ok(()),
        }
    }
}

impl Scene {
    /// Checks every value against its range; `name` is used in messages.
    pub fn validate(&self, name: &str) -> Result<(), Error> {
        let check = Checker { name };
        check.positive("run.end", self.run.end)?;
        check.positive("run.communication_step", self.run.communication_step)?;
        check.within("run.communication_step", self.run.communication_step, 0.0, self.run.end)?;
        check.points("gravity", &[self.gravity], 1)?;
        check.within("output.interval", self.output.interval, 0.0, f64::MAX)?;
        check.within("output.record_interval", self.output.record_interval, 0.0, f64::MAX)?;
        if self.fluid.is_none() && self.structure.is_none() {
            check.fail("fluid, structure", "none", "at least one of [fluid] and [structure]")?;
        }
        if let Some(fluid) = &self.fluid {
            validate_fluid(&check, fluid)?;
        }
        if let Some(structure) = &self.structure {
            validate_structure(&check, structure)?;
        }
        validate_coupling(&check, &self.coupling)
    }
}

fn validate_fluid(check: &Checker, fluid: &Fluid) -> Result<(), Error> {
    check.positive("fluid.density", fluid.density)?;
    check.positive("fluid.spacing", fluid.spacing)?;
    check.within("fluid.threads", fluid.threads as f64, 0.0, 1024.0)?;
    let paper = &fluid.paper;
    check.within("fluid.paper.influence_radius", paper.influence_radius, 2.1, 4.0)?;
    check.within("fluid.paper.alpha", paper.alpha, 0.0, 1.0)?;
    check.within("fluid.paper.courant", paper.courant, 0.01, 0.5)?;
    check.within("fluid.paper.shifting", paper.shifting, 0.0, 0.5)?;
    check.within("fluid.paper.collision_distance", paper.collision_distance, 0.0, 1.0)?;
    check.within("fluid.paper.restitution", paper.restitution, 0.0, 1.0)?;
    check.within("fluid.paper.surface_deviation", paper.surface_deviation, 0.0, 1.0)?;
    check.within("fluid.solve.tolerance", fluid.solve.tolerance, 0.0, 0.1)?;
    check.within("fluid.solve.maximum_iterations", fluid.solve.maximum_iterations as f64, 1.0, 1e6)?;
    if fluid.water.is_empty() {
        check.fail("fluid.water", "empty", "at least one polygon of water")?;
    }
    for (i, water) in fluid.water.iter().enumerate() {
        check.points(&format!("fluid.water[{i}].polygon"), &water.polygon, 3)?;
    }
    for (i, wall) in fluid.wall.iter().enumerate() {
        check.points(&format!("fluid.wall[{i}].points"), &wall.points, 2)?;
    }
    for (i, region) in fluid.region.iter().enumerate() {
        check.points(&format!("fluid.region[{i}].polygon"), &region.polygon, 3)?;
    }
    for (i, probe) in fluid.probe.iter().enumerate() {
        let key = format!("fluid.probe[{i}]");
        if probe.points().is_empty() {
            check.fail(&key, "no place", "`point`, or `from`, `to` and `count`")?;
        }
        check.points(&key, &probe.points(), 1)?;
    }
    Ok(())
}

fn validate_structure(check: &Checker, structure: &Structure) -> Result<(), Error> {
    check.points("structure.origin", &[structure.origin], 1)?;
    check.within("structure.angle", structure.angle, -10.0, 10.0)?;
    check.within("structure.mass", structure.mass, 0.0, f64::MAX)?;
    check.within("structure.inertia", structure.inertia, 0.0, f64::MAX)?;
    if structure.free.iter().any(|freedom| *freedom != Freedom::Theta) {
        check.positive("structure.mass", structure.mass)?;
    }
    if structure.free.contains(&Freedom::Theta) {
        check.positive("structure.inertia", structure.inertia)?;
    }
    if let Some(rho) = structure.integrator.rho_infinity {
        check.within("structure.integrator.rho_infinity", rho, 0.0, 1.0)?;
    }
    check.within("structure.integrator.beta", structure.integrator.beta, 0.01, 1.0)?;
    check.within("structure.integrator.gamma", structure.integrator.gamma, 0.5, 1.0)?;
    for (i, wall) in structure.wall.iter().enumerate() {
        check.points(&format!("structure.wall[{i}].points"), &wall.points, 2)?;
    }
    if structure.beam.is_none() && structure.wall.is_empty() && structure.free.is_empty() {
        check.fail("structure", "empty", "a beam, a wall or a free degree of freedom")?;
    }
    let Some(beam) = &structure.beam else { return Ok(()) };
    check.points("structure.beam.middle", &[beam.middle], 1)?;
    check.positive("structure.beam.length", beam.length)?;
    check.positive("structure.beam.thickness", beam.thickness)?;
    check.positive("structure.beam.density", beam.density)?;
    check.positive("structure.beam.youngs_modulus", beam.youngs_modulus)?;
    check.within("structure.beam.poisson_ratio", beam.poisson_ratio.unwrap_or(0.0), 0.0, 0.5)?;
    check.within("structure.beam.modes", beam.modes as f64, 0.0, 8.0)?;
    for zeta in &beam.damping {
        check.within("structure.beam.damping", *zeta, 0.0, 1.0)?;
    }
    for (key, count) in [("damping", beam.damping.len()), ("initial_modes", beam.initial_modes.len())] {
        check.within(&format!("length of structure.beam.{key}"), count as f64, 0.0, beam.modes as f64)?;
    }
    Ok(())
}

fn validate_coupling(check: &Checker, coupling: &Coupling) -> Result<(), Error> {
    check.within("coupling.relaxation", coupling.relaxation, 1e-6, 1.0)?;
    check.within("coupling.tolerance_relative", coupling.tolerance_relative, 0.0, 1.0)?;
    check.within("coupling.tolerance_absolute", coupling.tolerance_absolute, 0.0, f64::MAX)?;
    if coupling.tolerance_relative == 0.0 && coupling.tolerance_absolute == 0.0 {
        check.fail("coupling.tolerance_relative, tolerance_absolute", "0, 0", "at least one above 0")?;
    }
    check.within("coupling.maximum_iterations", coupling.maximum_iterations as f64, 1.0, 1e4)?;
    check.within("coupling.smallest_step", coupling.smallest_step, 0.0, f64::MAX)?;
    check.within("coupling.predictor_order", coupling.predictor_order as f64, 0.0, 2.0)?;
    check.within("coupling.reused_steps", coupling.reused_steps as f64, 0.0, 100.0)
}
