//! The record as a page of Markdown.

use super::Record;
use super::comparison::{Comparison, Factor};
use super::trial::Trial;
use report::Short;
use report::machine;
use scene::Scheme;

/// The page. Pictures lie beside it.
pub fn markdown(record: &Record) -> String {
    let mut text = "# Accuracy of the schemes by spacing and by run time\n\n".to_string();
    text += &circumstances(record);
    text += &overview(record);
    for comparison in &record.comparisons {
        text += &section(comparison);
    }
    text
}

fn circumstances(record: &Record) -> String {
    machine::table(&record.circumstances, record.load, record.repeats)
        + "Times are processor time, which other programs on the machine hardly change; the wall-clock time stands beside \
           it. `docs/benchmarks/README.md` says how to read and \
           repeat this.\n\n"
}

fn overview(record: &Record) -> String {
    let mut text =
        "## Overview\n\nErrors at the finest spacing, orders by least squares, and the factor: time of `mps` \
                    over time of `voronoi` at equal error, once at the error of the coarsest run of `voronoi`, once at \
                    the smallest error of `mps`.\n\n"
            .to_string();
    text += "| scene | figure | unit | spacing [m] | error, voronoi | order | error, mps | order | factor at coarsest of \
             voronoi | factor at best of mps |\n|---|---|---|---|---|---|---|---|---|---|\n";
    for comparison in &record.comparisons {
        for figure in 0..comparison.plan.figures.len() {
            text += &overview_row(comparison, figure);
        }
    }
    text + "\n"
}

fn overview_row(comparison: &Comparison, figure: usize) -> String {
    let runs = comparison.runs(Scheme::Voronoi);
    let coarsest = runs.iter().find(|trial| trial.errors[figure].is_some());
    let finest = |scheme| number(comparison.runs(scheme).last().and_then(|trial| trial.errors[figure]));
    let order = |scheme| decimal(comparison.order(scheme, figure));
    format!(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
        comparison.plan.scene,
        comparison.plan.figures[figure],
        unit(comparison, figure),
        number(comparison.spacings().last().copied()),
        finest(Scheme::Voronoi),
        order(Scheme::Voronoi),
        finest(Scheme::Mps),
        order(Scheme::Mps),
        brief(coarsest.and_then(|trial| comparison.factor(trial, figure))),
        brief(comparison.factor_at_best_of_mps(figure)),
    )
}

fn unit(comparison: &Comparison, figure: usize) -> &str {
    let units = comparison.trials.iter().map(|trial| trial.units[figure].as_str());
    units.into_iter().find(|unit| !unit.is_empty()).unwrap_or("1")
}

fn section(comparison: &Comparison) -> String {
    let plan = &comparison.plan;
    let mut text = format!("## {}\n\n{}.", plan.scene, comparison.title.trim_end_matches('.'));
    if let Some(end) = plan.end.filter(|end| *end != comparison.scene_end) {
        text += &format!(" Run to {end} s instead of {} s.", comparison.scene_end);
    }
    if !plan.note.is_empty() {
        text += &format!(" {}", plan.note);
    }
    text += "\n\n| scheme | spacing [m] | time [s] | wall-clock [s] | threads | steps | particles | particle-steps | per \
             second | pressure iterations | particles lost | area change | remark |\n\
             |---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for scheme in comparison.schemes() {
        comparison.runs(scheme).iter().for_each(|trial| text += &work_row(trial));
    }
    for (figure, name) in plan.figures.iter().enumerate() {
        text += &format!("\n**{name}** [{}]\n\n", unit(comparison, figure));
        text += &errors(comparison, figure);
    }
    let scene = plan.scene;
    text + &format!("\n![error against spacing]({scene}-spacing.png) ![error against time]({scene}-time.png)\n\n")
}

fn work_row(trial: &Trial) -> String {
    let work = &trial.work;
    let remark = trial.problem.replace('|', "/").replace('\n', " ");
    format!(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {remark} |\n",
        trial.scheme.name(),
        trial.spacing,
        Short(trial.seconds()),
        Short(trial.wall),
        trial.threads,
        work.steps,
        work.particles,
        Short(work.particle_steps),
        Short(work.particle_steps / trial.seconds()),
        work.iterations,
        work.lost,
        number(work.area_change),
    )
}

fn errors(comparison: &Comparison, figure: usize) -> String {
    let mut text = "| scheme | spacing [m] | error | order | time [s] | mps time / voronoi time at this error |\n\
                    |---|---|---|---|---|---|\n"
        .to_string();
    for scheme in comparison.schemes() {
        for trial in comparison.runs(scheme) {
            text += &format!(
                "| {} | {} | {} | {} | {} | {} |\n",
                scheme.name(),
                trial.spacing,
                number(trial.errors[figure]),
                decimal(comparison.order_since(trial, figure)),
                Short(trial.seconds()),
                full(comparison.factor(trial, figure)),
            );
        }
        text += &format!("| {} | all | | {} | | |\n", scheme.name(), decimal(comparison.order(scheme, figure)));
    }
    text
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_string(), |value| Short(value).to_string())
}

fn decimal(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_string(), |value| format!("{value:.2}"))
}

/// A factor with two significant digits, fewer below 0.1.
fn ratio(value: f64) -> String {
    let decimals = match value {
        9.95.. => 0,
        0.95.. => 1,
        _ => 2,
    };
    format!("{value:.decimals$}")
}

fn brief(factor: Option<Factor>) -> String {
    match factor {
        None => "-".to_string(),
        Some(Factor::Equal(factor)) => ratio(factor),
        Some(Factor::AtMost(factor)) => format!("at most {}", ratio(factor)),
        Some(Factor::MoreThan { factor, .. }) => format!("above {}", ratio(factor)),
    }
}

fn full(factor: Option<Factor>) -> String {
    match factor {
        Some(Factor::MoreThan { nearest: Some((error, time)), .. }) => {
            let nearest = format!("{} in {} s", Short(error), Short(time));
            format!("{}: not reached, nearest {nearest}", brief(factor))
        }
        Some(Factor::AtMost(_)) => format!("{}: the coarsest run is better", brief(factor)),
        _ => brief(factor),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::comparison::tests::example;
    use report::machine::Circumstances;

    #[test]
    fn the_page_says_orders_factors_and_failures() {
        let mut comparison = example();
        comparison.trials[1].problem = "failed at 0.1 s".to_string();
        comparison.trials[1].errors = vec![None];
        let (circumstances, load) = (Circumstances::now(), (Some(2.25), None));
        let page = markdown(&Record { circumstances, load, repeats: 3, comparisons: vec![comparison] });
        let has = |text: &str| assert!(page.contains(text), "no '{text}' in\n{page}");
        has("| hydrostatic | pressure | m | 0.1000 | 0.01000 | 2.00 | 1.000 | 1.00 | above 128 | above 128 |");
        has("Run to 2 s instead of 10 s.");
        has("| mps | 0.4 | - | - | 31.25 | - |");
        has("| failed at 0.1 s |");
        has("above 128: not reached, nearest 1.000 in 2000 s");
        has("2.2 and unknown");
        has("![error against spacing](hydrostatic-spacing.png)");
    }

    #[test]
    fn factors_are_short() {
        assert_eq!((ratio(3.26), ratio(12.34), ratio(0.054)), ("3.3".into(), "12".into(), "0.05".into()));
        assert_eq!(full(Some(Factor::AtMost(0.5))), "at most 0.50: the coarsest run is better");
        assert_eq!(brief(None), "-");
    }
}
