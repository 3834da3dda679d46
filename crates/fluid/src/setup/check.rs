//! Whether a geometry can be simulated at all, and whether a step gave numbers: coordinates in every message.

use crate::Error;
use crate::grid::{Grid, bounding_box};
use crate::parallel;
use crate::parameters::Geometry;
use crate::setup::fill::contains;
use crate::state::State;
use crate::walls::check as wall_check;
use crate::walls::sides::{SLACK, Sides, Solids, is_closed};
use crate::walls::{FIXED, Walls};
use kinematics::{Body, MaterialPoint, Motion, SurfacePoint};
use nalgebra::Vector2;

/// Spacings from one end of a scene to the other: more is a slip in a coordinate, and no place has digits left there.
const LONGEST_SCENE: f64 = 1e8;
/// Pieces of the body's surface, two spacings long each: every one is compared with every other.
const MOST_PANELS: f64 = 1e4;

/// Refuses a scene whose walls or body reach so far that the memory would be full before anything could be said about
/// it.
pub fn is_of_bearable_size(geometry: &Geometry, spacing: f64) -> Result<(), Error> {
    let mut corners: Vec<Vector2<f64>> =
        geometry.water.iter().chain(&geometry.fixed_walls).flatten().copied().collect();
    for body in geometry.bodies.bodies() {
        let (ends, length) = surface(body);
        corners.extend(ends);
        let panels = length / (2.0 * spacing);
        if panels > MOST_PANELS {
            return Err(Error::Geometry {
                what: "the body's surface".to_string(),
                got: format!("{} m, {panels:.0} pieces of two spacings", 2.0 * spacing * panels),
                expected: format!("at most {MOST_PANELS} pieces; check its walls and the beam, or raise fluid.spacing"),
            });
        }
    }
    let (low, high) = bounding_box(&corners);
    let extent = (high - low).max();
    if extent <= LONGEST_SCENE * spacing {
        return Ok(());
    }
    Err(Error::Geometry {
        what: format!("water, walls and body from ({}, {}) to ({}, {})", low.x, low.y, high.x, high.y),
        got: format!("{extent} m"),
        expected: format!("at most {} m, {LONGEST_SCENE:e} spacings", LONGEST_SCENE * spacing),
    })
}

/// Corners of a body's surface in the pose of the scene \[m\], and its length \[m\].
fn surface(body: &Body) -> (Vec<Vector2<f64>>, f64) {
    let rest = Motion::at_rest(body.modes());
    let mut points: Vec<_> = body.walls.iter().flatten().map(|&point| MaterialPoint::Rigid(point)).collect();
    let pieces = body.walls.iter().flat_map(|wall| wall.windows(2)).map(|pair| (pair[1] - pair[0]).norm());
    let mut total = pieces.sum::<f64>();
    for (member, beam) in body.members.iter().enumerate() {
        let (length, thickness) = (beam.modes.length(), beam.thickness);
        total += 2.0 * (length + thickness);
        let at = |station, share: f64| MaterialPoint::Beam { member, station, offset: share * thickness };
        points.extend([at(0.0, -0.5), at(0.0, 0.5), at(length, -0.5), at(length, 0.5)]);
    }
    (points.into_iter().map(|point| body.position(point, &rest)).collect(), total)
}

/// Refuses instruments on bodies that there are not.
pub fn instruments_have_bodies(geometry: &Geometry) -> Result<(), Error> {
    let count = geometry.bodies.bodies().len();
    let probes = geometry.probes.iter().map(|probe| ("probe", probe.on_body));
    let all = probes.chain(geometry.regions.iter().map(|region| ("region", region.on_body)));
    let numbered = all.filter_map(|(what, body)| Some((what, body?)));
    match numbered.into_iter().find(|(_, body)| *body >= count) {
        None => Ok(()),
        Some((what, body)) => Err(Error::Geometry {
            what: format!("a {what} on body {body}"),
            got: format!("{count} bodies"),
            expected: "a body of the scene".to_string(),
        }),
    }
}

/// Refuses particles that own no area: their cells fold over in the tip of a polygon or where it crosses itself.
pub fn areas_are_sound(areas: &[f64], places: &[Vector2<f64>]) -> Result<(), Error> {
    match areas.iter().zip(places).find(|(area, _)| !(area.is_finite() && **area > 0.0)) {
        None => Ok(()),
        Some((area, place)) => Err(Error::Geometry {
            what: format!("water near ({}, {})", place.x, place.y),
            got: format!("a particle with an area of {area} m2"),
            expected: "polygons of water that do not cross themselves, with tips wider than a spacing".to_string(),
        }),
    }
}

/// Refuses degenerate walls: pieces without length, walls without a wet side.
pub fn walls_are_sound(geometry: &Geometry, spacing: f64) -> Result<(), Error> {
    for (number, wall) in geometry.fixed_walls.iter().enumerate() {
        for pair in wall.windows(2) {
            let length = (pair[1] - pair[0]).norm();
            if length < 0.1 * spacing {
                return Err(Error::Geometry {
                    what: format!("fixed wall {number} near ({}, {})", pair[0].x, pair[0].y),
                    got: format!("a piece of {length} m"),
                    expected: format!("pieces longer than 0.1 spacings = {} m", 0.1 * spacing),
                });
            }
        }
    }
    wall_check::are_consistent(geometry, spacing)
}

/// Refuses water inside a wall, a body outside the tank and walls that turn their solid side to the water.
pub fn fits_together(walls: &Walls, geometry: &Geometry, water: &[Vector2<f64>], spacing: f64) -> Result<(), Error> {
    let (sides, solids) = (Sides::new(walls.segments.iter(), spacing), Solids::new(geometry));
    let inside = |point: &Vector2<f64>| sides.is_behind(point) || solids.depth(point) > SLACK * spacing;
    if let Some(point) = water.iter().find(|point| inside(point)) {
        return Err(Error::Geometry {
            what: format!("water at ({}, {}) lies behind the wall nearest to it", point.x, point.y),
            got: "a particle inside a solid".to_string(),
            expected:
                "all water in front of walls and structure; move the water's polygon out of the solid, or walk a \
                       wall's points with the fluid on the left"
                    .to_string(),
        });
    }
    off_the_body(walls, water, spacing)?;
    let fixed = Sides::new(walls.segments.iter().filter(|segment| segment.panel == FIXED), spacing);
    for segment in walls.segments.iter().filter(|segment| segment.panel != FIXED) {
        let middle = segment.start + segment.tangent * (0.5 * segment.length);
        if fixed.is_behind(&middle) {
            return Err(Error::Geometry {
                what: format!("the body's surface at ({}, {}) lies behind a fixed wall", middle.x, middle.y),
                got: "a body outside the tank".to_string(),
                expected: "a body inside the walls; move its `origin`, or the `middle` of its member".to_string(),
            });
        }
    }
    wall_check::are_seen_from_the_front(walls, water, spacing)
}

/// Refuses a body that stands wholly in another one: their surfaces do not cross.
pub fn bodies_are_apart(geometry: &Geometry) -> Result<(), Error> {
    let (bodies, rest) = (&geometry.bodies, geometry.bodies.at_rest());
    let place = |body: usize, point: &Vector2<f64>| {
        bodies.position(SurfacePoint { body, point: MaterialPoint::Rigid(*point) }, &rest)
    };
    for (k, solid) in bodies.bodies().iter().enumerate() {
        let closed = solid.walls.iter().filter(|wall| is_closed(wall));
        for outline in closed.map(|wall| wall.iter().map(|point| place(k, point)).collect::<Vec<_>>()) {
            let others = bodies.bodies().iter().enumerate().filter(|(l, _)| *l != k);
            let corners =
                others.flat_map(|(l, body)| body.walls.iter().filter_map(|wall| wall.first()).map(move |at| (l, at)));
            if let Some(inside) = corners.map(|(l, at)| place(l, at)).find(|at| contains(&outline, at)) {
                return Err(Error::Overlap { x: inside.x, y: inside.y, time: 0.0 });
            }
        }
    }
    Ok(())
}

/// Refuses particles on the surface of the body: those of a polygon that covers a solid as thin as the spacing stand on
/// its faces, and none within.
fn off_the_body(walls: &Walls, water: &[Vector2<f64>], spacing: f64) -> Result<(), Error> {
    let nearest = |point: &Vector2<f64>| {
        let near = walls.candidates(point).iter().map(|&index| &walls.segments[index as usize]);
        let body = near.filter(|segment| segment.panel != FIXED);
        body.map(|segment| segment.squared_distance(point)).fold(f64::INFINITY, f64::min)
    };
    if let Some(point) = water.iter().find(|point| nearest(point) < (0.05 * spacing).powi(2)) {
        return Err(Error::Geometry {
            what: format!("a particle at ({}, {}) stands on the surface of the structure", point.x, point.y),
            got: format!("{} m away from it", nearest(point).sqrt()),
            expected: "about half a spacing; let the water's polygon not cover the structure".to_string(),
        });
    }
    Ok(())
}

/// Refuses bodies of water that overlap: particles of one among those of another.
pub fn no_overlap(water: &[Vector2<f64>], spacing: f64) -> Result<(), Error> {
    let mut grid = Grid::default();
    grid.build(water, spacing);
    for (i, point) in water.iter().enumerate() {
        let mut nearest = f64::INFINITY;
        grid.for_each_near(point, |j| {
            if j != i {
                nearest = nearest.min((water[j] - point).norm());
            }
        });
        if nearest < 0.5 * spacing {
            return Err(Error::Geometry {
                what: format!("two particles near ({}, {})", point.x, point.y),
                got: format!("{nearest} m apart"),
                expected: format!("at least half a spacing, {} m; let bodies of water not overlap", 0.5 * spacing),
            });
        }
    }
    Ok(())
}

/// Refuses a state with a number that is not finite; `before` holds the positions before the step.
pub fn all_finite(state: &State, before: &[Vector2<f64>]) -> Result<(), Error> {
    let fail = |field, particle: usize| {
        let place = before.get(particle).copied().unwrap_or_default();
        Err(Error::NotFinite { field, particle, time: state.time, x: place.x, y: place.y })
    };
    let finite = |vector: &Vector2<f64>| vector.x.is_finite() && vector.y.is_finite();
    let sound =
        |i: usize| finite(&state.positions[i]) && finite(&state.velocities[i]) && state.pressures[i].is_finite();
    if parallel::all(state.positions.len(), sound) {
        return Ok(());
    }
    if let Some(i) = state.positions.iter().position(|vector| !finite(vector)) {
        return fail("position", i);
    }
    if let Some(i) = state.velocities.iter().position(|vector| !finite(vector)) {
        return fail("velocity", i);
    }
    match state.pressures.iter().position(|pressure| !pressure.is_finite()) {
        Some(i) => fail("pressure", i),
        None => Ok(()),
    }
}
