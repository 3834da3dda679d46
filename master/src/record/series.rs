//! Time series of the recorded variables.

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
