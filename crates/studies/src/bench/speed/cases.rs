//! What is timed.

/// A scene at one spacing from one time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Name of the case.
    pub name: &'static str,
    /// Name of the scene.
    pub scene: &'static str,
    /// Changes of the scene, key path and value.
    pub changes: &'static [(&'static str, &'static str)],
    /// Time from which steps are timed \[s\]; water flows there without being timed.
    pub from: f64,
    /// Internal steps that are timed.
    pub steps: usize,
}

/// The column of the common dam break, which just begins to fall, with 10^3 to 10^6 particles, and the same tank when
/// the water has hit the wall.
pub const SIZES: [Case; 5] = [
    column("column, 1e3 particles", &[("fluid.spacing", "0.0065")], 400),
    column("column, 1e4 particles", &[("fluid.spacing", "0.00206")], 200),
    column("column, 4e4 particles", &[("fluid.spacing", "0.00103")], 100),
    column("column, 1e5 particles", &[("fluid.spacing", "0.00065")], 60),
    column("column, 1e6 particles", &[("fluid.spacing", "0.000206")], 12),
];

/// Flows and couplings.
pub const FLOWS: [Case; 3] = [
    Case {
        name: "splash, 3e3 particles",
        scene: "dam_break_peers",
        changes: &[("fluid.spacing", "0.004")],
        from: 0.4,
        steps: 400,
    },
    Case {
        name: "splash, 1e4 particles",
        scene: "dam_break_peers",
        changes: &[("fluid.spacing", "0.002")],
        from: 0.4,
        steps: 200,
    },
    Case {
        name: "plate that answers, 3e3 particles",
        scene: "dam_break_plate",
        changes: &[("fluid.spacing", "0.004")],
        from: 0.0,
        steps: 200,
    },
];

const fn column(name: &'static str, changes: &'static [(&'static str, &'static str)], steps: usize) -> Case {
    Case { name, scene: "dam_break_peers", changes, from: 0.0, steps }
}

/// A part of the method and the scene that does without it: the difference is what it costs where it is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// What it is.
    pub name: &'static str,
    /// Name of the scene.
    pub scene: &'static str,
    /// Changes of the scene with it.
    pub with: &'static [(&'static str, &'static str)],
    /// Changes of the scene without it.
    pub without: &'static [(&'static str, &'static str)],
}

/// Parts that a scene does not pay for unless it has them.
pub const FEATURES: [Feature; 5] = [
    Feature {
        name: "smoothing of velocities",
        scene: "dam_break_peers",
        with: &[("fluid.spacing", "0.002")],
        without: &[("fluid.spacing", "0.002"), ("fluid.voronoi.smoothing", "0.0")],
    },
    Feature {
        name: "shifting",
        scene: "dam_break_peers",
        with: &[("fluid.spacing", "0.002")],
        without: &[
            ("fluid.spacing", "0.002"),
            ("fluid.voronoi.shifting", "0.0"),
            ("fluid.voronoi.repulsion", "0.0"),
            ("fluid.voronoi.spreading", "0.0"),
        ],
    },
    Feature {
        name: "probes and gauges, in the step",
        scene: "dam_break_peers",
        with: &[("fluid.spacing", "0.002")],
        without: &[("fluid.spacing", "0.002"), ("fluid.probe", "[]"), ("fluid.gauge", "[]")],
    },
    Feature {
        name: "shaking of the frame",
        scene: "dam_break_peers",
        with: &[("fluid.spacing", "0.002"), ("fluid.shaking", "{ amplitude = [0.001, 0.0], period = 1.0 }")],
        without: &[("fluid.spacing", "0.002")],
    },
    Feature {
        name: "modes that answer to the load",
        scene: "dam_break_plate",
        with: &[("fluid.spacing", "0.003")],
        without: &[("fluid.spacing", "0.003"), ("body.0.member.0.modes", "0")],
    },
];
