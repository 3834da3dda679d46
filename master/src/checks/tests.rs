use super::*;
use crate::record::Column;
use scene::Point;

fn check(kind: &str, rest: &str) -> Check {
    toml::from_str(&format!("name = 'c'\nkind = '{kind}'\nvariable = 'a.x'\n{rest}")).unwrap()
}

fn series(rule: impl Fn(f64) -> f64) -> Series {
    let mut series = Series { times: Vec::new(), columns: vec![Column { name: "a.x".into(), ..Column::default() }] };
    (0..=1000).for_each(|i| series.push(i as f64 * 1e-3, &[rule(i as f64 * 1e-3)]));
    series
}

fn evaluate_one(check: &Check, series: &Series, folder: &Path) -> CheckResult {
    let context = Context { series, frames: folder, folder, water: None };
    evaluate(std::slice::from_ref(check), &context).remove("c").unwrap()
}

fn value(kind: &str, rest: &str, rule: impl Fn(f64) -> f64) -> f64 {
    evaluate_one(&check(kind, rest), &series(rule), Path::new("")).value.unwrap()
}

#[test]
fn figures_of_known_series() {
    let sine = |t: f64| 3.0 + 2.0 * (std::f64::consts::TAU * 5.0 * t).sin();
    let near = |found: f64, expected: f64, tolerance: f64| {
        assert!((found - expected).abs() < tolerance, "{found} {expected}");
    };
    near(value("series_frequency", "", sine), 5.0, 1e-4);
    // Root mean square of a sine: amplitude / sqrt(2).
    near(value("series_rms", "scale = 0.5", sine), 1.0 / 2.0_f64.sqrt(), 1e-3);
    near(value("series_mean", "offset = -1.0", sine), 2.0, 1e-2);
    near(value("series_maximum", "", sine), 5.0, 1e-12);
    near(value("series_minimum", "", sine), 1.0, 1e-12);
    near(value("time_of_maximum", "from = 0.1\nto = 0.3", sine), 0.25, 1e-12);
    near(value("series_change", "from = 0.25\nto = 0.75", |t| t * t), 0.5, 1e-12);
    near(value("series_slope", "time_scale = 2.0", |t| 4.0 * t), 2.0, 1e-12);
    near(value("value_at", "from = 0.1234", |t| 10.0 * t), 1.234, 1e-12);
}

#[test]
fn reference_error_and_limit() {
    let within = check("series_mean", "reference = 2.0\nlimit = 0.2\nunit = 'm'");
    let result = evaluate_one(&within, &series(|_| 2.1), Path::new(""));
    assert!((result.error.unwrap() - 0.1).abs() < 1e-12 && result.passed == Some(true) && result.unit == "m");
    let outside = evaluate_one(&within, &series(|_| 2.3), Path::new(""));
    assert_eq!(outside.passed, Some(false));
    let missing = Check { variable: "a.y".into(), ..within };
    let missing = evaluate_one(&missing, &series(|_| 0.0), Path::new(""));
    assert!(missing.value.is_none() && missing.passed == Some(false));
    assert!(missing.problem.unwrap().contains("'a.y'"));
}

#[test]
fn a_free_shift_is_found() {
    let points: Vec<Point> = (0..20).map(|i| [f64::from(i) * 0.05, (f64::from(i) * 0.05 - 0.07).powi(2)]).collect();
    let curve = Check { points, free_shift: true, ..check("curve_rms", "") };
    let result = evaluate_one(&curve, &series(|t| t * t), Path::new(""));
    // The series at t + shift equals (t - 0.07)^2 for shift = -0.07.
    assert!((result.details["shift"] + 0.07).abs() < 1e-3, "{result:?}");
    assert!(result.value.unwrap() < 1e-3);
    let fixed = evaluate_one(&Check { free_shift: false, ..curve }, &series(|t| t * t), Path::new(""));
    assert!(fixed.value.unwrap() > 0.05);
}

#[test]
fn a_band_counts_what_lies_outside() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# from nowhere\nt_s,mean_m,sd,min_m,max_m\n0.0,1.0,0,0.9,1.1\n0.5,1.0,0,0.9,1.1\n";
    std::fs::write(folder.path().join("band.csv"), text).unwrap();
    let columns = "file = 'band.csv'\ncolumns = ['t_s', 'mean_m', 'min_m', 'max_m']";
    // x = 1 + t up to 0.5 s leaves the band at 0.1 s and the widened one at 0.2 s; the worst excess is 0.4.
    let result = evaluate_one(&check("band", columns), &series(|t| 1.0 + t), folder.path());
    assert!((result.value.unwrap() - 0.4).abs() < 1e-9);
    assert!((result.details["share_inside"] - 0.2).abs() < 0.01);
    assert!((result.details["share_inside_with_10_percent"] - 0.4).abs() < 0.01);
    let wrong = check("band", "file = 'band.csv'\ncolumns = ['t_s', 'mean', 'min_m', 'max_m']");
    let wrong = evaluate_one(&wrong, &series(|t| t), folder.path());
    assert!(wrong.problem.unwrap().contains("no column 'mean'"));
}
