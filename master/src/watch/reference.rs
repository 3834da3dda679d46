//! What the motion of a scene is measured by: the forces that act on it, how far it can fall, how fast that makes it.

use components::Interface;
use scene::{Body, Point, Scene};
use std::f64::consts::TAU;

/// Figures of a scene before anything moves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reference {
    /// Magnitude of gravity \[m/s2\].
    pub gravity: f64,
    /// Lowest height of water, walls and bodies, against gravity \[m\].
    pub lowest: f64,
    /// Mass of the water \[kg/m\].
    pub water: f64,
    /// Mass of what moves of the bodies \[kg/m\].
    pub body: f64,
    /// Square of the speed that the start, a fall through the scene and the attraction give \[m2/s2\].
    pub squared_speed: f64,
    /// Speed \[m/s\] below which nothing moves: in the whole run by less than a billionth of a spacing, as by rounding.
    pub still: f64,
    /// Largest acceleration of a shaken tank \[m/s2\] and its angular frequency \[rad/s\].
    pub shaking: (Point, f64),
    /// Constant loads, each with the position that it acts on, by the name of that output of the structure.
    pub constant_loads: Vec<(String, f64)>,
}

impl Reference {
    /// The figures of a validated scene.
    pub fn of(scene: &Scene) -> Self {
        let gravity = scene.gravity[0].hypot(scene.gravity[1]);
        let height = |point: &Point| {
            if gravity > 0.0 { -(scene.gravity[0] * point[0] + scene.gravity[1] * point[1]) / gravity } else { 0.0 }
        };
        let fluid = scene.fluid.as_ref();
        let water: Vec<Point> = fluid.iter().flat_map(|it| &it.water).flat_map(|it| it.polygon.clone()).collect();
        let walls = fluid.iter().flat_map(|it| &it.wall).flat_map(|it| it.points.clone());
        let all = water.iter().copied().chain(walls).chain(scene.body.iter().flat_map(outline));
        let lowest = all.map(|point| height(&point)).fold(f64::INFINITY, f64::min);
        let mut reference = Self { gravity, lowest: if lowest.is_finite() { lowest } else { 0.0 }, ..Self::default() };
        if let Some(fluid) = fluid {
            reference.water = fluid.density * fluid.water.iter().map(scene::Polygon::area).sum::<f64>();
            reference.still = 1e-9 * fluid.spacing / scene.run.end;
            let fall = water.iter().map(height).fold(reference.lowest, f64::max) - reference.lowest;
            let start = water.iter().map(|point| squared_start(&fluid.start, point)).fold(0.0, f64::max);
            let reach = water.iter().map(|it| it[0] * it[0] + it[1] * it[1]).fold(0.0, f64::max);
            let omega = TAU / fluid.shaking.period;
            reference.shaking = (fluid.shaking.amplitude.map(|amplitude| amplitude * omega * omega), omega);
            let shaken = fluid.shaking.amplitude.iter().map(|amplitude| (amplitude * omega).powi(2)).sum::<f64>();
            reference.squared_speed = start + 2.0 * gravity * fall + fluid.attraction.max(0.0) * reach + shaken;
        }
        reference.body = scene.body.iter().map(moving_mass).sum();
        reference.constant_loads = constant_loads(scene);
        reference
    }
}

/// Square of the speed of the water at a point at the start \[m2/s2\].
fn squared_start(start: &scene::Start, point: &Point) -> f64 {
    let along = |k: usize| start.velocity[k] + start.gradient[k][0] * point[0] + start.gradient[k][1] * point[1];
    along(0).powi(2) + along(1).powi(2)
}

/// Mass of what moves of a body \[kg/m\].
fn moving_mass(body: &Body) -> f64 {
    let rigid = if body.free.is_empty() { 0.0 } else { body.mass };
    rigid + body.member.iter().map(|member| member.line_density() * member.length).sum::<f64>()
}

/// Constant loads that are not zero.
fn constant_loads(scene: &Scene) -> Vec<(String, f64)> {
    let interface = Interface::of(scene);
    let layout = interface.layout();
    let coordinates: Vec<_> = layout.coordinates().collect();
    let of_body = |(index, body): (usize, &Body)| {
        let members = body.member.iter().enumerate();
        let members = members.map(|(member, part)| (layout.member(index, member), &part.constant_load));
        let all = std::iter::once((layout.rigid(index), &body.constant_load)).chain(members);
        let pairs = all.flat_map(|(own, loads)| coordinates[own].iter().zip(loads)).filter(|(_, load)| **load != 0.0);
        pairs.map(|(&at, &load)| (interface.motion(at)[0].clone(), load)).collect::<Vec<_>>()
    };
    scene.body.iter().enumerate().flat_map(of_body).collect()
}

/// Corners of walls and members where they stand at the start \[m\].
fn outline(body: &Body) -> Vec<Point> {
    let ends =
        |member: &scene::Member| [-0.5, 0.5].map(|share| [member.middle[0], member.middle[1] + share * member.length]);
    let corners =
        body.wall.iter().flat_map(|wall| wall.points.iter().copied()).chain(body.member.iter().flat_map(ends));
    corners.map(|corner| body.in_the_scene(corner)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_has_its_fall_and_its_masses() {
        let text = "title = 't'\n[run]\nend = 1.0\ncommunication_step = 0.1\n[fluid]\nspacing = 0.1\ndensity = 500.0\n\
            water = [{ polygon = [[0,0],[2,0],[2,1],[0,1]] }]\nstart = { velocity = [3.0, 0.0] }\n\
            wall = [{ points = [[0,2],[0,-0.5],[2,0],[2,2]] }]\nshaking = { amplitude = [0.1, 0.0], period = 2.0 }\n";
        let reference = Reference::of(&Scene::from_str(text, "t").unwrap());
        assert_eq!((reference.lowest, reference.water, reference.body), (-0.5, 1000.0, 0.0));
        let pi = std::f64::consts::PI;
        // From the surface at 1 m to the lowest corner, and 3 m/s, and the shaking's 0.1 pi m/s.
        let expected = 2.0 * 9.81 * 1.5 + 9.0 + (0.1 * pi).powi(2);
        assert!((reference.squared_speed - expected).abs() < 1e-12, "{}", reference.squared_speed);
        assert!((reference.still - 1e-10).abs() < 1e-20, "{}", reference.still);
        assert!((reference.shaking.0[0] - 0.1 * pi * pi).abs() < 1e-12 && reference.shaking.1 == pi);
        let text = "title = 't'\ngravity = [0.0, -2.0]\n[run]\nend = 1.0\ncommunication_step = 0.1\n[[body]]\n\
            name = 'b'\norigin = [1.0, 1.0]\nangle = 1.5707963267948966\nfree = ['y']\nmass = 3.0\n\
            wall = [{ points = [[-2.0, 0.0], [0.5, 0.0]] }]\n";
        let reference = Reference::of(&Scene::from_str(text, "t").unwrap());
        assert!((reference.lowest + 1.0).abs() < 1e-12, "turned by a quarter: {}", reference.lowest);
        assert_eq!((reference.body, reference.gravity, reference.squared_speed), (3.0, 2.0, 0.0));
    }
}
