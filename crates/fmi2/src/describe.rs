//! modelDescription.xml and the table of the documentation, from the table of variables.

use fmi::{Access, CATEGORIES, Causality, Component, Failure, Initial, Model, Variability, Variable};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;
use uuid::Uuid;

type Xml = Writer<Vec<u8>>;

/// The GUID: a hash of everything else in the XML, so that no two different interfaces share one.
pub fn guid<C: Component>(model: &Model<C>) -> Result<Uuid, Failure> {
    Ok(Uuid::new_v5(&Uuid::NAMESPACE_URL, xml_with(model, "")?.as_bytes()))
}

/// modelDescription.xml. The GUID has no braces: some importers pass on what they find between them.
pub fn xml<C: Component>(model: &Model<C>) -> Result<String, Failure> {
    xml_with(model, &guid(model)?.to_string())
}

fn xml_with<C: Component>(model: &Model<C>, guid: &str) -> Result<String, Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::refused(format!("modelDescription.xml: {error}"));
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    write_all(&mut writer, model, guid).map_err(|error| failed(&error))?;
    let mut text = String::from_utf8(writer.into_inner()).map_err(|error| failed(&error))?;
    text.push('\n');
    Ok(text)
}

fn write_all<C>(writer: &mut Xml, model: &Model<C>, guid: &str) -> io::Result<()> {
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    writer
        .create_element("fmiModelDescription")
        .with_attribute(("fmiVersion", "2.0"))
        .with_attribute(("modelName", model.name))
        .with_attribute(("guid", guid))
        .with_attribute(("description", model.description))
        .with_attribute(("version", env!("CARGO_PKG_VERSION")))
        .with_attribute(("license", "MIT OR Apache-2.0"))
        .with_attribute(("generationTool", concat!("Plimsoll ", env!("CARGO_PKG_VERSION"))))
        .with_attribute(("variableNamingConvention", "structured"))
        .with_attribute(("numberOfEventIndicators", "0"))
        .write_inner_content(|writer| {
            write_capabilities(writer, model)?;
            write_units(writer, model)?;
            write_types(writer, model)?;
            write_categories(writer)?;
            write_experiment(writer, model)?;
            write_annotations(writer, model)?;
            write_variables(writer, model)?;
            write_structure(writer, model)
        })?;
    Ok(())
}

fn write_capabilities<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    writer
        .create_element("CoSimulation")
        .with_attribute(("modelIdentifier", model.identifier))
        .with_attribute(("canHandleVariableCommunicationStepSize", "true"))
        .with_attribute(("canInterpolateInputs", "false"))
        .with_attribute(("maxOutputDerivativeOrder", "0"))
        .with_attribute(("canRunAsynchronuously", "false"))
        .with_attribute(("canBeInstantiatedOnlyOncePerProcess", "false"))
        .with_attribute(("canNotUseMemoryManagementFunctions", "true"))
        .with_attribute(("canGetAndSetFMUstate", "true"))
        .with_attribute(("canSerializeFMUstate", "true"))
        .with_attribute(("providesDirectionalDerivative", flag(model.directional_derivatives)))
        .write_empty()?;
    Ok(())
}

fn flag(value: bool) -> &'static str {
    if value { "true" } else { "false" }
}

fn write_units<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    writer.create_element("UnitDefinitions").write_inner_content(|writer| {
        for unit in &model.units {
            let element = writer.create_element("Unit").with_attribute(("name", unit.name));
            let Some(exponents) = unit.exponents else {
                element.write_empty()?;
                continue;
            };
            element.write_inner_content(|writer| {
                let mut base = writer.create_element("BaseUnit");
                for (name, exponent) in ["kg", "m", "s", "rad"].into_iter().zip(exponents) {
                    if exponent != 0 {
                        base = base.with_attribute((name, exponent.to_string().as_str()));
                    }
                }
                base.write_empty()?;
                Ok(())
            })?;
        }
        Ok(())
    })?;
    Ok(())
}

fn write_types<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    writer.create_element("TypeDefinitions").write_inner_content(|writer| {
        for simple in &model.types {
            writer
                .create_element("SimpleType")
                .with_attribute(("name", simple.name))
                .with_attribute(("description", simple.description))
                .write_inner_content(|writer| {
                    writer
                        .create_element("Real")
                        .with_attribute(("quantity", simple.quantity))
                        .with_attribute(("unit", simple.unit))
                        .write_empty()?;
                    Ok(())
                })?;
        }
        Ok(())
    })?;
    Ok(())
}

fn write_categories(writer: &mut Xml) -> io::Result<()> {
    writer.create_element("LogCategories").write_inner_content(|writer| {
        for (name, description) in CATEGORIES {
            writer
                .create_element("Category")
                .with_attribute(("name", name))
                .with_attribute(("description", description))
                .write_empty()?;
        }
        Ok(())
    })?;
    Ok(())
}

fn write_experiment<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    writer
        .create_element("DefaultExperiment")
        .with_attribute(("startTime", "0"))
        .with_attribute(("stopTime", model.experiment.stop.to_string().as_str()))
        .with_attribute(("stepSize", model.experiment.step.to_string().as_str()))
        .write_empty()?;
    Ok(())
}

fn write_annotations<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    if model.annotations.is_empty() {
        return Ok(());
    }
    writer.create_element("VendorAnnotations").write_inner_content(|writer| {
        writer.create_element("Tool").with_attribute(("name", "Plimsoll")).write_inner_content(|writer| {
            // The schema allows one element in here, of any kind.
            writer.create_element("Annotations").write_inner_content(|writer| {
                for (name, text) in &model.annotations {
                    writer
                        .create_element("Annotation")
                        .with_attribute(("name", *name))
                        .with_attribute(("text", *text))
                        .write_empty()?;
                }
                Ok(())
            })?;
            Ok(())
        })?;
        Ok(())
    })?;
    Ok(())
}

fn write_variables<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    writer.create_element("ModelVariables").write_inner_content(|writer| {
        for variable in &model.variables {
            let mut element = writer
                .create_element("ScalarVariable")
                .with_attribute(("name", variable.name.as_str()))
                .with_attribute(("valueReference", variable.reference.to_string().as_str()))
                .with_attribute(("description", variable.description.as_str()))
                .with_attribute(("causality", causality(variable)))
                .with_attribute(("variability", variability(variable)));
            if let Some(initial) = variable.initial() {
                element = element.with_attribute(("initial", initial_name(initial)));
            }
            element.write_inner_content(|writer| write_type(writer, model, variable))?;
        }
        Ok(())
    })?;
    Ok(())
}

fn write_type<C>(writer: &mut Xml, model: &Model<C>, variable: &Variable<C>) -> io::Result<()> {
    let (name, attributes) = type_attributes(model, variable);
    let mut element = writer.create_element(name);
    for (name, value) in &attributes {
        element = element.with_attribute((*name, value.as_str()));
    }
    element.write_empty()?;
    Ok(())
}

fn type_attributes<C>(model: &Model<C>, variable: &Variable<C>) -> (&'static str, Vec<(&'static str, String)>) {
    fn numbers<T: ToString>(list: [(&'static str, Option<T>); 4]) -> Vec<(&'static str, String)> {
        list.into_iter().filter_map(|(name, value)| Some((name, value?.to_string()))).collect()
    }
    match variable.access {
        Access::Real { start, minimum, maximum, nominal, simple_type, .. } => {
            let mut attributes = Vec::new();
            if let Some(simple) = model.types.iter().find(|simple| Some(simple.name) == simple_type) {
                attributes.push(("declaredType", simple.name.to_string()));
                attributes.push(("unit", simple.unit.to_string()));
            }
            attributes.extend(numbers([("min", minimum), ("max", maximum), ("nominal", nominal), ("start", start)]));
            ("Real", attributes)
        }
        Access::Integer { start, minimum, maximum, .. } => {
            ("Integer", numbers([("min", minimum), ("max", maximum), ("start", start), ("", None)]))
        }
        Access::Text { start, .. } => ("String", start.map(|start| ("start", start.to_string())).into_iter().collect()),
    }
}

fn causality<C>(variable: &Variable<C>) -> &'static str {
    match variable.causality {
        Causality::Parameter => "parameter",
        Causality::Input => "input",
        Causality::Output => "output",
    }
}

fn variability<C>(variable: &Variable<C>) -> &'static str {
    match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

fn initial_name(initial: Initial) -> &'static str {
    match initial {
        Initial::Exact => "exact",
        Initial::Calculated => "calculated",
    }
}

/// Dependencies are written out: left out they would mean "on everything", and importers would see algebraic loops.
fn write_structure<C>(writer: &mut Xml, model: &Model<C>) -> io::Result<()> {
    let index = |wanted: &dyn Fn(&Variable<C>) -> bool| {
        let found = model.variables.iter().enumerate().filter(|(_, variable)| wanted(variable));
        found.map(|(position, _)| (position + 1).to_string()).collect::<Vec<_>>().join(" ")
    };
    let parameters = index(&|variable| variable.causality == Causality::Parameter);
    let outputs = || model.variables.iter().enumerate().filter(|(_, variable)| variable.causality == Causality::Output);
    writer.create_element("ModelStructure").write_inner_content(|writer| {
        writer.create_element("Outputs").write_inner_content(|writer| {
            for (position, output) in outputs() {
                let dependencies = index(&|variable| output.dependencies.contains(&variable.reference));
                write_unknown(writer, position, &dependencies)?;
            }
            Ok(())
        })?;
        writer.create_element("InitialUnknowns").write_inner_content(|writer| {
            for (position, _) in outputs() {
                write_unknown(writer, position, &parameters)?;
            }
            Ok(())
        })?;
        Ok(())
    })?;
    Ok(())
}

fn write_unknown(writer: &mut Xml, position: usize, dependencies: &str) -> io::Result<()> {
    writer
        .create_element("Unknown")
        .with_attribute(("index", (position + 1).to_string().as_str()))
        .with_attribute(("dependencies", dependencies))
        .write_empty()?;
    Ok(())
}

/// The table of variables in Markdown.
pub fn markdown<C>(model: &Model<C>) -> String {
    let mut text =
        String::from("| reference | name | role | type | unit | start | meaning |\n|---|---|---|---|---|---|---|\n");
    for variable in &model.variables {
        let (kind, attributes) = type_attributes(model, variable);
        let attribute =
            |wanted: &str| attributes.iter().find(|(name, _)| *name == wanted).map_or("", |(_, value)| value.as_str());
        text += &format!(
            "| {} | `{}` | {} | {} | {} | {} | {} |\n",
            variable.reference,
            variable.name,
            causality(variable),
            kind,
            attribute("unit"),
            attribute("start"),
            variable.description
        );
    }
    text
}

const BEGIN: &str = "<!-- table of variables: generated -->\n";
const END: &str = "<!-- end of the table -->";

/// `document` with the text between the two markers of the table replaced.
pub fn with_table(document: &str, table: &str) -> Result<String, Failure> {
    let missing = |marker: &str| Failure::refused(format!("the document has no line '{}'", marker.trim()));
    let (before, rest) = document.split_once(BEGIN).ok_or_else(|| missing(BEGIN))?;
    let (_, after) = rest.split_once(END).ok_or_else(|| missing(END))?;
    Ok(format!("{before}{BEGIN}{table}{END}{after}"))
}
