//! Writes the generated files: modelDescription/*.xml and the tables in the READMEs of the two FMUs.
//!
//! `cargo run -p components --example describe` from the root of the repository; `-- MODES FOLDER` writes the two XML
//! files for another number of modes into a folder.

use components::{DEFAULT_MODES, FluidComponent, StructureComponent};
use fmi2::{Component, describe};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => {
            write::<FluidComponent>("modelDescription/fluid.xml", "fluid-fmu/README.md")?;
            write::<StructureComponent>("modelDescription/structure.xml", "structure-fmu/README.md")
        }
        [modes, folder] => {
            let (modes, folder) = (modes.parse()?, Path::new(folder));
            std::fs::write(folder.join("fluid.xml"), describe::xml(&FluidComponent::model(modes))?)?;
            std::fs::write(folder.join("structure.xml"), describe::xml(&StructureComponent::model(modes))?)?;
            Ok(())
        }
        _ => Err("expected no arguments, or the number of modes and a folder".into()),
    }
}

fn write<C: Component>(xml: &str, readme: &str) -> Result<(), Box<dyn Error>> {
    let model = C::model(DEFAULT_MODES);
    std::fs::write(xml, describe::xml(&model)?)?;
    let text = std::fs::read_to_string(readme)?;
    std::fs::write(readme, describe::with_table(&text, &describe::markdown(&model))?)?;
    Ok(())
}
