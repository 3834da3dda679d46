//! Writes the generated files: `modelDescription/SCENE/*.xml` for the scene of the FMUs that were packed for none and for
//! another one, and the tables in the READMEs of the two FMUs.
//!
//! `cargo run -p components --example describe` from the root of the repository; `-- SCENE.toml FOLDER` writes the XML files
//! of another scene into a folder.

use components::{DEFAULT_SCENE, FluidComponent, Interface, StructureComponent, find_scene};
use fmi::Component;
use fmi2::describe;
use scene::Scene;
use std::error::Error;
use std::path::Path;

/// Scenes of which the descriptions are committed.
const EXAMPLES: [&str; 2] = [DEFAULT_SCENE, "damaged_cabin"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => {
            for name in EXAMPLES {
                let interface = Interface::of(&find_scene(name, "", Some(Path::new(".")))?);
                describe_in(&Path::new("modelDescription").join(name), &interface)?;
            }
            let default = Interface::of_resources(None)?;
            write_table::<FluidComponent>(&default, "fluid-fmu/README.md")?;
            write_table::<StructureComponent>(&default, "structure-fmu/README.md")
        }
        [scene, folder] => describe_in(Path::new(folder), &Interface::of(&Scene::from_file(Path::new(scene))?)),
        _ => Err("expected no arguments, or a scene file and a folder".into()),
    }
}

fn describe_in(folder: &Path, interface: &Interface) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("fluid.xml"), describe::xml(&FluidComponent::model(interface))?)?;
    std::fs::write(folder.join("structure.xml"), describe::xml(&StructureComponent::model(interface))?)?;
    Ok(())
}

fn write_table<C: Component<Interface = Interface>>(interface: &Interface, readme: &str) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(readme)?;
    std::fs::write(readme, describe::with_table(&text, &describe::markdown(&C::model(interface)))?)?;
    Ok(())
}
