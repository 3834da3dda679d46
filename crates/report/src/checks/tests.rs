use super::*;
use crate::record::Column;
use scene::Point;

#[test]
fn what_can_never_be_computed_is_known_before_a_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("good.csv"), "t,p\n0,1\n1,2\n").unwrap();
    std::fs::write(folder.path().join("bad.csv"), "t,p\n0,many\n").unwrap();
    let said = |kind: &str, rest: &str| warnings(&[check(kind, rest)], folder.path()).join("; ");
    assert_eq!(said("series_maximum", ""), "");
    assert_eq!(said("curve_rms", "file = 'good.csv'\ncolumns = ['t', 'p']"), "");
    assert_eq!(said("arrival_time", ""), "check 'c': needs `level`, the value whose first crossing counts");
    assert!(said("series_noise", "").contains("needs `window`"));
    assert!(said("curve_rms", "").contains("needs `points`, or `file` with two `columns`"));
    assert!(said("band", "points = [[0, 1]]").contains("four `columns`"));
    assert!(said("curve_rms", "file = 'good.csv'").contains("`columns` has 0 names, expected 2"));
    let none = said("curve_maximum", "file = 'none.csv'\ncolumns = ['t', 'p']");
    assert!(none.contains("none.csv") && none.contains("cannot be read"), "{none}");
    let column = said("curve_rms", "file = 'good.csv'\ncolumns = ['t', 'q']");
    assert!(column.contains("no column 'q' among its 2"), "{column}");
    assert!(said("curve_rms", "file = 'bad.csv'\ncolumns = ['t', 'p']").contains("row 1, column 'p': no number"));
}

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
    near(value("value_at", "from = 1.0", |t| 10.0 * t), 10.0, 1e-12);
}

#[test]
fn periods_of_jagged_signals() {
    // A period of 0.2 s under a ripple of 130 Hz that crosses the mean several times at each crossing.
    let jagged = |t: f64| (std::f64::consts::TAU * 5.0 * t).cos() + 0.2 * (std::f64::consts::TAU * 130.0 * t).sin();
    let found = value("series_period", "", jagged);
    assert!((found - 0.2).abs() < 0.002, "{found}");
    let share = value("series_period", "time_scale = 5.0", |t| (std::f64::consts::TAU * 5.0 * t).cos());
    assert!((share - 1.0).abs() < 1e-5, "{share}");
    let still = evaluate_one(&check("series_period", ""), &series(|t| t), Path::new(""));
    assert!(still.problem.unwrap().contains("1 upward crossings"));
}

#[test]
fn changes_relative_to_the_start() {
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    // From 10 to 8 above a rest of 6: half of what was there is lost.
    near(value("relative_change", "rest = 6.0", |t| 10.0 - 2.0 * t), -0.5);
    near(value("relative_change", "to = 0.5", |t| 10.0 - 2.0 * t), -0.1);
    // Means over 0.2 s at both ends of a straight line: 0.8 of the way.
    near(value("relative_change", "window = 0.2", |t| 10.0 - 2.0 * t), -0.8 * 2.0 / 9.8);
    let problem = |rest: &str| {
        evaluate_one(&check("relative_change", rest), &series(|t| 10.0 - 2.0 * t), Path::new("")).problem.unwrap()
    };
    assert!(problem("to = 2.0").contains("end at 1 s, expected 2 s"));
    assert!(problem("rest = 10.0").contains("equals the value at rest, 10"));
}

#[test]
fn noise_is_what_a_running_mean_takes_away() {
    // A slope is its own running mean; of a ripple of 100 Hz nothing is left over 50 ms, so all of it is noise.
    let ripple = |t: f64| 5.0 * t + 0.3 * (std::f64::consts::TAU * 100.0 * t).sin();
    let found = value("series_noise", "window = 0.05", ripple);
    assert!((found - 0.3 / 2.0_f64.sqrt()).abs() < 0.01, "{found}");
    let smooth = value("series_noise", "window = 0.05", |t| 5.0 * t);
    assert!(smooth < 1e-12, "{smooth}");
    let short = evaluate_one(&check("series_noise", "window = 2.0"), &series(|t| t), Path::new(""));
    assert!(short.problem.unwrap().contains("window of 2 s"));
}

#[test]
fn arrivals_and_root_means() {
    let found = value("arrival_time", "level = 0.25\ntime_scale = 10.0", |t| (t - 0.4).max(0.0));
    assert!((found - 6.5).abs() < 1e-9, "{found}");
    let never = evaluate_one(&check("arrival_time", "level = 2.0"), &series(|t| t), Path::new(""));
    assert!(never.problem.unwrap().contains("no value exceeds 2"));
    // Mean of t over 0 to 1 is 1/2.
    assert!((value("series_root_mean", "scale = 8.0", |t| t) - 2.0).abs() < 1e-9);
    let negative = evaluate_one(&check("series_root_mean", "scale = -1.0"), &series(|t| t), Path::new(""));
    assert!(negative.problem.unwrap().contains("-0.5"));
}

#[test]
fn distances_to_a_curve_inside_the_window() {
    // The curve lies 0.1 below the series up to 0.5 s and 0.3 below it afterwards.
    let gap = |t: f64| if t <= 0.5 { 0.1 } else { 0.3 };
    let points: Vec<Point> = (0..=10).map(|i| f64::from(i) * 0.1).map(|t| [t, 2.0 - gap(t)]).collect();
    let distance = |kind: &str, rest: &str| {
        let curve = Check { points: points.clone(), ..check(kind, rest) };
        evaluate_one(&curve, &series(|_| 2.0), Path::new("")).value.unwrap()
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    near(distance("curve_maximum", ""), 0.3);
    near(distance("curve_maximum", "to = 0.55"), 0.1);
    near(distance("curve_rms", "to = 0.55"), 0.1);
    near(distance("curve_rms", ""), ((6.0 * 0.01 + 5.0 * 0.09) / 11.0_f64).sqrt());
    // The mean of the reference up to 0.5 s is 1.9.
    near(distance("curve_rms", "to = 0.55\nrelative = true"), 0.1 / 1.9);
}

#[test]
fn means_over_a_window_are_compared_with_a_curve() {
    let curve = |rest: &str, value: &dyn Fn(f64) -> f64| {
        let points = vec![[0.05, 0.0], [0.3, 0.0], [0.62, 0.0]];
        let curve = Check { points, ..check("curve_maximum", rest) };
        let result = evaluate_one(&curve, &series(value), Path::new(""));
        (result.value.unwrap(), result.details["points_compared"])
    };
    // A spike of one record, 0.001 s apart from its neighbours: its triangle has an area of 0.001.
    let spike = |t: f64| if (t - 0.3).abs() < 1e-9 { 1.0 } else { 0.0 };
    assert_eq!(curve("", &spike).0, 1.0);
    let (found, compared) = curve("window = 0.1", &spike);
    assert!((found - 0.01).abs() < 1e-9 && compared == 3.0, "{found} {compared}");
    // Ends between the records count too: of t^2 the mean over 0.6195 to 0.6205 of the lines between the records.
    let (found, _) = curve("window = 0.001", &|t| t * t);
    let between = 0.5 * (0.619 * 0.619 + 0.62 * 0.62);
    let after = 0.5 * (0.62 * 0.62 + 0.621 * 0.621);
    let expected = 0.25 * (between + 2.0 * 0.62 * 0.62 + after);
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    // The first point has no whole window about it.
    assert_eq!(curve("window = 0.12", &spike).1, 2.0);
}

#[test]
fn water_at_rest_over_all_frames_in_a_window() {
    use frames::{Field, Frame, Series as Frames};
    let folder = tempfile::tempdir().unwrap();
    let mut frames = Frames::new(folder.path(), "particles", 0.0, 1.0).unwrap();
    // Exact but for an offset of 0, 1, 3 per cent of rho g H = 1000 * 10 * 2 Pa.
    for (number, offset) in [0.0, 200.0, 600.0].into_iter().enumerate() {
        let heights = [0.25_f32, 1.0, 1.75];
        let pressures = heights.map(|y| 1e4 * (2.0 - y) + offset).to_vec();
        let points = heights.map(|y| [0.0, y]).to_vec();
        let frame = Frame { points, lines: Vec::new(), fields: vec![Field::Scalar("pressure", pressures)] };
        frames.write(number as u64, number as f64, frame).unwrap();
    }
    let empty = Series::default();
    let error = |rest: &str| {
        let context =
            Context { series: &empty, frames: folder.path(), folder: Path::new(""), water: Some((1e3, 10.0)) };
        let check = check("hydrostatic_pressure", &format!("depth = 2.0\n{rest}"));
        evaluate(&[check], &context).remove("c").unwrap()
    };
    assert!((error("").value.unwrap() - 0.03).abs() < 1e-7);
    assert!((error("from = 1.0").value.unwrap() - (0.5_f64 * (0.01 * 0.01 + 0.03 * 0.03)).sqrt()).abs() < 1e-7);
    assert!((error("from = 0.0\nto = 1.0").value.unwrap() - 0.01 / 2.0_f64.sqrt()).abs() < 1e-7);
    assert!(error("from = 5.0").problem.unwrap().contains("no frame in the window"));
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
