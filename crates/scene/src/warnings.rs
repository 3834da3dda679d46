//! What a valid scene probably does not mean: said before a run, which goes on.

use crate::{Body, Fluid, Member, Point, Scene, Support};
use digits::{list, six};

/// Distance of a clamped end from the nearest wall, over the spacing and over the thickness, up to which it counts as
/// held there: the drawn plate may begin within the wall or half a spacing beside it.
const REACH: f64 = 1.0;

impl Scene {
    /// What a user should know of this scene before it runs.
    pub fn warnings(&self) -> Vec<String> {
        let Some(fluid) = &self.fluid else { return Vec::new() };
        let of_body = |(index, body): (usize, &Body)| {
            let members = body.member.iter().enumerate();
            let ends = members
                .flat_map(|(at, member)| ends_in_mid_air(fluid, body, member, &format!("body[{index}].member[{at}]")));
            ends.chain(smaller_than_a_spacing(fluid, body, index)).collect::<Vec<_>>()
        };
        self.body.iter().enumerate().flat_map(of_body).collect()
    }
}

/// Clamped ends of a member that no wall is near to; `key` is that of the member.
fn ends_in_mid_air(fluid: &Fluid, body: &Body, member: &Member, key: &str) -> Vec<String> {
    let reach = REACH * fluid.spacing.max(member.thickness);
    let clamped: &[f64] = match member.support {
        Support::ClampedFree => &[-0.5],
        Support::FixedFixed => &[-0.5, 0.5],
    };
    let place = |share: &f64| [member.middle[0], member.middle[1] + share * member.length];
    let held = |point: Point| {
        let own = body.wall.iter().any(|wall| distance(&wall.points, wall.closed, point) <= reach);
        let fixed = |wall: &crate::Wall| distance(&wall.points, wall.closed, body.in_the_scene(point)) <= reach;
        own || fluid.wall.iter().any(fixed)
    };
    let floating = clamped.iter().map(place).filter(|point| !held(*point));
    floating
        .map(|point| {
            format!(
                "{key} '{}': its clamped end at {} m touches no wall, expected one within {} m: it is held in mid-air",
                member.name,
                list(&body.in_the_scene(point)),
                six(reach)
            )
        })
        .collect()
}

/// A body that lies between the particles.
fn smaller_than_a_spacing(fluid: &Fluid, body: &Body, index: usize) -> Option<String> {
    let mut points: Vec<Point> = body.wall.iter().flat_map(|wall| wall.points.iter().copied()).collect();
    for member in &body.member {
        let [x, y] = member.middle;
        let (width, height) = (0.5 * member.thickness, 0.5 * member.length);
        points.extend([[x - width, y - height], [x + width, y + height]]);
    }
    let [width, height] = crate::validate::extent(&points);
    let small = !points.is_empty() && width.max(height) < fluid.spacing;
    small.then(|| {
        format!(
            "body[{index}] '{}': {} x {} m, smaller than fluid.spacing = {} m: the water hardly sees it; take a smaller \
             spacing",
            body.name,
            six(width),
            six(height),
            six(fluid.spacing)
        )
    })
}

/// Distance of a point from a polyline \[m\].
fn distance(points: &[Point], closed: bool, [x, y]: Point) -> f64 {
    let back = points.last().copied().into_iter().zip(points.first().copied()).filter(|_| closed);
    let pieces = points.windows(2).map(|pair| (pair[0], pair[1])).chain(back);
    let from_piece = |(start, end): (Point, Point)| {
        let (along, gap) = ([end[0] - start[0], end[1] - start[1]], [x - start[0], y - start[1]]);
        let square = along[0] * along[0] + along[1] * along[1];
        let share = if square > 0.0 { ((gap[0] * along[0] + gap[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
        (gap[0] - share * along[0]).hypot(gap[1] - share * along[1])
    };
    pieces.map(from_piece).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate of 0.12 m that stands on the floor of a tank at x = 0.6.
    const SCENE: &str = "title = 'plate'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.02\n\
        water = [{ polygon = [[0,0],[0.3,0],[0.3,0.25],[0,0.25]] }]\n\
        wall = [{ points = [[0,0.8],[0,0],[1,0],[1,0.8]] }]\n[[body]]\nname = 'base'\n[[body.member]]\nname = 'plate'\nsupport = 'clamped_free'\n\
        middle = [0.6, 0.06]\nlength = 0.12\nthickness = 0.01\ndensity = 1e3\nyoungs_modulus = 1e6\nmodes = 2\n";

    fn warned(from: &str, to: &str) -> Vec<String> {
        assert!(SCENE.contains(from), "{from}");
        Scene::from_str(&SCENE.replace(from, to), "plate.toml").unwrap().warnings()
    }

    #[test]
    fn a_clamped_end_touches_a_wall() {
        assert!(warned("plate", "plate").is_empty());
        let floating = warned("middle = [0.6, 0.06]", "middle = [0.6, 0.36]");
        assert!(
            floating.len() == 1 && floating[0].contains("clamped end at [0.6, 0.3] m touches no wall"),
            "{floating:?}"
        );
        // A spacing above the floor counts as on it, a little more does not.
        assert!(warned("0.06]", "0.0799]").is_empty() && warned("0.06]", "0.0801]").len() == 1);
        // Both ends of a bulkhead, the upper one in the air.
        let upper = warned("clamped_free", "fixed_fixed");
        assert!(upper.len() == 1 && upper[0].contains("[0.6, 0.12]"), "{upper:?}");
        // Where the body stands and how it is turned counts: the same place by another way.
        let turned = |x: &str| {
            let origin = format!("name = 'base'\norigin = [{x}, 0.0]\nangle = 1.5707963267948966\n");
            let text = SCENE.replace("name = 'base'\n", &origin).replace("[0.6, 0.06]", "[0.3, -0.28]");
            Scene::from_str(&text, "plate.toml").unwrap().warnings()
        };
        assert!(turned("0.66").is_empty(), "on the wall at x = 1");
        let off = turned("0.5");
        assert!(off.len() == 1 && off[0].contains("[0.84, 0.3] m"), "{off:?}");
    }

    #[test]
    fn a_body_smaller_than_a_spacing_and_a_plate_thicker_than_long() {
        let small = warned("length = 0.12\nthickness = 0.01", "length = 0.015\nthickness = 0.01");
        assert!(small.iter().any(|text| text.contains("0.01 x 0.015 m, smaller than fluid.spacing")), "{small:?}");
        let thick = Scene::from_str(&SCENE.replace("thickness = 0.01", "thickness = 0.12"), "plate.toml").unwrap_err();
        let expected = "plate.toml, line 16: body[0].member[0].thickness = 0.12: expected less than the length, 0.12 m";
        assert!(thick.to_string().contains(expected), "{thick}");
    }
}
