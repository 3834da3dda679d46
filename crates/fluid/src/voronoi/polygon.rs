//! A convex polygon around the origin, cut by half-planes: the making of one Voronoi cell.

use nalgebra::Vector2;

/// Largest number of corners; a cell has six on average.
const CAPACITY: usize = 32;
/// Edge of the box that every cell starts from.
pub const BOX: u32 = u32::MAX;
/// Edges of walls are numbered downwards from here.
pub const WALL: u32 = u32::MAX - 1;

/// Half-plane {x : normal . x <= distance} that cuts a cell; `normal` has unit length.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    /// Unit vector out of the half-plane.
    pub normal: Vector2<f64>,
    /// Distance of its edge from the origin \[m\].
    pub distance: f64,
}

/// A corner and the edge that runs from it, counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    /// Place relative to the particle \[m\].
    pub place: Vector2<f64>,
    /// What made the edge from here to the next corner: a particle, a wall or the box.
    pub label: u32,
}

/// Corners counter-clockwise, relative to the particle.
pub struct Polygon {
    count: usize,
    current: usize,
    corners: [[Corner; CAPACITY]; 2],
}

impl Polygon {
    /// A square with sides 2 `half`.
    pub fn square(half: f64) -> Self {
        let empty = Corner { place: Vector2::zeros(), label: BOX };
        let mut polygon = Self { count: 4, current: 0, corners: [[empty; CAPACITY]; 2] };
        for (corner, (x, y)) in polygon.corners[0].iter_mut().zip([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
        {
            corner.place = Vector2::new(x * half, y * half);
        }
        polygon
    }

    /// A convex polygon with the given corners, as many as there is room for.
    pub fn of(corners: &[Corner]) -> Self {
        let mut polygon = Self::square(0.0);
        polygon.count = corners.len().min(CAPACITY);
        polygon.corners[0][..polygon.count].copy_from_slice(&corners[..polygon.count]);
        polygon
    }

    /// Corners in order.
    pub fn corners(&self) -> &[Corner] {
        &self.corners[self.current][..self.count]
    }

    /// Cuts off what lies beyond the plane by more than `slack`; returns whether anything was.
    pub fn cut(&mut self, plane: &Plane, label: u32, slack: f64) -> bool {
        let count = self.count;
        let mut side = [0.0; CAPACITY];
        let mut outside = false;
        for (value, corner) in side.iter_mut().zip(self.corners()) {
            *value = plane.normal.dot(&corner.place) - plane.distance;
            outside |= *value > slack;
        }
        if !outside || count + 2 > CAPACITY {
            return false;
        }
        let (first, second) = self.corners.split_at_mut(1);
        let (old, new) = if self.current == 0 { (&first[0], &mut second[0]) } else { (&second[0], &mut first[0]) };
        let mut kept = 0;
        for k in 0..count {
            let next = if k + 1 == count { 0 } else { k + 1 };
            let (inside, next_inside) = (side[k] <= slack, side[next] <= slack);
            if inside {
                new[kept] = old[k];
                kept += 1;
            }
            if inside != next_inside {
                let share = (side[k] / (side[k] - side[next])).clamp(0.0, 1.0);
                let place = old[k].place + (old[next].place - old[k].place) * share;
                new[kept] = Corner { place, label: if inside { label } else { old[k].label } };
                kept += 1;
            }
        }
        self.count = kept;
        self.current = 1 - self.current;
        true
    }
}

/// Area and moment of a polygon whose corners are walked one by one.
#[derive(Default)]
pub struct Ring {
    ends: Option<(Vector2<f64>, Vector2<f64>)>,
    area: f64,
    moment: Vector2<f64>,
}

impl Ring {
    /// Goes on to the next corner.
    pub fn walk(&mut self, point: Vector2<f64>) {
        let Some((first, last)) = self.ends else {
            self.ends = Some((point, point));
            return;
        };
        let twice = last.perp(&point);
        self.area += 0.5 * twice;
        self.moment += (last + point) * (twice / 6.0);
        self.ends = Some((first, point));
    }

    /// Area and centroid of the polygon.
    pub fn close(mut self) -> (f64, Vector2<f64>) {
        if let Some((first, _)) = self.ends {
            self.walk(first);
        }
        (self.area, if self.area > 0.0 { self.moment / self.area } else { Vector2::zeros() })
    }
}

/// Area of a polygon \[m2\].
pub fn area(corners: &[Corner]) -> f64 {
    let Some(last) = corners.last() else { return 0.0 };
    let mut before = last.place;
    let mut twice = 0.0;
    for corner in corners {
        twice += before.perp(&corner.place);
        before = corner.place;
    }
    0.5 * twice
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_loses_a_corner() {
        let mut polygon = Polygon::square(1.0);
        let plane = Plane { normal: Vector2::new(1.0, 1.0).normalize(), distance: 0.5_f64.sqrt() };
        assert!(polygon.cut(&plane, 7, 1e-12));
        assert!((area(polygon.corners()) - 3.5).abs() < 1e-14, "a triangle with legs 1 is gone");
        let cut: Vec<u32> = polygon.corners().iter().map(|corner| corner.label).filter(|&label| label == 7).collect();
        assert_eq!(cut.len(), 1);
        assert!(!polygon.cut(&plane, 8, 1e-12), "the same cut again takes nothing");
    }
}
