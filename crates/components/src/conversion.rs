//! What the parts of a scene mean to the numerics.

use crate::Error;
use kinematics::{BeamModes, Body, BodySet, Coordinate, CoordinateLayout, Part};
use nalgebra::{Matrix2, Vector2};
use scene::{Freedom, Member, Point, Scene, Wall};

fn vector(point: Point) -> Vector2<f64> {
    Vector2::new(point[0], point[1])
}

fn vectors(points: &[Point]) -> Vec<Vector2<f64>> {
    points.iter().copied().map(vector).collect()
}

/// A closed wall comes back to its first point.
fn polyline(wall: &Wall) -> Vec<Vector2<f64>> {
    let mut points = vectors(&wall.points);
    if wall.closed {
        points.extend(points.first().copied());
    }
    points
}

fn beam_modes(member: &Member) -> Result<BeamModes, Error> {
    let support = match member.support {
        scene::Support::FixedFixed => kinematics::Support::FixedFixed,
        scene::Support::ClampedFree => kinematics::Support::ClampedFree,
    };
    Ok(BeamModes::new(support, member.length, member.line_density(), member.modes)?)
}

/// Angular frequencies of the modes of a member in vacuo \[rad/s\].
///
/// # Errors
/// Modes that cannot be computed.
pub fn frequencies(member: &Member) -> Result<Vec<f64>, Error> {
    let modes = beam_modes(member)?;
    Ok((0..member.modes).map(|index| modes.frequency(index, member.bending_stiffness())).collect())
}

/// Modal coordinates at the start, one per mode of each member \[m sqrt(kg/m)\].
pub fn initial_modes(scene: &Scene) -> Vec<f64> {
    let of_member = |member: &Member| {
        let missing = member.modes - member.initial_modes.len();
        member.initial_modes.iter().copied().chain(std::iter::repeat_n(0.0, missing)).collect::<Vec<_>>()
    };
    scene.members().flat_map(of_member).collect()
}

/// The moving bodies; none in a scene of the fluid alone.
pub fn bodies(scene: &Scene) -> Result<BodySet, Error> {
    let member = |member: &Member| -> Result<kinematics::Beam, Error> {
        Ok(kinematics::Beam { middle: vector(member.middle), thickness: member.thickness, modes: beam_modes(member)? })
    };
    let body = |body: &scene::Body| -> Result<Body, Error> {
        Ok(Body {
            origin: vector(body.origin),
            angle: body.angle,
            walls: body.wall.iter().map(polyline).collect(),
            members: body.member.iter().map(member).collect::<Result<_, _>>()?,
        })
    };
    let bodies = BodySet::new(scene.body.iter().map(body).collect::<Result<_, _>>()?);
    bodies.validate()?;
    Ok(bodies)
}

/// Parameters of the structure's solver.
pub fn structure(scene: &Scene) -> Result<structure::Parameters, Error> {
    if scene.body.is_empty() {
        return Err(Error::MissingPart { title: scene.title.clone(), part: "[[body]]" });
    }
    if scene.gravity[0] != 0.0 || scene.gravity[1] > 0.0 {
        return Err(Error::Value {
            key: "gravity".to_string(),
            got: digits::list(&scene.gravity),
            expected: "[0, -g] in a scene with a body: its weight acts along -Y".to_string(),
        });
    }
    let freedoms = [Freedom::X, Freedom::Y, Freedom::Theta];
    let body = |body: &scene::Body| -> Result<structure::BodyParameters, Error> {
        Ok(structure::BodyParameters {
            rigid_mass: body.mass,
            rigid_inertia: body.inertia,
            angle: body.angle,
            members: body.member.iter().map(beam).collect::<Result<_, _>>()?,
            free: freedoms.map(|freedom| body.free.contains(&freedom)),
            springs: body.springs,
            contact: contact(scene, body),
        })
    };
    Ok(structure::Parameters {
        bodies: scene.body.iter().map(body).collect::<Result<_, _>>()?,
        gravity: -scene.gravity[1],
        integrator: integrator(&scene.integrator),
        tolerance: 1e-11,
        maximum_iterations: 20,
    })
}

fn beam(member: &Member) -> Result<structure::BeamParameters, Error> {
    let mut damping_ratios = member.damping.clone();
    damping_ratios.resize(member.modes, 0.0);
    Ok(structure::BeamParameters {
        modes: beam_modes(member)?,
        middle: vector(member.middle),
        bending_stiffness: member.bending_stiffness(),
        deflection_limit: member.deflection_limit() * member.length,
        damping_ratios,
    })
}

/// Depth behind a wall, over the depth under the body's weight, up to which a corner is pushed back.
const CONTACT_REACH: f64 = 50.0;

/// Contact of the corners of the rigid walls of a body with the fixed walls.
fn contact(scene: &Scene, body: &scene::Body) -> Option<structure::ContactParameters> {
    let given = body.contact.as_ref()?;
    let origin = vector(body.origin);
    let fixed = scene.fluid.iter().flat_map(|fluid| &fluid.wall).map(polyline);
    let pairs = |line: Vec<Vector2<f64>>| line.windows(2).map(|pair| [pair[0] - origin, pair[1] - origin]).collect();
    let members: f64 = body.member.iter().map(|member| member.line_density() * member.length).sum();
    Some(structure::ContactParameters {
        stiffness: (body.mass + members) * -scene.gravity[1] / given.depth,
        damping: given.damping,
        reach: CONTACT_REACH * given.depth,
        corners: body.wall.iter().flat_map(|wall| vectors(&wall.points)).collect(),
        walls: fixed.flat_map(|line| -> Vec<_> { pairs(line) }).collect(),
    })
}

fn integrator(integrator: &scene::Integrator) -> structure::Integrator {
    match integrator.rho_infinity {
        Some(rho_infinity) => structure::Integrator::GeneralisedAlpha { rho_infinity },
        None => structure::Integrator::Newmark { beta: integrator.beta, gamma: integrator.gamma },
    }
}

/// Parameters and geometry of the fluid's solver.
pub fn fluid(scene: &Scene) -> Result<(fluid::Parameters, fluid::Geometry), Error> {
    let missing = || Error::MissingPart { title: scene.title.clone(), part: "[fluid]" };
    let part = scene.fluid.as_ref().ok_or_else(missing)?;
    let shaking = fluid::Shaking { amplitude: vector(part.shaking.amplitude), period: part.shaking.period };
    if shaking.amplitude != Vector2::zeros() && !scene.body.is_empty() {
        return Err(Error::Value {
            key: "fluid.shaking.amplitude".to_string(),
            got: digits::list(&part.shaking.amplitude),
            expected: "[0.0, 0.0] in a scene with a body: only water would feel the shaking".to_string(),
        });
    }
    let bodies = bodies(scene)?;
    let geometry = fluid::Geometry {
        water: part.water.iter().map(|water| vectors(&water.polygon)).collect(),
        fixed_walls: part.wall.iter().map(polyline).collect(),
        active: active(scene, bodies.layout()),
        bodies,
        probes: part.probe.iter().flat_map(|probe| probes(scene, probe)).collect(),
        regions: part.region.iter().map(|part| region(scene, part)).collect(),
        start: start(&part.start),
        jitter: fluid::Jitter { amplitude: part.start.jitter, seed: part.start.seed },
        gauges: part.gauge.iter().map(|gauge| gauge.x).collect(),
        chambers: scene.gas.iter().flat_map(|gas| &gas.chamber).map(|part| chamber(scene, part)).collect(),
        vents: scene.gas.iter().flat_map(|gas| &gas.vent).map(|part| vent(scene, part)).collect(),
    };
    let parameters = fluid::Parameters {
        density: part.density,
        gravity: vector(scene.gravity),
        attraction: part.attraction,
        damping: part.damping.iter().map(damping).collect(),
        shaking,
        spacing: part.spacing,
        scheme: match part.scheme {
            scene::Scheme::Voronoi => fluid::Scheme::Voronoi(part.voronoi.clone()),
            scene::Scheme::Mps => fluid::Scheme::Mps(part.mps.clone()),
        },
        solve: part.solve.clone(),
        gas: scene.gas.as_ref().map(gas),
        threads: part.threads,
    };
    Ok((parameters, geometry))
}

/// Coordinates that answer to the load: the free ones of the rigid parts, and the modes.
pub fn active(scene: &Scene, layout: &CoordinateLayout) -> Vec<usize> {
    let all = layout.coordinates().enumerate();
    let answers = |coordinate: &Coordinate| {
        let free = |freedom| scene.body[coordinate.body].free.contains(&freedom);
        match coordinate.part {
            Part::X => free(Freedom::X),
            Part::Y => free(Freedom::Y),
            Part::Theta => free(Freedom::Theta),
            Part::Mode { .. } => true,
        }
    };
    all.filter(|(_, coordinate)| answers(coordinate)).map(|(index, _)| index).collect()
}

/// Index of the body that an instrument is on.
fn carrier(scene: &Scene, name: Option<&String>) -> Option<usize> {
    scene.body.iter().position(|body| name.is_some_and(|name| body.is_called(name)))
}

fn probes(scene: &Scene, probe: &scene::Probe) -> impl Iterator<Item = fluid::Probe> {
    let on_body = carrier(scene, probe.on_body.as_ref());
    vectors(&probe.points()).into_iter().map(move |place| fluid::Probe {
        place,
        on_body,
        size: probe.size,
        threshold: probe.threshold.unwrap_or(f64::INFINITY),
    })
}

fn region(scene: &Scene, region: &scene::Region) -> fluid::Region {
    fluid::Region { polygon: vectors(&region.polygon), on_body: carrier(scene, region.on_body.as_ref()) }
}

fn gas(gas: &scene::Gas) -> fluid::GasParameters {
    fluid::GasParameters { exponent: gas.exponent, ambient: gas.ambient, density: gas.density }
}

fn chamber(scene: &Scene, chamber: &scene::Chamber) -> fluid::Chamber {
    let on_body = carrier(scene, chamber.on_body.as_ref());
    fluid::Chamber { place: vector(chamber.point), on_body, pressure: chamber.pressure }
}

fn vent(scene: &Scene, vent: &scene::Vent) -> fluid::Vent {
    fluid::Vent {
        place: vector(vent.point),
        to: vent.to.map(vector),
        on_body: carrier(scene, vent.on_body.as_ref()),
        area: vent.area,
        discharge: vent.discharge,
    }
}

fn damping(zone: &scene::DampingZone) -> fluid::DampingZone {
    fluid::DampingZone { from: zone.from, to: zone.to, rate: zone.rate }
}

fn start(start: &scene::Start) -> fluid::AffineVelocity {
    let gradient = Matrix2::from_row_slice(start.gradient.as_flattened());
    fluid::AffineVelocity { constant: vector(start.velocity), gradient }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = 'box'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.01\n\
        water = [{ polygon = [[0,0],[1,0],[1,0.5],[0,0.5]] }]\nwall = [{ points = [[0,0],[1,0],[1,1]], closed = true }]\n\
        probe = [{ name = 'line', from = [0,0.1], to = [0,0.4], count = 3 }]\n\
        [[body]]\nname = 'cabin'\nfree = ['theta', 'y']\nmass = 2.0\ninertia = 3.0\nangle = 0.1\n\
        [[body.member]]\nname = 'plate'\nsupport = 'clamped_free'\nmiddle = [2.0, 0.0]\nlength = 0.1\nthickness = 0.012\n\
        density = 2500\nyoungs_modulus = 1e6\npoisson_ratio = 0.3\nmodes = 3\ndamping = [0.01]\ninitial_modes = [0.5]\n";

    fn scene(text: &str) -> Scene {
        Scene::from_str(text, "box.toml").unwrap()
    }

    #[test]
    fn missing_entries_are_filled_and_freedoms_are_in_order() {
        let parameters = structure(&scene(SCENE)).unwrap();
        assert_eq!(parameters.bodies[0].free, [false, true, true]);
        assert_eq!((parameters.gravity, parameters.bodies[0].angle), (9.81, 0.1));
        let beam = &parameters.bodies[0].members[0];
        assert_eq!(beam.damping_ratios, [0.01, 0.0, 0.0]);
        // E h^3 / (12 (1 - nu^2)) = 144 / 0.91 / 1000.
        assert!((beam.bending_stiffness - 0.144 / 0.91).abs() < 1e-15);
        assert_eq!(beam.modes.line_density(), 30.0);
        assert_eq!(initial_modes(&scene(SCENE)), [0.5, 0.0, 0.0]);
    }

    #[test]
    fn closed_walls_come_back_and_line_probes_are_points() {
        let (_, geometry) = fluid(&scene(SCENE)).unwrap();
        assert_eq!(geometry.fixed_walls[0].first(), geometry.fixed_walls[0].last());
        assert_eq!(geometry.fixed_walls[0].len(), 4);
        assert_eq!(geometry.probes.len(), 3);
        assert_eq!(geometry.bodies.bodies()[0].modes(), 3);
    }

    #[test]
    fn water_starts_in_motion_and_is_forced() {
        let text = &SCENE[..SCENE.find("[[body]]").unwrap()];
        let forced = format!(
            "{text}attraction = 4.0\ngauge = [{{ name = 'g', x = 0.3 }}]\nstart = {{ velocity = [1.0, 2.0], \
             gradient = [[0.0, -3.0], [5.0, 0.0]] }}\nshaking = {{ amplitude = [0.1, 0.0], period = 2.0 }}\n"
        );
        let (parameters, geometry) = fluid(&scene(&forced)).unwrap();
        // u = 1 - 3 y, v = 2 + 5 x at (1, 1).
        assert_eq!(geometry.start.at(&Vector2::new(1.0, 1.0)), Vector2::new(-2.0, 7.0));
        assert_eq!((parameters.attraction, geometry.gauges.as_slice()), (4.0, &[0.3][..]));
        // At t = 0 the force is 0.1 (2 pi / 2)^2 along X, besides gravity.
        let force = parameters.uniform_force(0.0) - Vector2::new(0.1 * std::f64::consts::PI.powi(2), -9.81);
        assert!(force.norm() < 1e-12, "{force:?}");
        let shaken = SCENE.replace("[[body]]\n", "shaking = { amplitude = [0.1, 0.0] }\n[[body]]\n");
        assert!(fluid(&scene(&shaken)).unwrap_err().to_string().contains("fluid.shaking.amplitude = [0.1, 0]"));
    }

    #[test]
    fn water_alone_has_no_structure() {
        let text = &SCENE[..SCENE.find("[[body]]").unwrap()];
        assert_eq!(fluid(&scene(text)).unwrap().0.solve, fluid::SolveParameters::default());
        assert!(structure(&scene(text)).unwrap_err().to_string().contains("[[body]]"));
        let tilted = SCENE.replace("title = 'box'", "title = 'box'\ngravity = [1.0, -9.81]");
        assert!(structure(&scene(&tilted)).unwrap_err().to_string().contains("[1, -9.81]"));
    }
}
