//! Probes, gauges and regions by the names that the scene gives them, where they stand where no water can be.

use crate::Error;
use fluid::{Instrument, Misplaced, Solver};
use scene::{Fluid, Probe, Scene};

/// Refuses instruments that can never read anything; returns what is to be said of the others that stand wrongly.
pub(super) fn judge(scene: &Scene, solver: &Solver) -> Result<Vec<String>, Error> {
    let Some(part) = &scene.fluid else { return Ok(Vec::new()) };
    let (hopeless, doubtful): (Vec<_>, Vec<_>) = solver.misplaced().into_iter().partition(|found| found.hopeless);
    match hopeless.into_iter().next() {
        Some(Misplaced { instrument, place, reason, .. }) => Err(Error::Value {
            key: key(part, instrument),
            got: place,
            expected: format!("a place that water can reach, but {reason}; move it or remove it"),
        }),
        None => Ok(doubtful.into_iter().map(|found| warning(part, &found)).collect()),
    }
}

fn warning(part: &Fluid, found: &Misplaced) -> String {
    format!("{} at {} may read nothing: {}", key(part, found.instrument), found.place, found.reason)
}

/// Key and name in the scene.
fn key(part: &Fluid, instrument: Instrument) -> String {
    let named = |list: &str, index: usize, name: Option<&String>| {
        let name = name.map_or_else(String::new, |name| format!(" '{name}'"));
        format!("fluid.{list}[{index}]{name}")
    };
    match instrument {
        Instrument::Gauge(index) => named("gauge", index, part.gauge.get(index).map(|gauge| &gauge.name)),
        Instrument::Region(index) => named("region", index, part.region.get(index).map(|region| &region.name)),
        Instrument::Probe(index) => {
            let labels: Vec<_> = part.probe.iter().map(Probe::labels).enumerate().collect();
            let points = labels.iter().flat_map(|(probe, labels)| labels.iter().map(move |label| (*probe, label)));
            let (probe, label) =
                points.skip(index).map(|(probe, label)| (probe, Some(label))).next().unwrap_or((index, None));
            named("probe", probe, label)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::runtime;
    use scene::Scene;

    const TANK: &str = "title = 'tank'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.02\n\
        water = [{ polygon = [[0,0],[0.4,0],[0.4,0.4],[0,0.4]] }]\n\
        wall = [{ points = [[0,0.8],[0,0],[0.4,0],[0.4,0.8]] }]\n";

    fn judged(instruments: &str) -> Result<Vec<String>, String> {
        let scene = Scene::from_str(&format!("{TANK}{instruments}\n"), "tank.toml").unwrap();
        runtime::solver(&scene).map(|set_up| set_up.warnings).map_err(|error| error.to_string())
    }

    #[test]
    fn a_probe_is_told_how_deep_in_the_wall_it_stands() {
        assert_eq!(judged("probe = [{ name = 'at the floor', point = [0.2, 0.0] }]").unwrap(), [""; 0]);
        let warnings = judged(
            "probe = [{ name = 'good', point = [0.2, 0.001] }, { name = 'line', from = [0.1, -0.001], to = [0.1, 0.1], count = 2 }]",
        );
        let expected = "fluid.probe[1] 'line, 1' at (0.1, -0.001) may read nothing: it lies 0.001 m within a solid";
        assert_eq!(warnings.unwrap(), [expected]);
        let message = judged("probe = [{ name = 'deep', point = [0.2, -0.015] }]").unwrap_err();
        assert!(message.starts_with("fluid.probe[0] 'deep' = (0.2, -0.015): expected a place"), "{message}");
        assert!(message.contains("0.015 m within a solid; move it"), "{message}");
        let message = judged("probe = [{ name = 'in the wall', point = [0.9, 0.2] }]").unwrap_err();
        assert!(message.contains("'in the wall' = (0.9, 0.2)") && message.contains("0.5 m within"), "{message}");
    }

    #[test]
    fn instruments_outside_are_told_how_far() {
        let message = judged("probe = [{ name = 'p', point = [5.0, 5.0] }]").unwrap_err();
        // (5 - 0.4, 5 - 0.8) from the corner of the box.
        assert!(message.contains("'p' = (5, 5)") && message.contains("it lies 6.22896 m"), "{message}");
        assert!(message.contains("outside of walls, water and structure, which reach from (0, 0)"), "{message}");
        let message = judged("gauge = [{ name = 'in', x = 0.4 }, { name = 'far', x = 5.0 }]").unwrap_err();
        assert!(message.contains("fluid.gauge[1] 'far' = 5 m") && message.contains("4.6 m outside"), "{message}");
        let warnings = judged("gauge = [{ name = 'near', x = 0.5 }]").unwrap();
        assert!(warnings.len() == 1 && warnings[0].contains("'near' at 0.5 m may read nothing"), "{warnings:?}");
        let message = judged("region = [{ name = 'r', polygon = [[5, 0], [6, 0], [6, 1]] }]").unwrap_err();
        assert!(message.contains("fluid.region[0] 'r' = (5, 0) to (6, 1)") && message.contains("4.6 m"), "{message}");
        assert_eq!(
            judged("region = [{ name = 'r', polygon = [[-9, -9], [0.1, -9], [0.1, 9], [-9, 9]] }]").unwrap(),
            [""; 0]
        );
    }

    /// A probe on a body, and one within a block that stands a little in the floor.
    #[test]
    fn solids_in_the_tank_count() {
        let block = TANK.replace(
            "[0.4,0.8]] }]",
            "[0.4,0.8]] }, { points = [[0.1,-0.01],[0.1,0.1],[0.2,0.1],[0.2,-0.01]], closed = true }]",
        );
        let water = "[[0,0.1],[0.4,0.1],[0.4,0.4],[0,0.4]]";
        let block = block.replace("[[0,0],[0.4,0],[0.4,0.4],[0,0.4]]", water);
        let set_up = |point: &str| {
            let text = format!("{block}probe = [{{ name = 'p', point = {point} }}]\n");
            runtime::solver(&Scene::from_str(&text, "tank.toml").unwrap()).map_err(|error| error.to_string())
        };
        // Nearer to the floor than to any side of the block, and 11 mm above its bottom.
        let message = set_up("[0.15, 0.001]").err().unwrap();
        assert!(message.contains("0.011 m within a solid"), "{message}");
        assert_eq!(set_up("[0.1, 0.05]").unwrap().warnings, [""; 0], "on its side");
    }
}
