//! Turns a scene into a case: the fluid FMU and the structure FMU as far as the scene has them, connected by equal
//! names, for the degrees of freedom that the scene has.

use crate::case::{Case, Connection, Fmu, Limits};
use crate::watch::Reference;
use components::{Interface, conversion};
use kinematics::{Coordinate, Part};
use scene::{Coupling, Method, Scene, Scheme};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Name of the fluid FMU in a case made from a scene.
pub const FLUID: &str = "fluid";
/// Name of the structure FMU in a case made from a scene.
pub const STRUCTURE: &str = "structure";

/// Where things are that a case made from a scene refers to.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// The scene file.
    pub scene: PathBuf,
    /// Folder of fluid.fmu and structure.fmu.
    pub fmus: PathBuf,
    /// Folder for field frames.
    pub frames: PathBuf,
}

/// The case of a validated scene. `overrides` are the ones already applied to `scene`; the FMUs receive them too.
/// `threads` overrides the scene's number when it is given.
pub fn case(scene: &Scene, overrides: &[(String, String)], threads: Option<usize>, places: &Places) -> Case {
    let freedoms = freedoms(scene);
    let mut fmus = Vec::new();
    // The structure steps first, so that its motion is fresh and the load is what is iterated.
    if !scene.body.is_empty() && (!freedoms.is_empty() || scene.fluid.is_none()) {
        fmus.push(fmu(STRUCTURE, scene, overrides, places));
    }
    if scene.fluid.is_some() {
        let mut fluid = fmu(FLUID, scene, overrides, places);
        if let Some(threads) = threads {
            fluid.parameters.insert("threads".to_string(), toml::Value::Integer(threads as i64));
        }
        fmus.push(fluid);
    }
    let connection = if fmus.len() == 2 { connections(scene, &freedoms) } else { Vec::new() };
    // With one internal step of the fluid per step, its load is affine in the motion and iterations converge fast.
    let step_limit = (!connection.is_empty()).then(|| format!("{FLUID}.time_step.suggested"));
    Case {
        title: scene.title.clone(),
        run: scene.run.clone(),
        start: 0.0,
        output: scene.output.clone(),
        fmu: fmus,
        connection,
        coupling: coupling(scene),
        step_limit,
        exclude: excluded(scene, &freedoms),
        means: means(scene),
        maxima: maxima(scene),
        labels: labels(scene),
        watch: scene.watch.clone(),
        reference: Some(Reference::of(scene)),
        check: scene.check.clone(),
        limits: Limits::default(),
    }
}

fn fmu(name: &str, scene: &Scene, overrides: &[(String, String)], places: &Places) -> Fmu {
    let text = |text: String| toml::Value::String(text);
    let overrides: Vec<String> = overrides.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let mut parameters = BTreeMap::from([
        ("scene".to_string(), text(places.scene.display().to_string())),
        ("scene_overrides".to_string(), text(overrides.join("; "))),
    ]);
    if scene.output.interval > 0.0 {
        parameters.insert("output_directory".to_string(), text(places.frames.display().to_string()));
        parameters.insert("output_interval".to_string(), toml::Value::Float(scene.output.interval));
    }
    Fmu { name: name.to_string(), path: places.fmus.join(format!("{name}.fmu")), parameters }
}

/// The coordinates that answer to the load.
fn freedoms(scene: &Scene) -> Vec<Coordinate> {
    let layout = Interface::of(scene).layout();
    let active = conversion::active(scene, &layout);
    layout
        .coordinates()
        .enumerate()
        .filter(|(index, _)| active.contains(index))
        .map(|(_, coordinate)| coordinate)
        .collect()
}

/// How the scene is coupled: the scheme `mps` gives no derivatives.
fn coupling(scene: &Scene) -> Coupling {
    let mut coupling = scene.coupling.clone();
    let mps = scene.fluid.as_ref().is_some_and(|fluid| fluid.scheme == Scheme::Mps);
    if coupling.method == Method::Auto && mps {
        coupling.method = Method::IqnIls;
    }
    coupling
}

/// Whether the structure takes the fluid's added mass into its equations. Iterations do not need it, and the scheme
/// `mps` has none.
fn passes_added_mass(scene: &Scene) -> bool {
    let voronoi = scene.fluid.as_ref().is_some_and(|fluid| fluid.scheme == Scheme::Voronoi);
    scene.coupling.method == Method::Explicit && scene.coupling.added_mass && voronoi
}

fn connections(scene: &Scene, freedoms: &[Coordinate]) -> Vec<Connection> {
    let interface = Interface::of(scene);
    let link = |from: &str, to: &str, variable: &str| Connection {
        from: format!("{from}.{variable}"),
        to: format!("{to}.{variable}"),
        tolerance_absolute: None,
    };
    let mut connections = Vec::new();
    for &freedom in freedoms {
        let motion = interface.motion(freedom);
        connections.extend(motion.iter().map(|variable| link(STRUCTURE, FLUID, variable)));
        connections.push(link(FLUID, STRUCTURE, &interface.load(freedom)));
    }
    if passes_added_mass(scene) {
        for (index, &row) in freedoms.iter().enumerate() {
            connections.push(link(FLUID, STRUCTURE, &interface.load_acceleration(row)));
            for &column in &freedoms[index..] {
                connections.push(link(FLUID, STRUCTURE, &interface.added_mass(row, column)));
            }
        }
    }
    connections
}

/// Whether the water's load on a coordinate says something: it acts on a wetted body whether that is free or held.
fn is_loaded(scene: &Scene, coordinate: Coordinate) -> bool {
    let body = &scene.body[coordinate.body];
    let is_mode = matches!(coordinate.part, Part::Mode { .. });
    is_mode || !body.wall.is_empty() || !body.member.is_empty()
}

/// Outputs that say nothing in this scene, or far too much: the added mass is for coupling.
fn excluded(scene: &Scene, freedoms: &[Coordinate]) -> Vec<String> {
    let interface = Interface::of(scene);
    let all: Vec<Coordinate> = interface.layout().coordinates().collect();
    let mut names = Vec::new();
    for (index, &row) in all.iter().enumerate() {
        names.push(format!("{FLUID}.{}", interface.load_acceleration(row)));
        names.extend(all[index..].iter().map(|&column| format!("{FLUID}.{}", interface.added_mass(row, column))));
        if !freedoms.contains(&row) {
            names.extend(interface.motion(row).map(|variable| format!("{STRUCTURE}.{variable}")));
        }
        if !is_loaded(scene, row) {
            names.push(format!("{FLUID}.{}", interface.load(row)));
        }
    }
    names
}

/// Pressures and loads are impulses over time.
fn means(scene: &Scene) -> Vec<String> {
    let interface = Interface::of(scene);
    let layout = interface.layout();
    let loads = layout.coordinates().map(|coordinate| interface.load(coordinate));
    let pressures = interface.probes.iter().map(|probe| Interface::pressure(probe));
    let on_walls = ["wall.force_x", "wall.force_y"].map(str::to_string);
    pressures.chain(loads).chain(on_walls).map(|name| format!("{FLUID}.{name}")).collect()
}

fn maxima(scene: &Scene) -> Vec<String> {
    let largest = Interface::of(scene).largest;
    largest.iter().map(|probe| format!("{FLUID}.{}", Interface::largest(probe))).collect()
}

/// What reports call the variables of places: as the scene does.
fn labels(scene: &Scene) -> BTreeMap<String, String> {
    let Some(fluid) = &scene.fluid else { return BTreeMap::new() };
    let named = |variable: fn(&str) -> String, label: String| {
        (format!("{FLUID}.{}", variable(&scene::identifier(&label))), label)
    };
    let probes = fluid.probe.iter().flat_map(scene::Probe::labels).map(|label| named(Interface::pressure, label));
    let regions = fluid.region.iter().map(|region| named(Interface::mass, region.name.clone()));
    let gauges = fluid.gauge.iter().map(|gauge| named(Interface::level, gauge.name.clone()));
    let gas = scene.gas.iter();
    let chambers = gas.clone().flat_map(|gas| &gas.chamber).flat_map(|chamber| {
        [0, 1, 2].map(|k: usize| {
            let variable = Interface::chamber(&scene::identifier(&chamber.name))[k].clone();
            (format!("{FLUID}.{variable}"), chamber.name.clone())
        })
    });
    let vents = gas.flat_map(|gas| &gas.vent).map(|vent| named(Interface::flow, vent.name.clone()));
    probes.chain(regions).chain(gauges).chain(chambers).chain(vents).collect()
}

/// Whether the text of a file is a case rather than a scene: it lists FMUs, in whichever way. Text that is no TOML is
/// taken for what its lines look like, so that the right reader says what is wrong.
pub fn is_case(text: &str) -> bool {
    match text.parse::<toml::Table>() {
        Ok(table) => table.contains_key("fmu"),
        Err(_) => text.lines().any(|line| line.trim_start().starts_with("[[fmu]]")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = 'plate'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.01\n\
        water = [{ polygon = [[0,0],[1,0],[1,0.5],[0,0.5]] }]\n\
        probe = [{ name = 'P', point = [0.5, 0.1] }, { name = 'line', from = [0,0.1], to = [0,0.4], count = 3 }]\n\
        [[body]]\nname = 'gate'\nfree = ['theta']\nmass = 1.0\ninertia = 1.0\n[[body.member]]\nname = 'leaf'\nsupport = 'clamped_free'\n\
        middle = [2.0, 0.0]\nlength = 0.1\nthickness = 0.01\ndensity = 1e3\nyoungs_modulus = 1e6\nmodes = 2\n";

    fn places() -> Places {
        Places { scene: "s.toml".into(), fmus: "fmus".into(), frames: "out/frames".into() }
    }

    #[test]
    fn only_the_freedoms_of_the_scene_cross() {
        let scene = Scene::from_str(SCENE, "s.toml").unwrap();
        let case = case(&scene, &[("fluid.spacing".into(), "0.02".into())], Some(2), &places());
        // Three freedoms: each three motions forward and one load back; the structure steps first.
        assert_eq!(case.connection.len(), 12);
        let froms: Vec<&str> = case.connection[..4].iter().map(|connection| connection.from.as_str()).collect();
        let motion = ["theta", "vtheta", "atheta"].map(|name| format!("structure.body.gate.motion.{name}"));
        assert_eq!(froms[..3], motion);
        assert_eq!(froms[3], "fluid.body.gate.load.mz");
        assert_eq!(case.connection[4].from, "structure.body.gate.leaf.motion.q1");
        assert_eq!(case.fmu[0].name, STRUCTURE);
        assert_eq!(case.fmu[1].parameters["scene_overrides"].as_str(), Some("fluid.spacing=0.02"));
        assert_eq!(case.fmu[1].parameters["threads"].as_integer(), Some(2));
        let excluded = |name: &str| case.exclude.iter().any(|known| known == name);
        assert!(excluded("structure.body.gate.motion.x") && !excluded("fluid.body.gate.leaf.load.q2"));
        // The body cannot move along X, but the water pushes it there all the same.
        assert!(!excluded("fluid.body.gate.load.fx") && excluded("fluid.added_mass.gate.x.gate.leaf.q2"));
        assert_eq!(case.labels["fluid.probe.line_2.pressure"], "line, 2");
    }

    #[test]
    fn a_case_lists_fmus_in_whichever_way() {
        assert!(is_case("[[fmu]]\nname = 'a'") && is_case("fmu = [{ name = 'a', path = 'a.fmu' }]"));
        assert!(is_case("[[ fmu ]]\nname = 'a'") && is_case("[[fmu]]\nname = "));
        assert!(!is_case(SCENE) && !is_case("title = '[[fmu]]'") && !is_case("x = "));
    }

    #[test]
    fn a_scene_without_water_or_without_structure_runs_one_fmu() {
        let scene = Scene::from_str(SCENE, "s.toml").unwrap();
        let dry = Scene { fluid: None, ..scene.clone() };
        let still = Scene { body: Vec::new(), ..scene };
        assert_eq!(case(&dry, &[], None, &places()).fmu.len(), 1);
        let still = case(&still, &[], None, &places());
        assert!(still.connection.is_empty() && still.exclude.is_empty());
    }

    #[test]
    fn a_body_that_is_held_has_its_loads_recorded() {
        let mut scene = Scene::from_str(SCENE, "s.toml").unwrap();
        let body = &mut scene.body[0];
        (body.free, body.member) = (Vec::new(), Vec::new());
        body.wall = vec![scene::Wall { points: vec![[0.4, 0.2], [0.4, 0.3], [0.5, 0.2]], closed: true }];
        let case = case(&scene, &[], None, &places());
        let recorded = |load: &str| !case.exclude.iter().any(|name| *name == format!("fluid.body.gate.load.{load}"));
        assert_eq!((case.fmu.len(), case.connection.len()), (1, 0), "nothing moves");
        assert!(["fx", "fy", "mz"].iter().all(|load| recorded(load)));
    }

    #[test]
    fn an_explicit_exchange_extrapolates_only_when_asked() {
        let order = |coupling: &str| {
            let scene = Scene::from_str(&format!("{SCENE}[coupling]\nmethod = 'explicit'\n{coupling}"), "s.toml");
            case(&scene.unwrap(), &[], None, &places()).coupling.predictor_order
        };
        assert_eq!((order("added_mass = true"), order("added_mass = false")), (None, None));
        assert_eq!(order("added_mass = false\npredictor_order = 1"), Some(1));
    }
}
