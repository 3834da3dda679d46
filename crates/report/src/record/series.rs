//! Time series of the recorded variables.

use super::Error;
use std::path::Path;

/// One recorded variable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// `participant.variable`.
    pub name: String,
    /// Unit; empty when it has none.
    pub unit: String,
    /// One value per time.
    pub values: Vec<f64>,
}

impl Column {
    /// Name and unit for a header or an axis.
    pub fn header(&self) -> String {
        if self.unit.is_empty() { format!("{} [1]", self.name) } else { format!("{} [{}]", self.name, self.unit) }
    }
}

/// All recorded variables at the recorded times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Times \[s\].
    pub times: Vec<f64>,
    /// Variables in the order of the results table.
    pub columns: Vec<Column>,
}

impl Series {
    /// Reads a table as results.csv is written: times first, names and units in the header.
    ///
    /// # Errors
    /// A file that cannot be read, a header without units, times in another unit than seconds or not in their order, or
    /// an entry that is no number.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let wrong = |reason: &dyn ToString| Error::new(path, reason.to_string());
        let mut reader = csv::Reader::from_path(path).map_err(|error| wrong(&error))?;
        let mut series = Self::default();
        let headers = reader.headers().map_err(|error| wrong(&error))?;
        if let Some(first) = headers.get(0).filter(|first| first.contains(" [") && !first.ends_with(" [s]")) {
            return Err(wrong(&format!("`{first}`: expected times in [s]")));
        }
        for header in headers.iter().skip(1) {
            let parts = header.strip_suffix(']').and_then(|text| text.rsplit_once(" ["));
            let (name, unit) = parts.ok_or_else(|| wrong(&format!("`{header}`: expected `name [unit]`")))?;
            series.columns.push(Column { name: name.to_string(), unit: unit.to_string(), values: Vec::new() });
        }
        for (row, record) in reader.records().enumerate() {
            let record = record.map_err(|error| wrong(&error))?;
            let numbers: Result<Vec<f64>, _> = record.iter().map(str::parse).collect();
            let numbers = numbers.map_err(|error| wrong(&format!("row {}: {error}", row + 1)))?;
            let (time, last) = (numbers[0], series.times.last().copied().unwrap_or(f64::NEG_INFINITY));
            if !time.is_finite() || time < last {
                let after = if row > 0 { format!(" after {last} s") } else { String::new() };
                return Err(wrong(&format!("row {}: time {time} s{after}: expected times that do not fall", row + 1)));
            }
            series.push(time, &numbers[1..]);
        }
        Ok(series)
    }

    /// The column called `name`.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Appends one row; `values` has one entry per column.
    pub fn push(&mut self, time: f64, values: &[f64]) {
        self.times.push(time);
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.values.push(*value));
    }

    /// Pairs of time and value of a column.
    pub fn points<'a>(&'a self, column: &'a Column) -> impl Iterator<Item = (f64, f64)> + 'a {
        self.times.iter().copied().zip(column.values.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_with_its_units() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.csv");
        std::fs::write(&path, "time [s],a.x [m],\"a.q [m.sqrt(kg/m)]\"\n0,1,2\n0.5,-3,4e-3\n").unwrap();
        let series = Series::read(&path).unwrap();
        assert_eq!(series.times, [0.0, 0.5]);
        assert_eq!(series.column("a.q").map(|it| (it.unit.as_str(), it.values[1])), Some(("m.sqrt(kg/m)", 0.004)));
        std::fs::write(&path, "time [s],a.x [m]\n0,one\n").unwrap();
        let text = Series::read(&path).unwrap_err().to_string();
        assert!(text.contains("row 1"), "{text}");
        std::fs::write(&path, "t,x\n0,1\n").unwrap();
        assert!(Series::read(&path).unwrap_err().to_string().contains("name [unit]"));
    }
}
