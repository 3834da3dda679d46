//! results.parquet: the columns of results.csv, with the same names, for tools that read tables by column.

use super::{Error, Series, write_whole};
use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::path::Path;
use std::sync::Arc;

/// Writes all recorded variables: one column of doubles each, named `name [unit]`, times first.
pub fn write_parquet(path: &Path, series: &Series) -> Result<(), Error> {
    let wrong = |reason: &dyn ToString| Error::new(path, reason.to_string());
    let mut content = Vec::new();
    write(&mut content, series).map_err(|error| wrong(&error))?;
    write_whole(path, content)
}

fn write(content: &mut Vec<u8>, series: &Series) -> Result<(), ParquetError> {
    let names = std::iter::once("time [s]".to_string()).chain(series.columns.iter().map(super::Column::header));
    let double = |name: String| {
        let field = Type::primitive_type_builder(&name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
        field.build().map(Arc::new)
    };
    let fields = names.map(double).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("results").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(content, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let mut values = std::iter::once(&series.times).chain(series.columns.iter().map(|column| &column.values));
    while let (Some(mut column), Some(values)) = (group.next_column()?, values.next()) {
        column.typed::<DoubleType>().write_batch(values, None, None)?;
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Column;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;
    use std::fs::File;

    #[test]
    fn the_table_reads_back_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.parquet");
        let column = Column { name: "a.x".into(), unit: "m".into(), values: vec![0.1 + 0.2, -1e-300] };
        write_parquet(&path, &Series { times: vec![0.0, 0.5], columns: vec![column] }).unwrap();
        let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        let names: Vec<&String> = rows[0].get_column_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["time [s]", "a.x [m]"]);
        assert_eq!((rows[0].get_double(1).unwrap(), rows[1].get_double(1).unwrap()), (0.1 + 0.2, -1e-300));
    }
}
