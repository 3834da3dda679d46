//! Continuity: nothing that cells give the equations jumps while particles walk.

use super::*;
use crate::voronoi::facet::Facet;
use crate::voronoi::operators;

/// Step along a path in spacings.
const STEP: f64 = 1e-4;
/// Largest change within one step, over the step. Nothing but one tie exceeds 100: that of a cell round the edge of a solid, the
/// far corner of which moves eighteen times as fast as its particle, has 130.
const STEEPEST: f64 = 150.0;
/// Steps between places at which a path is looked at first.
const COARSE: usize = 64;
/// What is looked at of every particle.
const NAMES: [&str; 10] =
    ["area", "filled", "tie", "outward.x", "outward.y", "weight.x", "weight.y", "rate", "matrix", "force"];
type Values = Vec<[f64; NAMES.len()]>;

/// Particles that walk between walls; lengths are spacings.
struct Walk {
    from: Vec<Vector2<f64>>,
    ways: Vec<Vector2<f64>>,
    water: Arrangement,
    velocities: Vec<Vector2<f64>>,
    pressures: Vec<f64>,
}

impl Walk {
    fn new(from: Vec<Vector2<f64>>, ways: Vec<Vector2<f64>>, walls: &[Vec<Vector2<f64>>]) -> Self {
        let mut noise = Noise::new(3);
        let water = Arrangement::new(from.clone(), None, walls, 1.0);
        let velocities = from.iter().map(|_| noise.vector()).collect();
        let pressures = from.iter().map(|_| noise.next()).collect();
        Self { from, ways, water, velocities, pressures }
    }

    /// What the cells give the equations at a place along the path, 0 to 1.
    fn at(&mut self, share: f64) -> Values {
        let places = self.water.positions.iter_mut().zip(self.from.iter().zip(&self.ways));
        places.for_each(|(place, (from, way))| *place = from + way * share);
        self.water.rebuild();
        let cells = &self.water.cells;
        let of = |i: usize| {
            let cell = &cells.cells[i];
            let tie = if cell.is_open() { cell.surface / cell.depth } else { 0.0 };
            let across =
                |facet: &Facet| facet.weight() * (self.pressures[i] - self.pressures[facet.neighbour as usize]);
            let walls = cells.walls.of(i).iter().filter(|wall| !wall.is_closure);
            let wall_rate: f64 =
                walls.map(|wall| wall.facet.length() * wall.facet.normal.dot(&self.velocities[i])).sum();
            [
                cell.area,
                cell.filled,
                tie,
                cell.outward.x,
                cell.outward.y,
                cell.free_surface_gradient.x,
                cell.free_surface_gradient.y,
                operators::area_rate(cells, i, &self.velocities) - wall_rate,
                cells.facets.of(i).iter().map(across).sum(),
                operators::pressure_difference(cells, i, &self.pressures).x,
            ]
        };
        (0..self.from.len()).map(of).collect()
    }

    /// Jumps between two places: particle, quantity, place and size, the largest of each place.
    fn jumps(&mut self, (from, to): (usize, usize), ends: (&Values, &Values), count: usize, found: &mut Vec<Jump>) {
        let Some(largest) = largest_change(ends.0, ends.1) else { return };
        if largest.size <= STEEPEST * STEP {
            return;
        }
        if to - from == 1 {
            found.push(Jump { at: from as f64 / count as f64, ..largest });
            return;
        }
        let middle = usize::midpoint(from, to);
        let between = self.at(middle as f64 / count as f64);
        self.jumps((from, middle), (ends.0, &between), count, found);
        self.jumps((middle, to), (&between, ends.1), count, found);
    }

    /// All jumps along the path.
    fn find(&mut self) -> Vec<Jump> {
        let longest = self.ways.iter().map(|way| way.norm()).fold(0.0, f64::max);
        let pieces = (longest / (STEP * COARSE as f64)).ceil() as usize;
        let count = pieces * COARSE;
        let mut found = Vec::new();
        let mut before = self.at(0.0);
        for piece in 0..pieces {
            let after = self.at((piece + 1) as f64 / pieces as f64);
            self.jumps((piece * COARSE, (piece + 1) * COARSE), (&before, &after), count, &mut found);
            before = after;
        }
        found
    }
}

/// A jump of one quantity.
#[derive(Debug, Clone, Copy)]
struct Jump {
    at: f64,
    particle: usize,
    quantity: usize,
    size: f64,
}

fn largest_change(before: &Values, after: &Values) -> Option<Jump> {
    let changes = before.iter().zip(after).enumerate().flat_map(|(particle, (before, after))| {
        (0..NAMES.len()).map(move |quantity| {
            let size = (after[quantity] - before[quantity]).abs();
            Jump { at: 0.0, particle, quantity, size }
        })
    });
    changes.max_by(|a, b| a.size.total_cmp(&b.size))
}

/// A block of particles with its lower left corner at a place, jittered by a share of a spacing.
fn block(corner: (f64, f64), (across, up): (usize, usize), jitter: f64, noise: &mut Noise) -> Vec<Vector2<f64>> {
    let place = |k: usize| Vector2::new(corner.0 + (k % across) as f64 + 0.5, corner.1 + (k / across) as f64 + 0.5);
    (0..across * up).map(|k| place(k) + noise.vector() * jitter).collect()
}

fn walks() -> Vec<(&'static str, Walk)> {
    let mut noise = Noise::new(11);
    let jitter = 0.15;
    let mut walks = Vec::new();
    // Two blocks that meet.
    let (left, right) = (block((0.0, 0.0), (4, 4), jitter, &mut noise), block((6.0, 0.3), (4, 4), jitter, &mut noise));
    let ways = left.iter().map(|_| Vector2::zeros()).chain(right.iter().map(|_| Vector2::new(-2.3, 0.2))).collect();
    walks.push(("blocks meet", Walk::new([left, right].concat(), ways, &[])));
    // A block falls on a floor beside a wall.
    let falling = block((0.4, 1.5), (4, 4), jitter, &mut noise);
    let ways = falling.iter().map(|place| Vector2::new(-0.1, -1.3 - 0.05 * place.y)).collect();
    let tank = points(&[(0.0, 9.0), (0.0, 0.0), (9.0, 0.0), (9.0, 9.0)]);
    walks.push(("falls into a corner", Walk::new(falling, ways, &[tank])));
    // A block slides over the edge of a step.
    let sliding = block((-4.2, 0.05), (5, 3), jitter, &mut noise);
    let ways = sliding.iter().map(|place| Vector2::new(3.0, -0.2 * place.x.max(-2.0) - 0.4)).collect();
    let step = points(&[(-9.0, 0.0), (0.0, 0.0), (0.0, -6.0), (9.0, -6.0)]);
    walks.push(("slides over an edge", Walk::new(sliding, ways, &[step])));
    // A block is stretched until it parts.
    let stretched = block((0.0, 0.0), (6, 2), jitter, &mut noise);
    let ways = stretched.iter().map(|place| Vector2::new(0.8 * (place.x - 3.0), -0.2 * (place.y - 1.0))).collect();
    walks.push(("parts", Walk::new(stretched, ways, &[])));
    // A particle falls into water.
    let mut pool = block((0.0, 0.0), (6, 3), jitter, &mut noise);
    pool.push(Vector2::new(3.1, 5.5));
    let mut ways = vec![Vector2::zeros(); 18];
    ways.push(Vector2::new(0.2, -2.2));
    let tank = points(&[(0.0, 9.0), (0.0, 0.0), (6.0, 0.0), (6.0, 9.0)]);
    walks.push(("joins", Walk::new(pool, ways, &[tank])));
    // Two layers shear, and every particle its own way.
    let sheared = block((0.0, 0.0), (6, 6), 0.25, &mut noise);
    let ways = sheared.iter().map(|place| Vector2::new(0.4 * (place.y - 3.0), 0.0) + noise.vector() * 0.2).collect();
    walks.push(("shears", Walk::new(sheared, ways, &[])));
    // A wedge-shaped root: two layers close like scissors on a wall.
    let mut closing = block((0.0, 0.0), (7, 2), jitter, &mut noise);
    let upper: Vec<_> = (0..7).map(|k| Vector2::new(f64::from(k) + 0.4, 3.0 + 0.3 * f64::from(k))).collect();
    let mut ways = vec![Vector2::zeros(); 14];
    ways.extend(upper.iter().map(|place| Vector2::new(0.3, -0.8 - 0.02 * place.x)));
    closing.extend(upper);
    let floor = points(&[(-2.0, 9.0), (-2.0, 0.0), (9.0, 0.0)]);
    walks.push(("scissors", Walk::new(closing, ways, &[floor])));
    walks
}

#[test]
fn nothing_jumps_where_particles_walk() {
    let mut all = Vec::new();
    for (name, mut walk) in walks() {
        for jump in walk.find() {
            let Jump { at, particle, quantity, size } = jump;
            walk.at(at);
            let place = walk.water.positions[particle];
            let what = NAMES[quantity];
            all.push(format!("{name}: {what} of {particle} at {:.3} {:.3}, {at:.5}: {size:.3}", place.x, place.y));
        }
    }
    assert!(all.is_empty(), "{} jumps:\n{}", all.len(), all.join("\n"));
}
