//! Gas in what walls, bodies and water close off from the open air.

use crate::types::Point;
use crate::validate::Checker;
use crate::{Body, Error, Scene, Scheme};
use keys::keys;

keys! {
    /// Gas in what walls, bodies and water close off from the open air. A scene without has open air in all that is not water.
    pub struct Gas {
        /// Exponent of p V^gamma = constant: 1.4 for air that is squeezed fast, 1 for gas that keeps its temperature.
        exponent: f64 = 1.4, in 1.0 to 3.0;
        /// Pressure of the open air \[Pa\]; the pressures of water and gas in results are what they have beyond it.
        ambient: f64 = 101_325.0, in 1.0 to 1e9;
        /// Density of the gas at that pressure \[kg/m3\].
        density: f64 = 1.2, above 0;
        /// Places where the gas is read.
        chamber: Vec<Chamber> = Vec::new();
        /// Openings through which gas leaves or enters a pocket.
        vent: Vec<Vent> = Vec::new();
    }
}

keys! {
    /// A place where the gas is read: nothing while there is water, or the open air.
    pub struct Chamber {
        /// Name, in reports and in the variables of the FMUs.
        name: String;
        /// A place in the gas \[m\].
        point: Point, each in -1e9 to 1e9;
        /// Name of the body that it moves with, from its place at the start on; missing: it stays where it is.
        on_body: Option<String> = None;
        /// Absolute pressure of the gas there at the start \[Pa\]; missing: that of the open air.
        pressure: Option<f64> = None, in 1.0 to 1e12;
    }
}

keys! {
    /// An opening from a pocket to the open air, or to another pocket. The flow is that of an orifice, C A sqrt(2 rho dp).
    pub struct Vent {
        /// Name, in reports and in the variables of the FMUs.
        name: String;
        /// A place in the pocket near the opening \[m\]; while there is water nothing flows.
        point: Point, each in -1e9 to 1e9;
        /// A place in the pocket at its other end \[m\]; missing: the open air.
        to: Option<Point> = None;
        /// Name of the body that it moves with, from its place at the start on; missing: it stays where it is.
        on_body: Option<String> = None;
        /// Area per width \[m\].
        area: f64, in 0.0 to 1e6;
        /// Discharge coefficient.
        discharge: f64 = 0.6, in 0.0 to 1.0;
    }
}

/// Ranges, names and carriers of a scene's gas.
pub(crate) fn validate_gas(check: &Checker, scene: &Scene) -> Result<(), Error> {
    let Some(gas) = &scene.gas else { return Ok(()) };
    check.keys("gas", gas.check())?;
    if scene.fluid.as_ref().is_none_or(|fluid| fluid.scheme != Scheme::Voronoi) {
        check.fail("gas", "given", "a scene with [fluid] of the scheme 'voronoi' if there is gas")?;
    }
    check.names("gas.chamber", gas.chamber.iter().map(|chamber| chamber.name.as_str()).enumerate())?;
    check.names("gas.vent", gas.vent.iter().map(|vent| vent.name.as_str()).enumerate())?;
    for (i, chamber) in gas.chamber.iter().enumerate() {
        check.keys(&format!("gas.chamber[{i}]"), chamber.check())?;
        carried(check, &format!("gas.chamber[{i}]"), chamber.on_body.as_ref(), &scene.body)?;
    }
    for (i, vent) in gas.vent.iter().enumerate() {
        check.keys(&format!("gas.vent[{i}]"), vent.check())?;
        check.point(&format!("gas.vent[{i}].to"), vent.to.unwrap_or_default())?;
        carried(check, &format!("gas.vent[{i}]"), vent.on_body.as_ref(), &scene.body)?;
    }
    Ok(())
}

/// Refuses the name of a body that is not there.
pub(crate) fn carried(check: &Checker, entry: &str, name: Option<&String>, bodies: &[Body]) -> Result<(), Error> {
    let Some(name) = name.filter(|name| bodies.iter().all(|body| !body.is_called(name))) else { return Ok(()) };
    let known: Vec<_> = bodies.iter().map(|body| format!("'{}'", body.name)).collect();
    let known = if known.is_empty() { "this scene has none".to_string() } else { known.join(", ") };
    check.fail(&format!("{entry}.on_body"), format!("'{name}'"), &format!("the name of a body: {known}"))
}
