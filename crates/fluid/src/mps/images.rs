//! Mirror images: what a particle sees behind a wall.
//!
//! A wall is replaced by the mirror image of the fluid in front of it, so that sums over neighbours are complete
//! there. With d the distance from a plane wall, the image j' of particle j is at
//!
//!   |r_j' - r_i|^2 = |r_j - r_i|^2 + 4 d_i d_j,
//!
//! which is symmetric in i and j: the matrix of the pressure stays symmetric. The image's normal velocity is
//! reflected about the wall's, and its pressure follows from the wall's Neumann condition
//! dp/dn = rho (g - a_w).n as p_j' = p_j + rho ((g - a_w).n) 2 d_j. Near a corner with the fluid inside, the image of
//! the image in the second wall is added; it is exact for a right angle.
//!
//! Departure from the paper: it refers its walls to another work. Wall and dummy particles whose pressure is no
//! unknown tilt the hydrostatic pressure by several per cent; mirror images do not.

use super::kernel::Kernel;
use super::neighbour::Neighbour;
use crate::parallel::Lists;
use crate::walls::PanelMotion;
use crate::walls::{WallProximity, Walls};
use nalgebra::Vector2;

/// Reflection in one wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// Unit normal into the solid.
    pub normal: Vector2<f64>,
    /// Displacement along the normal from the particle to its image, 2 d_j \[m\].
    pub offset: f64,
    /// Moving panel, or `u32::MAX` for a fixed wall.
    pub panel: u32,
    /// Place on the panel, 0 to 1.
    pub fraction: f64,
}

/// One image that a particle sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    /// The particle that is mirrored; it may be the observer itself.
    pub neighbour: u32,
    /// Number of reflections, 1 or 2.
    pub reflections: u32,
    /// From the observer to the image \[m\].
    pub vector: Vector2<f64>,
    /// Weight w of that distance.
    pub weight: f64,
    /// The reflections; the second counts only where `reflections` is 2.
    pub mirrors: [Mirror; 2],
}

impl Image {
    /// The reflections of this image.
    #[inline]
    pub fn mirrors(&self) -> &[Mirror] {
        &self.mirrors[..self.reflections as usize]
    }

    /// Velocity of the image of a particle with velocity `velocity`, about the wall's velocity at the step's start.
    #[inline]
    pub fn velocity(&self, velocity: &Vector2<f64>, panels: &PanelMotion) -> Vector2<f64> {
        let mut mirrored = *velocity;
        for mirror in self.mirrors() {
            let wall = panels.velocity(mirror.panel, mirror.fraction);
            mirrored -= mirror.normal * (2.0 * (velocity - wall).dot(&mirror.normal));
        }
        mirrored
    }

    /// Pressure of the image above that of the particle, divided by the density \[m2/s2\].
    #[inline]
    pub fn pressure_rise(&self, gravity: &Vector2<f64>, panels: &PanelMotion) -> f64 {
        let mut rise = 0.0;
        for mirror in self.mirrors() {
            let wall = panels.acceleration(mirror.panel, mirror.fraction);
            rise += (gravity - wall).dot(&mirror.normal) * mirror.offset;
        }
        rise
    }
}

/// Builds the images of all particles from their neighbours and proximities.
pub fn build(
    images: &mut Lists<Image>,
    positions: &[Vector2<f64>],
    neighbours: &Lists<Neighbour>,
    proximities: &Lists<WallProximity>,
    walls: &Walls,
    kernel: &Kernel,
) {
    images.build(positions.len(), |i, out| {
        let own = proximities.of(i);
        if own.is_empty() {
            return;
        }
        let mut view = |j: usize| {
            let other = proximities.of(j);
            if !other.is_empty() {
                see(i, j, positions[j] - positions[i], own, other, walls, kernel, out);
            }
        };
        view(i);
        neighbours.of(i).iter().for_each(|neighbour| view(neighbour.index as usize));
    });
}

/// The images of j that i sees: one per common chain, one more per concave corner of two of them.
#[allow(clippy::too_many_arguments, reason = "one pair with all that it depends on; a struct would only rename it")]
fn see(
    i: usize,
    j: usize,
    between: Vector2<f64>,
    own: &[WallProximity],
    other: &[WallProximity],
    walls: &Walls,
    kernel: &Kernel,
    out: &mut Vec<Image>,
) {
    let direct = between.norm_squared();
    let (seen, count) = common_chains((i, own), (j, other), direct, walls, kernel);
    let mut push = |added: f64, mirrors: [Mirror; 2], reflections: u32| {
        let squared = direct + added;
        if squared >= kernel.radius * kernel.radius {
            return;
        }
        let mut vector = between;
        mirrors[..reflections as usize].iter().for_each(|mirror| vector += mirror.normal * mirror.offset);
        out.push(Image { neighbour: j as u32, reflections, vector, weight: kernel.weight(squared), mirrors });
    };
    for (first, entry) in seen[..count].iter().enumerate() {
        let Some((chain, added, mirror)) = *entry else { continue };
        push(added, [mirror, mirror], 1);
        for second in seen[first + 1..count].iter().flatten() {
            let (other_chain, other_added, other_mirror) = *second;
            if walls.meet_in_concave_corner(chain, other_chain) {
                push(added + other_added, [mirror, other_mirror], 2);
            }
        }
    }
}

/// A chain that two particles see, the square of the distance that the mirror image adds \[m2\], and the reflection.
type Seen = Option<(u32, f64, Mirror)>;

/// The chains that both particles see with the image within reach, and their number.
fn common_chains(
    (i, own): (usize, &[WallProximity]),
    (j, other): (usize, &[WallProximity]),
    direct: f64,
    walls: &Walls,
    kernel: &Kernel,
) -> ([Seen; 4], usize) {
    let least = 0.02 * kernel.radius;
    let mut seen: [Seen; 4] = [None; 4];
    let mut count = 0;
    for a in own {
        let Some(b) = other.iter().find(|entry| entry.chain == a.chain) else { continue };
        let (di, dj) = (a.distance.max(least), b.distance.max(least));
        let added = 4.0 * di * dj;
        if direct + added >= kernel.radius * kernel.radius {
            continue;
        }
        let arc = (a.arc * dj + b.arc * di) / (di + dj);
        if arc < 0.0 || arc > walls.chains[a.chain as usize].length || count == seen.len() {
            continue;
        }
        let (segment, fraction) = walls.locate(a.chain, arc);
        let normal = if i == j { a.normal } else { (a.normal + b.normal).normalize() };
        let panel = walls.segments[segment as usize].panel;
        seen[count] = Some((a.chain, added, Mirror { normal, offset: 2.0 * dj, panel, fraction }));
        count += 1;
    }
    (seen, count)
}
