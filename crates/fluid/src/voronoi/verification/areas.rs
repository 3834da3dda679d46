//! Areas of cells, places of free surfaces, and the filling of polygons.

use super::{Arrangement, Noise, ORDERS, Order, largest, points, square};
use crate::setup::fill;
use crate::voronoi::facet::turn;
use crate::voronoi::relax::relax;
use nalgebra::Vector2;
use std::f64::consts::PI;

#[test]
fn cells_fill_a_closed_box() {
    for order in ORDERS.into_iter().chain([Order::Jittered(0.35)]) {
        let total: f64 = Arrangement::closed(order, 24).filled().areas().iter().sum();
        assert!((total - 1.0).abs() < 1e-12, "{order:?}: areas add up to {total}");
    }
}

#[test]
fn open_cells_hold_what_their_particles_own() {
    for order in ORDERS {
        let water = Arrangement::open(order, 24);
        let open = || (0..water.positions.len()).filter(|&i| water.cells.cells[i].is_open());
        assert!(open().count() >= 24, "{order:?}: {} cells at the surface", open().count());
        let worst = largest(open().map(|i| water.cells.cells[i].area / water.own_areas[i] - 1.0));
        assert!(worst < 1e-12, "{order:?}: an area differs by {worst} of itself");
        let total: f64 = water.areas().iter().sum();
        assert!((total - 1.0).abs() < 1e-12, "{order:?}: areas add up to {total}");
    }
}

/// A row of particles that own more or less: the surface stands where the volume says, from 0.2 to 0.75 spacings above.
#[test]
fn a_level_surface_stands_at_the_height_of_its_volume() {
    let across = 16;
    let spacing = 1.0 / across as f64;
    let tank = points(&[(0.0, 2.0), (0.0, 0.0), (1.0, 0.0), (1.0, 2.0)]);
    for step in 0..12 {
        let depth = (0.2 + 0.05 * f64::from(step)) * spacing;
        let positions = square(across);
        let owned =
            |place: &Vector2<f64>| spacing * if place.y > 1.0 - spacing { 0.5 * spacing + depth } else { spacing };
        let own_areas = positions.iter().map(owned).collect();
        let water = Arrangement::new(positions, Some(own_areas), std::slice::from_ref(&tank), spacing);
        for (i, cell) in water.cells.cells.iter().enumerate() {
            let top = water.positions[i].y > 1.0 - spacing;
            assert_eq!(cell.is_open(), top, "particle at {:?}", water.positions[i]);
            if top {
                assert!((cell.depth - depth).abs() < 1e-12, "depth {} for {depth}", cell.depth);
                assert!((cell.outward - Vector2::new(0.0, spacing)).norm() < 1e-12, "outward {:?}", cell.outward);
            }
        }
    }
}

#[test]
fn an_isolated_particle_is_a_disc() {
    let spacing = 0.01;
    let volume = 0.9 * spacing * spacing;
    let water = Arrangement::new(vec![Vector2::new(0.3, 0.2)], Some(vec![volume]), &[], spacing);
    let cell = &water.cells.cells[0];
    let radius = (volume / PI).sqrt();
    assert!((cell.area / volume - 1.0).abs() < 1e-12, "area {} for {volume}", cell.area);
    assert!((cell.depth / radius - 1.0).abs() < 1e-12, "radius {} for {radius}", cell.depth);
    assert!((cell.surface / (2.0 * PI * radius) - 1.0).abs() < 1e-12, "length {}", cell.surface);
    assert!(cell.outward.norm() < 1e-15 && cell.centroid.norm() < 1e-15);
}

/// Water on both sides of a plate a fifth of a spacing thick: cells end at its faces.
#[test]
fn no_facet_crosses_a_thin_plate() {
    let across = 20;
    let spacing = 1.0 / across as f64;
    let (left, right) = (0.5 - 0.1 * spacing, 0.5 + 0.1 * spacing);
    let plate = points(&[(left, 0.0), (left, 1.0), (right, 1.0), (right, 0.0)]);
    let width = 0.5 - 0.1 * spacing;
    let mut noise = Noise::new(23);
    let positions: Vec<_> = square(across)
        .into_iter()
        .map(|place| {
            let x = if place.x < 0.5 { place.x * 2.0 * width } else { 1.0 - (1.0 - place.x) * 2.0 * width };
            Vector2::new(x, place.y) + noise.vector() * (0.2 * spacing)
        })
        .collect();
    let water = Arrangement::new(positions, None, &[super::unit_box(), plate], spacing);
    let is_left = |i: usize| water.positions[i].x < 0.5;
    let mut held = [0.0, 0.0];
    for i in 0..water.positions.len() {
        held[usize::from(is_left(i))] += water.cells.cells[i].area;
        for facet in water.cells.facets.of(i) {
            assert_eq!(is_left(i), is_left(facet.neighbour as usize), "{:?} sees through", water.positions[i]);
        }
    }
    for area in held {
        assert!((area - width).abs() < 1e-12, "{area} of {width} beside the plate");
    }
}

/// A square solid in the box, with particles jittered around it: no end of a facet lies inside it, and the cells fill
/// the rest. What two particles claim that do not see each other round a corner is less than a hundredth of a cell.
#[test]
fn cells_do_not_reach_into_a_convex_corner() {
    let across = 20;
    let spacing = 1.0 / across as f64;
    let solid = points(&[(0.3, 0.3), (0.3, 0.7), (0.7, 0.7), (0.7, 0.3), (0.3, 0.3)]);
    let inside = |place: &Vector2<f64>, margin: f64| (place - Vector2::new(0.5, 0.5)).amax() < 0.2 - margin;
    for seed in 0..30 {
        let mut noise = Noise::new(seed);
        let around = square(across).into_iter().filter(|place| !inside(place, 0.0));
        let positions = around.map(|place| place + noise.vector() * (0.2 * spacing)).collect();
        let water = Arrangement::new(positions, None, &[super::unit_box(), solid.clone()], spacing);
        for (i, place) in water.positions.iter().enumerate() {
            let on_walls = water.cells.walls.of(i).iter().map(|wall| &wall.facet);
            for facet in water.cells.facets.of(i).iter().chain(on_walls) {
                for along in [facet.from, facet.to] {
                    let end = place + facet.normal * facet.height + turn(&facet.normal) * along;
                    assert!(!inside(&end, 1e-9), "the cell of {place:?} reaches {end:?}");
                }
            }
        }
        let excess = (water.areas().iter().sum::<f64>() - 0.84) / spacing.powi(2);
        assert!(excess.abs() < 1e-2, "seed {seed}: areas differ by {excess} cells from the box without the solid");
    }
}

#[test]
fn a_disc_is_filled_evenly_and_exactly() {
    for spacing in [0.1, 0.04] {
        let angle = |k: u32| 2.0 * PI * f64::from(k) / 400.0;
        let disc: Vec<_> = (0..400).map(|k| Vector2::new(angle(k).cos(), angle(k).sin())).collect();
        let mut filling = fill::fill(std::slice::from_ref(&disc), spacing).unwrap();
        let effective = filling.effective_spacing;
        let own_areas = relax(&mut filling.positions, &filling.counts, std::slice::from_ref(&disc), effective);
        let total: f64 = own_areas.iter().sum();
        assert!((total / fill::area(&disc) - 1.0).abs() < 1e-12, "areas add up to {total}");
        let mut nearest = f64::MAX;
        for (k, a) in filling.positions.iter().enumerate() {
            assert!(fill::contains(&disc, a), "{a:?} lies outside");
            nearest = filling.positions[..k].iter().map(|b| (a - b).norm() / effective).fold(nearest, f64::min);
        }
        assert!(nearest > 0.8, "two particles are {nearest} spacings apart");
        let uneven = largest(own_areas.iter().map(|volume| volume / effective.powi(2) - 1.0));
        assert!(uneven < 0.2, "a particle owns {uneven} more or less than the mean");
    }
}
