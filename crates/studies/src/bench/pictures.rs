//! Error against spacing and error against run time of a scene's first figure.

use super::comparison::Comparison;
use report::{Curve, Error, LogChart};
use std::path::Path;

/// Orders of the guides.
const GUIDES: [i32; 2] = [1, 2];

/// Writes `SCENE-spacing` and `SCENE-time` into the folder, each as .svg and .png.
pub fn draw(comparison: &Comparison, folder: &Path) -> Result<(), Error> {
    let scene = comparison.plan.scene;
    by_spacing(comparison).draw(&folder.join(format!("{scene}-spacing")))?;
    by_time(comparison).draw(&folder.join(format!("{scene}-time")))?;
    Ok(())
}

fn by_spacing(comparison: &Comparison) -> LogChart {
    let curves = comparison.schemes().into_iter().map(|scheme| {
        let order = comparison.order(scheme, 0);
        let order = order.map_or_else(String::new, |order| format!(", order {}", one_decimal(order)));
        let points = comparison.errors_by_spacing(scheme, 0);
        Curve { label: format!("{}{order}", scheme.name()), points, markers: false }
    });
    let (mut ticks, curves) = (comparison.spacings(), curves.collect::<Vec<_>>());
    ticks.reverse();
    LogChart {
        x: "particle spacing [m]".to_string(),
        guides: guides(&curves, &ticks),
        ..chart(comparison, ticks, curves)
    }
}

fn by_time(comparison: &Comparison) -> LogChart {
    let curve = |scheme: scene::Scheme| {
        let points = comparison.errors_by_time(scheme, 0);
        Curve { label: scheme.name().to_string(), points, markers: false }
    };
    let curves = comparison.schemes().into_iter().map(curve).collect();
    let threads = comparison.trials.first().map_or(0, |trial| trial.threads);
    let x = match threads {
        1 => "processor time of the run, one thread [s]".to_string(),
        _ => "processor time of the run, all threads [s]".to_string(),
    };
    LogChart { x, ..chart(comparison, Vec::new(), curves) }
}

fn chart(comparison: &Comparison, ticks: Vec<f64>, curves: Vec<Curve>) -> LogChart {
    let (scene, figure) = (comparison.plan.scene, comparison.plan.figures[0]);
    let unit = comparison.trials.iter().map(|trial| trial.units[0].as_str()).find(|unit| !unit.is_empty());
    let y = format!("error [{}]", unit.unwrap_or("1"));
    LogChart { title: format!("{scene}: {figure}"), x: String::new(), y, ticks, curves, guides: Vec::new() }
}

/// One decimal, and no sign before a zero.
fn one_decimal(value: f64) -> String {
    format!("{:.1}", (10.0 * value).round() / 10.0 + 0.0)
}

/// Lines of known order through the coarsest point of the first curve.
fn guides(curves: &[Curve], spacings: &[f64]) -> Vec<Curve> {
    let anchor = curves.iter().find_map(|curve| curve.points.first().copied());
    let (Some((h, error)), Some(finest)) = (anchor, spacings.first()) else { return Vec::new() };
    let line = |order: i32| {
        let points = vec![(*finest, error * (finest / h).powi(order)), (h, error)];
        Curve { label: format!("order {order}"), points, markers: false }
    };
    GUIDES.map(line).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::comparison::tests::example;

    #[test]
    fn a_scene_has_four_files_with_orders_in_the_legend() {
        report::prepare_font();
        let folder = tempfile::tempdir().unwrap();
        draw(&example(), folder.path()).unwrap();
        for name in ["spacing.png", "spacing.svg", "time.png", "time.svg"] {
            assert!(folder.path().join(format!("hydrostatic-{name}")).is_file(), "{name}");
        }
        let svg = std::fs::read_to_string(folder.path().join("hydrostatic-spacing.svg")).unwrap();
        assert!(svg.contains("voronoi, order 2.0") && svg.contains("mps, order 1.0") && svg.contains("error [m]"));
    }

    #[test]
    fn a_zero_has_no_sign() {
        assert_eq!([-0.04, 1.96, -0.1].map(one_decimal), ["0.0", "2.0", "-0.1"]);
    }

    #[test]
    fn guides_go_through_the_coarsest_point() {
        let curves = vec![Curve { points: vec![(0.4, 0.16), (0.1, 0.01)], ..Curve::default() }];
        let guides = guides(&curves, &[0.1, 0.4]);
        assert_eq!((guides[0].points[1], guides[1].points[1]), ((0.4, 0.16), (0.4, 0.16)));
        assert!((guides[1].points[0].1 - 0.01).abs() < 1e-12 && (guides[0].points[0].1 - 0.04).abs() < 1e-12);
    }
}
