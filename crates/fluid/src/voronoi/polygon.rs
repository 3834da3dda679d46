//! A convex polygon around the origin, cut by half-planes: the making of one Voronoi cell.

use nalgebra::Vector2;

/// Largest number of corners; a cell has six on average.
const CAPACITY: usize = 40;
/// Edge of the box that every cell starts from.
pub const BOX: u32 = u32::MAX;
/// Edges of walls are numbered downwards from here.
pub const WALL: u32 = u32::MAX - 1;

/// Half-plane {x : normal . x <= distance} that cuts a cell; `normal` has unit length.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    pub normal: Vector2<f64>,
    pub distance: f64,
}

/// Corners counter-clockwise, relative to the particle; edge k runs from corner k to corner k + 1 and carries the label
/// of what made it.
#[derive(Debug, Clone, Copy)]
pub struct Polygon {
    count: usize,
    corners: [Vector2<f64>; CAPACITY],
    labels: [u32; CAPACITY],
}

impl Polygon {
    /// A square with sides 2 `half`.
    pub fn square(half: f64) -> Self {
        let mut polygon =
            Self { count: 4, corners: [Vector2::zeros(); CAPACITY], labels: [BOX; CAPACITY] };
        polygon.corners[0] = Vector2::new(-half, -half);
        polygon.corners[1] = Vector2::new(half, -half);
        polygon.corners[2] = Vector2::new(half, half);
        polygon.corners[3] = Vector2::new(-half, half);
        polygon
    }

    /// Area.
    pub fn area(&self) -> f64 {
        0.5 * (0..self.count).map(|k| self.corner(k).perp(&self.corner(k + 1))).sum::<f64>()
    }

    /// Number of corners.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Corner k, cyclic.
    #[inline]
    pub fn corner(&self, k: usize) -> Vector2<f64> {
        self.corners[if k >= self.count { k - self.count } else { k }]
    }

    /// Label of edge k, cyclic.
    #[inline]
    pub fn label(&self, k: usize) -> u32 {
        self.labels[if k >= self.count { k - self.count } else { k }]
    }

    /// Largest squared distance of a corner from the particle.
    pub fn squared_reach(&self) -> f64 {
        self.corners[..self.count].iter().map(|corner| corner.norm_squared()).fold(0.0, f64::max)
    }

    /// Cuts off what lies beyond the plane by more than `slack`; returns whether anything was.
    pub fn cut(&mut self, plane: &Plane, label: u32, slack: f64) -> bool {
        let count = self.count;
        let mut side = [0.0; CAPACITY];
        let mut outside = 0;
        for (value, corner) in side[..count].iter_mut().zip(&self.corners[..count]) {
            *value = plane.normal.dot(corner) - plane.distance;
            outside += usize::from(*value > slack);
        }
        if outside == 0 || count + 2 > CAPACITY {
            return false;
        }
        let old = *self;
        let mut kept = 0;
        let mut push = |corner: Vector2<f64>, label: u32, polygon: &mut Self| {
            polygon.corners[kept] = corner;
            polygon.labels[kept] = label;
            kept += 1;
        };
        for k in 0..count {
            let next = if k + 1 == count { 0 } else { k + 1 };
            let (inside, next_inside) = (side[k] <= slack, side[next] <= slack);
            let crossing = || {
                let share = (side[k] / (side[k] - side[next])).clamp(0.0, 1.0);
                old.corners[k] + (old.corners[next] - old.corners[k]) * share
            };
            match (inside, next_inside) {
                (true, true) => push(old.corners[k], old.labels[k], self),
                (true, false) => {
                    push(old.corners[k], old.labels[k], self);
                    push(crossing(), label, self);
                }
                (false, true) => push(crossing(), old.labels[k], self),
                (false, false) => {}
            }
        }
        self.count = kept;
        true
    }
}
