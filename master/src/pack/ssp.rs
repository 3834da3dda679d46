//! A coupled system as a System Structure Package (SSP 1.0): both FMUs, their connections and one named parameter set
//! each, for masters that import such packages.

use super::{Error, LICENCES, Parts, archives, interface_file, write, zipped};
use crate::case::{Case, Fmu};
use components::Interface;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use scene::Scene;
use std::io::{self, Cursor};
use std::path::Path;

const DESCRIPTION: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
const VALUES: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";

type Xml = Writer<Cursor<Vec<u8>>>;

/// What a package is made of.
pub struct System<'a> {
    /// Name of the package and of its parameter sets.
    pub name: &'a str,
    /// The scene, changes applied.
    pub scene: &'a Scene,
    /// Text of the scene file.
    pub text: &'a str,
    /// Changes to the scene, `key=value; key=value`.
    pub overrides: &'a str,
    /// The same as a case, with all connections.
    pub case: &'a Case,
}

/// Writes the package; returns its size in bytes.
pub fn write_package(path: &Path, system: &System) -> Result<usize, Error> {
    let interface = Interface::of(system.scene);
    // The scene with its changes is what the FMUs start with; its text is there by name, for the parameter sets.
    let changed = toml::to_string(system.scene).map_err(|error| Error::file(path, error))?;
    let resources = [
        interface_file(&interface),
        (components::OWN_SCENE.to_string(), changed.into_bytes()),
        (format!("scenes/{}.toml", system.name), system.text.as_bytes().to_vec()),
    ];
    let description = description(system, &interface).map_err(|error| Error::file(path, error))?;
    let values = loose_values(system).map_err(|error| Error::file(path, error))?;
    let mut entries =
        vec![("SystemStructure.ssd".to_string(), description), (format!("resources/{}.ssv", system.name), values)];
    let packed = archives(&interface, &Parts::BOTH, &resources)?;
    let used = |name: &str| system.case.fmu.iter().any(|fmu| format!("{}.fmu", fmu.name) == name);
    entries.extend(
        packed.into_iter().filter(|(name, _)| used(name)).map(|(name, bytes)| (format!("resources/{name}"), bytes)),
    );
    entries.extend(LICENCES.iter().map(|(name, text)| (format!("documentation/{name}"), text.as_bytes().to_vec())));
    let bytes = zipped(entries).map_err(|error| Error::file(path, error))?;
    Ok(write(path, &bytes)?.size)
}

/// SystemStructure.ssd.
fn description(system: &System, interface: &Interface) -> io::Result<Vec<u8>> {
    let mut writer = Writer::new_with_indent(Cursor::new(Vec::new()), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    writer
        .create_element("ssd:SystemStructureDescription")
        .with_attributes([
            ("xmlns:ssd", DESCRIPTION),
            ("xmlns:ssv", VALUES),
            ("xmlns:ssc", COMMON),
            ("name", system.name),
            ("version", "1.0"),
        ])
        .write_inner_content(|writer| {
            writer.create_element("ssd:System").with_attribute(("name", system.name)).write_inner_content(
                |writer| {
                    write_components(writer, system, interface)?;
                    write_connections(writer, system.case)
                },
            )?;
            let stop = system.case.run.end.to_string();
            let span = [("startTime", "0.0"), ("stopTime", stop.as_str())];
            writer.create_element("ssd:DefaultExperiment").with_attributes(span).write_empty()?;
            Ok(())
        })?;
    Ok(writer.into_inner().into_inner())
}

fn write_components(writer: &mut Xml, system: &System, interface: &Interface) -> io::Result<()> {
    writer.create_element("ssd:Elements").write_inner_content(|writer| {
        for fmu in &system.case.fmu {
            let source = format!("resources/{}.fmu", fmu.name);
            writer
                .create_element("ssd:Component")
                .with_attributes([
                    ("name", fmu.name.as_str()),
                    ("type", "application/x-fmu-sharedlibrary"),
                    ("source", source.as_str()),
                ])
                .write_inner_content(|writer| {
                    write_connectors(writer, fmu, system.case, interface)?;
                    write_parameters(writer, system)
                })?;
        }
        Ok(())
    })?;
    Ok(())
}

/// The outputs of an FMU and its connected inputs: some importers refuse a connector of an input that nothing feeds.
/// Units stand in the FMU's own description.
fn write_connectors(writer: &mut Xml, fmu: &Fmu, case: &Case, interface: &Interface) -> io::Result<()> {
    let mut variables = super::reals(&fmu.name, interface);
    let is_fed = |name: &str| case.connection.iter().any(|link| link.to == format!("{}.{name}", fmu.name));
    variables.retain(|(name, kind)| *kind == "output" || is_fed(name));
    element(writer, "ssd:Connectors", &[], |writer| {
        for (name, kind) in &variables {
            element(writer, "ssd:Connector", &[("name", name), ("kind", kind)], |writer| {
                writer.create_element("ssc:Real").write_empty()?;
                Ok(())
            })?;
        }
        Ok(())
    })
}

fn write_parameters(writer: &mut Xml, system: &System) -> io::Result<()> {
    let names = [("version", "1.0"), ("name", system.name)];
    element(writer, "ssd:ParameterBindings", &[], |writer| {
        element(writer, "ssd:ParameterBinding", &[], |writer| {
            element(writer, "ssd:ParameterValues", &[], |writer| write_set(writer, system, &names, &[""]))
        })
    })
}

/// The same values for both FMUs in a file of its own, for importers that take a parameter set from outside.
fn loose_values(system: &System) -> io::Result<Vec<u8>> {
    let mut writer = Writer::new_with_indent(Cursor::new(Vec::new()), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let names = [("xmlns:ssv", VALUES), ("xmlns:ssc", COMMON), ("version", "1.0"), ("name", system.name)];
    let prefixes: Vec<String> = system.case.fmu.iter().map(|fmu| format!("{}.", fmu.name)).collect();
    write_set(&mut writer, system, &names, &prefixes.iter().map(String::as_str).collect::<Vec<_>>())?;
    Ok(writer.into_inner().into_inner())
}

/// A parameter set with the scene and its changes, once for each prefix of the names.
fn write_set(writer: &mut Xml, system: &System, attributes: &[(&str, &str)], prefixes: &[&str]) -> io::Result<()> {
    let values = [("scene", system.name), ("scene_overrides", system.overrides)];
    element(writer, "ssv:ParameterSet", attributes, |writer| {
        element(writer, "ssv:Parameters", &[], |writer| {
            for prefix in prefixes {
                for (name, value) in values.iter().filter(|(_, value)| !value.is_empty()) {
                    let name = format!("{prefix}{name}");
                    element(writer, "ssv:Parameter", &[("name", &name)], |writer| {
                        writer.create_element("ssv:String").with_attribute(("value", *value)).write_empty()?;
                        Ok(())
                    })?;
                }
            }
            Ok(())
        })
    })
}

/// An element with what `inner` writes in it.
fn element(
    writer: &mut Xml,
    name: &str,
    attributes: &[(&str, &str)],
    inner: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    writer.create_element(name).with_attributes(attributes.iter().copied()).write_inner_content(inner)?;
    Ok(())
}

fn write_connections(writer: &mut Xml, case: &Case) -> io::Result<()> {
    writer.create_element("ssd:Connections").write_inner_content(|writer| {
        for link in &case.connection {
            let split = |end: &str| end.split_once('.').map(|(fmu, name)| (fmu.to_string(), name.to_string()));
            let (Some(from), Some(to)) = (split(&link.from), split(&link.to)) else { continue };
            writer
                .create_element("ssd:Connection")
                .with_attributes([
                    ("startElement", from.0.as_str()),
                    ("startConnector", from.1.as_str()),
                    ("endElement", to.0.as_str()),
                    ("endConnector", to.1.as_str()),
                ])
                .write_empty()?;
        }
        Ok(())
    })?;
    Ok(())
}
