//! What the whole system keeps: energy and momentum of water and cabin, from the recorded variables.

use report::record::Series;

/// Energy of water and cabin over time \[J/m\]; empty where a part was not recorded.
pub fn energy(series: &Series) -> Vec<(f64, f64)> {
    const PARTS: [&str; 4] =
        ["fluid.energy.kinetic", "fluid.energy.potential", "structure.energy.kinetic", "structure.energy.potential"];
    let columns: Option<Vec<_>> = PARTS.iter().map(|name| series.column(name)).collect();
    let Some(columns) = columns else { return Vec::new() };
    let sum = |row: usize| columns.iter().map(|column| column.values[row]).sum();
    series.times.iter().enumerate().map(|(row, &time)| (time, sum(row))).collect()
}

/// Largest rise of a curve above its lowest value so far.
pub fn largest_rise(points: &[(f64, f64)]) -> f64 {
    let mut lowest = f64::INFINITY;
    let rise = |&(_, value): &(f64, f64)| {
        lowest = lowest.min(value);
        value - lowest
    };
    points.iter().map(rise).fold(0.0, f64::max)
}

/// Change of the momentum of water and cabin along X up to a time, and what the fixed walls gave \[N s/m\]: they are
/// equal where nothing else acts, without damping zones and contact.
pub fn momentum_along_x(series: &Series, until: f64) -> Option<(f64, f64)> {
    let names = ["fluid.momentum.x", "structure.momentum.x", "fluid.wall.force_x"];
    let [water, cabin, wall] = names.map(|name| series.column(name));
    let (water, cabin, wall) = (water?, cabin?, wall?);
    let rows = series.times.iter().take_while(|&&time| time <= until * (1.0 + 1e-9)).count();
    let last = rows.checked_sub(1)?;
    let change = |values: &[f64]| values[last] - values[0];
    let impulse: f64 = (1..rows)
        .map(|row| 0.5 * (wall.values[row - 1] + wall.values[row]) * (series.times[row] - series.times[row - 1]))
        .sum();
    // The walls push with the opposite of what the water pushes them with.
    Some((change(&water.values) + change(&cabin.values), -impulse))
}

#[cfg(test)]
mod tests {
    use super::*;
    use report::record::Column;

    #[test]
    fn a_rise_is_counted_from_the_lowest_before() {
        let points: Vec<(f64, f64)> = [5.0, 3.0, 4.0, 1.0, 1.5].iter().map(|&value| (0.0, value)).collect();
        assert_eq!(largest_rise(&points), 1.0);
        assert_eq!(largest_rise(&[]), 0.0);
    }

    #[test]
    fn momentum_is_what_the_walls_gave() {
        let column =
            |name: &str, values: &[f64]| Column { name: name.into(), unit: String::new(), values: values.to_vec() };
        let columns = vec![
            column("fluid.momentum.x", &[0.0, 1.0, 3.0, 9.0]),
            column("structure.momentum.x", &[0.0, 0.5, 1.0, 1.0]),
            column("fluid.wall.force_x", &[-1.0, -3.0, -5.0, 0.0]),
        ];
        let series = Series { times: vec![0.0, 0.75, 1.375, 2.0], columns };
        let (change, given) = momentum_along_x(&series, 1.375).unwrap();
        assert_eq!((change, given), (4.0, 0.75 * 2.0 + 0.625 * 4.0));
    }
}
