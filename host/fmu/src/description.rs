//! `modelDescription.xml` of FMI 1.0, 2.0 and 3.0, as far as a plant needs it.
//!
//! We read it ourselves: `fmi-schema` 0.8.0 drops the units of FMI 2.0 and rejects unknown attributes, which tools add.

use std::collections::BTreeMap;
use std::fmt;

use roxmltree::{Document, Node};

use crate::error::FmuError;
use crate::variable::{Kind, Variable};

/// Version of FMI, by its major number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Version {
    One,
    Two,
    Three,
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::One => "1.0",
            Self::Two => "2.0",
            Self::Three => "3.0",
        })
    }
}

/// What a co-simulation FMU states of itself.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CoSimulation {
    /// Name of the library.
    pub(crate) identifier: String,
    /// Whether communication steps may differ.
    pub(crate) takes_any_step: bool,
    /// Step of the solver inside, of which a communication step must be a multiple. FMI 3.0 only.
    pub(crate) inner_step_s: Option<f64>,
    /// Whether it only talks to the tool that made it, which must be installed.
    pub(crate) needs_tool: bool,
}

/// What an FMU states of itself.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Description {
    pub(crate) version: Version,
    pub(crate) model: String,
    /// `guid` or `instantiationToken`.
    pub(crate) token: String,
    /// The tool that made it; empty if unknown.
    pub(crate) tool: String,
    pub(crate) co_simulation: Option<CoSimulation>,
    pub(crate) has_model_exchange: bool,
    /// Step that the FMU prefers.
    pub(crate) preferred_step_s: Option<f64>,
    pub(crate) variables: Vec<Variable>,
}

impl Description {
    /// Reads the XML.
    pub(crate) fn parse(text: &str) -> Result<Self, FmuError> {
        let document = Document::parse(text).map_err(|error| FmuError::Xml(error.to_string()))?;
        let root = document.root_element();
        let stated = root.attribute("fmiVersion").unwrap_or("unknown");
        let version = match stated.split('.').next() {
            Some("1") => Version::One,
            Some("2") => Version::Two,
            Some("3") => Version::Three,
            _ => return Err(FmuError::Version(stated.to_owned())),
        };
        let text = |name: &str| root.attribute(name).unwrap_or_default().to_owned();
        let token = if version == Version::Three { "instantiationToken" } else { "guid" };
        let experiment = child(root, "DefaultExperiment");
        // FMI 1.0 has the element `Implementation` in an FMU for co-simulation, and no element for model exchange.
        let is_tool_of_one = child(root, "Implementation").is_some();
        Ok(Self {
            version,
            model: text("modelName"),
            token: text(token),
            tool: text("generationTool"),
            co_simulation: child(root, "CoSimulation").map(co_simulation).transpose()?,
            has_model_exchange: child(root, "ModelExchange").is_some()
                || (version == Version::One && !is_tool_of_one),
            preferred_step_s: experiment.and_then(|it| number(it, "stepSize")),
            variables: variables(root, version)?,
        })
    }
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|it| it.has_tag_name(name))
}

fn number(node: Node<'_, '_>, name: &str) -> Option<f64> {
    node.attribute(name)?.trim().parse().ok()
}

fn is_true(node: Node<'_, '_>, name: &str) -> bool {
    node.attribute(name).is_some_and(|value| matches!(value.trim(), "true" | "1"))
}

fn required<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, FmuError> {
    let missing = || FmuError::Xml(format!("<{}> has no {name}", node.tag_name().name()));
    node.attribute(name).ok_or_else(missing)
}

fn co_simulation(node: Node<'_, '_>) -> Result<CoSimulation, FmuError> {
    let identifier = required(node, "modelIdentifier")?;
    // It becomes part of a path.
    if identifier.is_empty() || !identifier.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(FmuError::Identifier(identifier.to_owned()));
    }
    Ok(CoSimulation {
        identifier: identifier.to_owned(),
        takes_any_step: is_true(node, "canHandleVariableCommunicationStepSize"),
        inner_step_s: number(node, "fixedInternalStepSize"),
        needs_tool: is_true(node, "needsExecutionTool"),
    })
}

/// Units by the name of the type definition that has them.
fn units_of_types(root: Node<'_, '_>) -> BTreeMap<String, String> {
    let types = child(root, "TypeDefinitions").into_iter().flat_map(|it| it.descendants());
    let unit = |node: Node<'_, '_>| {
        // FMI 1.0 and 2.0 have the unit in a child of the type, FMI 3.0 in the type.
        let with_name = if node.has_attribute("name") { node } else { node.parent()? };
        Some((with_name.attribute("name")?.to_owned(), node.attribute("unit")?.to_owned()))
    };
    types.filter_map(unit).collect()
}

fn variables(root: Node<'_, '_>, version: Version) -> Result<Vec<Variable>, FmuError> {
    let units = units_of_types(root);
    let is_three = version == Version::Three;
    let mut variables = Vec::new();
    let Some(list) = child(root, "ModelVariables") else { return Ok(variables) };
    for node in list.children().filter(Node::is_element) {
        // Before FMI 3.0 a child has the type.
        let typed = if is_three { Some(node) } else { node.children().find(Node::is_element) };
        let Some(typed) = typed else { continue };
        let type_name = typed.tag_name().name();
        let reference = required(node, "valueReference")?.trim().parse();
        let of_type = typed.attribute("declaredType").and_then(|name| units.get(name)).cloned();
        let variable = Variable {
            name: required(node, "name")?.to_owned(),
            reference: reference.map_err(|_| FmuError::Xml("a valueReference isn't a number".to_owned()))?,
            kind: Kind::of_element(type_name, is_three),
            type_name: type_name.to_owned(),
            causality: node.attribute("causality").unwrap_or("local").to_owned(),
            unit: typed.attribute("unit").map(str::to_owned).or(of_type).unwrap_or_default(),
            start: typed.attribute("start").map(str::to_owned),
            is_approximate: node.attribute("initial") == Some("approx"),
            is_array: child(node, "Dimension").is_some(),
        };
        for alias in node.children().filter(|it| is_three && it.has_tag_name("Alias")) {
            variables.push(Variable { name: required(alias, "name")?.to_owned(), ..variable.clone() });
        }
        variables.push(variable);
    }
    Ok(variables)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &str = include_str!("../../../tests/data/fmu/one.xml");
    const TWO: &str = include_str!("../../../tests/data/fmu/two.xml");
    const THREE: &str = include_str!("../../../tests/data/fmu/three.xml");

    fn read(text: &str) -> Description {
        Description::parse(text).expect("a description")
    }

    #[test]
    fn units_are_those_of_the_variable_or_of_its_type() {
        for text in [ONE, TWO, THREE] {
            let description = read(text);
            let unit = |name| description.variables.iter().find(|it| it.name == name).map(|it| &*it.unit);
            let units = ["torque", "motor.phi", "twist"].map(unit);
            assert_eq!(units, [Some("N.m"), Some("rad"), Some("rad")]);
        }
    }

    #[test]
    fn kinds_of_each_version_are_told_apart() {
        let kinds = |text: &str| {
            let description = read(text);
            (description.version, description.co_simulation.is_some(), description.has_model_exchange)
        };
        assert_eq!(kinds(TWO), (Version::Two, true, true));
        assert_eq!(kinds(THREE), (Version::Three, true, false));
        assert_eq!(kinds(ONE), (Version::One, false, false));
        assert_eq!(kinds(&ONE.replace("Implementation", "VendorAnnotations")), (Version::One, false, true));
        let error = Description::parse(&TWO.replace("fmiVersion=\"2.0\"", "fmiVersion=\"4.0\""))
            .expect_err("a new one");
        assert!(
            error.to_string().starts_with("the FMU is of FMI 4.0, and lashloop-fmu takes 2.0 and 3.0"),
            "{error}"
        );
    }

    #[test]
    fn aliases_arrays_and_what_tools_add_are_read() {
        let three = read(
            &THREE.replace("<CoSimulation", "<CoSimulation vendor=\"x\" fixedInternalStepSize=\"1e-4\""),
        );
        let named = |name: &str| three.variables.iter().find(|it| it.name == name).expect(name);
        assert_eq!(named("rotor.phi").reference, named("motor.phi").reference);
        assert_eq!((named("table").is_array, named("twist").kind), (true, Kind::Float32));
        assert_eq!(three.co_simulation.and_then(|it| it.inner_step_s), Some(1e-4));
    }

    #[test]
    fn what_is_missing_is_named() {
        let error =
            |from: &str, to: &str| Description::parse(&TWO.replace(from, to)).expect_err(to).to_string();
        assert!(
            error("modelIdentifier=\"plant\" canHandle", "canHandle")
                .contains("<CoSimulation> has no modelIdentifier")
        );
        assert!(
            error("valueReference=\"3\"", "valueReference=\"x\"").contains("a valueReference isn't a number")
        );
        for identifier in ["", "../plant", "plant.so"] {
            let have = error(
                "modelIdentifier=\"plant\" canHandle",
                &format!("modelIdentifier=\"{identifier}\" canHandle"),
            );
            assert!(have.starts_with(&format!("the FMU's modelIdentifier {identifier:?} isn't")), "{have}");
        }
        assert!(error("</fmiModelDescription>", "").contains("modelDescription.xml can't be read"));
    }
}
