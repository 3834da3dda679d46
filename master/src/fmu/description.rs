//! Reads the parts of modelDescription.xml that an importer for co-simulation needs (FMI 2.0.5, sections 2.2 and 4.3).

use coupling::participant::{Causality, Description, Kind, UNLIMITED, Variable};
use serde::Deserialize;

/// What instantiating takes beside the description.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Name of the shared library without extension.
    pub identifier: String,
    /// To be handed back at instantiation.
    pub guid: String,
    /// Variables and capabilities.
    pub description: Description,
}

#[derive(Deserialize)]
struct Root {
    #[serde(rename = "@guid")]
    guid: String,
    #[serde(rename = "CoSimulation")]
    co_simulation: Option<CoSimulation>,
    #[serde(rename = "TypeDefinitions", default)]
    types: TypeDefinitions,
    #[serde(rename = "ModelVariables")]
    variables: ModelVariables,
}

/// What every version of the standard has.
#[derive(Deserialize)]
struct Version {
    #[serde(rename = "@fmiVersion")]
    version: String,
}

/// What the parser says, in words of the document.
fn plain(error: quick_xml::DeError) -> String {
    let text = error.to_string().replace("missing field `@", "missing attribute `");
    digits::rounded(&text.replace("missing field", "missing element").replace("unknown variant", "unknown word"))
}

#[derive(Deserialize)]
struct CoSimulation {
    #[serde(rename = "@modelIdentifier")]
    identifier: String,
    #[serde(rename = "@canGetAndSetFMUstate", default)]
    saves_states: bool,
    #[serde(rename = "@canSerializeFMUstate", default)]
    serialises_states: bool,
    #[serde(rename = "@canHandleVariableCommunicationStepSize", default)]
    variable_step: bool,
    #[serde(rename = "@providesDirectionalDerivative", default)]
    derivatives: bool,
}

#[derive(Deserialize, Default)]
struct TypeDefinitions {
    #[serde(rename = "SimpleType", default)]
    simple: Vec<SimpleType>,
}

#[derive(Deserialize)]
struct SimpleType {
    #[serde(rename = "@name")]
    name: String,
    #[serde(rename = "Real")]
    real: Option<Typed>,
    #[serde(rename = "Integer")]
    integer: Option<Typed>,
}

#[derive(Deserialize)]
struct ModelVariables {
    #[serde(rename = "ScalarVariable", default)]
    scalars: Vec<Scalar>,
}

#[derive(Deserialize)]
struct Scalar {
    #[serde(rename = "@name")]
    name: String,
    #[serde(rename = "@valueReference")]
    reference: u32,
    #[serde(rename = "@causality", default)]
    causality: String,
    #[serde(rename = "@description", default)]
    description: String,
    #[serde(rename = "Real")]
    real: Option<Typed>,
    #[serde(rename = "Integer")]
    integer: Option<Typed>,
    #[serde(rename = "Enumeration")]
    enumeration: Option<Typed>,
    #[serde(rename = "Boolean")]
    boolean: Option<Typed>,
}

#[derive(Deserialize)]
struct Typed {
    #[serde(rename = "@unit", default)]
    unit: String,
    #[serde(rename = "@declaredType", default)]
    declared: String,
    #[serde(rename = "@min")]
    least: Option<f64>,
    #[serde(rename = "@max")]
    most: Option<f64>,
}

impl Model {
    /// Parses the text of modelDescription.xml; the error says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        // Other versions of the standard have other elements: the version comes before all that lacks then.
        let Version { version } = quick_xml::de::from_str(text).map_err(plain)?;
        if version != "2.0" {
            let family = version.split('.').next().unwrap_or_default();
            return Err(format!("this is an FMU of FMI {family}: fmiVersion is '{version}', expected '2.0'"));
        }
        let root: Root = quick_xml::de::from_str(text).map_err(plain)?;
        let co_simulation =
            root.co_simulation.ok_or("there is no CoSimulation element: this FMU is for model exchange only")?;
        check_identifier(&co_simulation.identifier)?;
        let variables = root.variables.scalars.into_iter().map(|scalar| scalar.resolve(&root.types)).collect();
        Ok(Self {
            identifier: co_simulation.identifier,
            guid: root.guid,
            description: Description {
                variables,
                saves_states: co_simulation.saves_states,
                serialises_states: co_simulation.saves_states && co_simulation.serialises_states,
                variable_step: co_simulation.variable_step,
                derivatives: co_simulation.derivatives,
            },
        })
    }
}

/// The name of a file in one folder: what leads elsewhere would load a library that is not the FMU's.
fn check_identifier(name: &str) -> Result<(), String> {
    let parts: Vec<_> = std::path::Path::new(name).components().collect();
    let plain = matches!(parts[..], [std::path::Component::Normal(part)] if part == name);
    if plain && !name.contains(['/', '\\', ':', '\0']) {
        return Ok(());
    }
    Err(format!("modelIdentifier is '{name}', expected the name of a library, without folders"))
}

impl Scalar {
    fn resolve(self, types: &TypeDefinitions) -> Variable {
        let kind = match (&self.real, self.integer.is_some() || self.enumeration.is_some(), &self.boolean) {
            (Some(_), ..) => Kind::Real,
            (_, true, _) => Kind::Integer,
            (_, _, Some(_)) => Kind::Boolean,
            _ => Kind::String,
        };
        let causality = match self.causality.as_str() {
            "parameter" => Causality::Parameter,
            "input" => Causality::Input,
            "output" => Causality::Output,
            _ => Causality::Other,
        };
        let typed = self.real.as_ref().or(self.integer.as_ref()).or(self.enumeration.as_ref());
        let range = typed.map_or(UNLIMITED, |typed| typed.range_with(types));
        let unit = self.real.map_or_else(String::new, |real| real.unit_with(types));
        let (name, description) = (self.name, self.description);
        Variable { name, reference: self.reference, kind, causality, unit, description, range }
    }
}

impl Typed {
    /// The variable's own limits, or those of its declared type.
    fn range_with(&self, types: &TypeDefinitions) -> [f64; 2] {
        let declared = types.simple.iter().find(|simple| simple.name == self.declared);
        let declared = declared.and_then(|simple| simple.real.as_ref().or(simple.integer.as_ref()));
        let [least, most] = UNLIMITED;
        let limit = |read: fn(&Self) -> Option<f64>| read(self).or(declared.and_then(read));
        [limit(|typed| typed.least).unwrap_or(least), limit(|typed| typed.most).unwrap_or(most)]
    }

    /// The variable's own unit, or that of its declared type.
    fn unit_with(self, types: &TypeDefinitions) -> String {
        if !self.unit.is_empty() || self.declared.is_empty() {
            return self.unit;
        }
        let declared = types.simple.iter().find(|simple| simple.name == self.declared);
        declared.and_then(|simple| simple.real.as_ref()).map_or_else(String::new, |real| real.unit.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const XML: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{1}">
  <CoSimulation modelIdentifier="m" canGetAndSetFMUstate="true"/>
  <UnitDefinitions><Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit></UnitDefinitions>
  <TypeDefinitions><SimpleType name="Force"><Real unit="N" quantity="Force" min="-5"/></SimpleType></TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="f &lt;1&gt;" valueReference="7" causality="output"><Real declaredType="Force"/></ScalarVariable>
    <ScalarVariable name="n" valueReference="7" causality="parameter" variability="fixed"><Integer start="3" min="1" max="4"/></ScalarVariable>
    <ScalarVariable name="b" valueReference="1" causality="input"><Boolean start="false"/></ScalarVariable>
    <ScalarVariable name="s" valueReference="2"><String start=""/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>"#;

    #[test]
    fn reads_types_units_and_capabilities() {
        let model = Model::parse(XML).unwrap();
        assert_eq!((model.identifier.as_str(), model.guid.as_str()), ("m", "{1}"));
        let description = &model.description;
        assert!(description.saves_states && !description.variable_step && !description.derivatives);
        let kinds: Vec<Kind> = description.variables.iter().map(|variable| variable.kind).collect();
        assert_eq!(kinds, [Kind::Real, Kind::Integer, Kind::Boolean, Kind::String]);
        let force = description.variable("m", "f <1>").unwrap();
        assert_eq!((force.reference, force.unit.as_str(), force.causality), (7, "N", Causality::Output));
        assert_eq!(force.range, [-5.0, f64::INFINITY], "of the declared type");
        assert_eq!(description.variable("m", "n").unwrap().range, [1.0, 4.0]);
        assert_eq!(description.variable("m", "b").unwrap().range, UNLIMITED);
    }

    #[test]
    fn says_what_is_wrong() {
        let version = Model::parse(&XML.replace("\"2.0\"", "\"3.0\"")).unwrap_err();
        assert!(version.contains("FMI 3") && version.contains("'3.0', expected '2.0'"), "{version}");
        // No guid, no CoSimulation as in FMI 2: what lacks of those is not the point.
        let third =
            r#"<fmiModelDescription fmiVersion="3.0" instantiationToken="a"><ModelVariables/></fmiModelDescription>"#;
        assert!(Model::parse(third).unwrap_err().contains("this is an FMU of FMI 3"));
        let without = Model::parse(&XML.replace(" guid=\"{1}\"", "")).unwrap_err();
        assert!(without.contains("missing attribute `guid`"), "{without}");
        let exchange = Model::parse(&XML.replace("CoSimulation", "ModelExchange")).unwrap_err();
        assert!(exchange.contains("model exchange only"), "{exchange}");
        for name in ["", ".", "..", "../m", "/usr/lib/m", "a/b", "a/..", "..\\m", "C:m"] {
            let xml = XML.replace("modelIdentifier=\"m\"", &format!("modelIdentifier=\"{name}\""));
            let refused = Model::parse(&xml).unwrap_err();
            assert!(refused.contains(&format!("modelIdentifier is '{name}'")), "{refused}");
        }
        assert!(Model::parse("<a>").is_err());
    }
}
