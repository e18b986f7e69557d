//! `modelDescription.xml` of FMI 2.0 and 3.0.

use std::collections::BTreeMap;
use std::io;

use lashloop_bench::scenario::Scenario;
use quick_xml::Writer;

use crate::interface::Interface;
use crate::part::Part;
use crate::unit;
use crate::variable::{Kind, Role, Value, Variable};

/// A version of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl Version {
    /// The version of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::Two, Self::Three].into_iter().find(|version| version.name() == name)
    }

    /// `2.0` or `3.0`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Two => "2.0",
            Self::Three => "3.0",
        }
    }

    const fn type_name(self, kind: Kind) -> &'static str {
        match (self, kind) {
            (Self::Two, Kind::Real) => "Real",
            (Self::Three, Kind::Real) => "Float64",
            (Self::Two, Kind::Integer) => "Integer",
            (Self::Three, Kind::Integer) => "Int32",
            (_, Kind::Boolean) => "Boolean",
            (_, Kind::Text) => "String",
        }
    }
}

/// What a description describes.
pub(crate) struct Described<'a> {
    pub(crate) version: Version,
    pub(crate) part: Part,
    pub(crate) scenario: &'a Scenario,
    pub(crate) interface: &'a Interface,
    pub(crate) token: &'a str,
}

type Xml = Writer<Vec<u8>>;
type Attributes = Vec<(&'static str, String)>;

impl Described<'_> {
    /// The description as XML.
    pub(crate) fn xml(&self) -> io::Result<Vec<u8>> {
        let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
        let (version, part) = (self.version, self.part.summary());
        let token = match version {
            Version::Two => "guid",
            Version::Three => "instantiationToken",
        };
        let title = self.scenario.title.clone();
        let attributes = [
            ("fmiVersion", version.name().to_owned()),
            ("modelName", format!("lashloop.{}", self.part.name())),
            (token, self.token.to_owned()),
            ("description", format!("{part} of the scenario \"{title}\"")),
            ("generationTool", format!("Lashloop {}", env!("CARGO_PKG_VERSION"))),
            ("variableNamingConvention", "structured".to_owned()),
        ];
        element(&mut xml, "fmiModelDescription", &attributes, |xml| {
            empty(xml, "CoSimulation", &self.co_simulation())?;
            self.units(xml)?;
            element(xml, "LogCategories", &[], |xml| {
                empty(xml, "Category", &[("name", "logStatusError".to_owned())])
            })?;
            empty(xml, "DefaultExperiment", &self.experiment())?;
            element(xml, "ModelVariables", &[], |xml| {
                // Version 2.0 doesn't need the time, and FMI Library, which many importers use, wants a start value of it.
                let first = if version == Version::Two { 1 } else { 0 };
                let mut variables = self.interface.variables.iter().enumerate().skip(first);
                variables.try_for_each(|(index, it)| self.variable(xml, index, it))
            })?;
            element(xml, "ModelStructure", &[], |xml| self.structure(xml))
        })?;
        let mut bytes = b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_vec();
        bytes.append(&mut xml.into_inner());
        bytes.push(b'\n');
        Ok(bytes)
    }

    fn period_s(&self) -> String {
        self.scenario.run.control_period_s().to_string()
    }

    fn co_simulation(&self) -> Attributes {
        let Interface { takes_any_step, can_be_saved, .. } = *self.interface;
        let states = match self.version {
            Version::Two => ["canGetAndSetFMUstate", "canSerializeFMUstate"],
            Version::Three => ["canGetAndSetFMUState", "canSerializeFMUState"],
        };
        let mut attributes = vec![
            ("modelIdentifier", self.part.identifier().to_owned()),
            ("canHandleVariableCommunicationStepSize", takes_any_step.to_string()),
        ];
        attributes.extend(states.map(|name| (name, can_be_saved.to_string())));
        match self.version {
            Version::Two => attributes.push(("canNotUseMemoryManagementFunctions", "true".to_owned())),
            Version::Three if !takes_any_step => attributes.push(("fixedInternalStepSize", self.period_s())),
            Version::Three => {}
        }
        attributes
    }

    fn experiment(&self) -> Attributes {
        vec![
            ("startTime", "0".to_owned()),
            ("stopTime", self.scenario.run.duration_s.to_string()),
            ("stepSize", self.period_s()),
        ]
    }

    fn units(&self, xml: &mut Xml) -> io::Result<()> {
        let units =
            self.interface.variables.iter().map(|variable| &*variable.unit).filter(|unit| !unit.is_empty());
        let units: BTreeMap<_, _> = units.map(|unit| (unit::name(unit), unit::of(unit))).collect();
        element(xml, "UnitDefinitions", &[], |xml| {
            for (name, si) in units {
                let name = [("name", name)];
                let Some(si) = si else {
                    empty(xml, "Unit", &name)?;
                    continue;
                };
                let exponents =
                    unit::BASES.into_iter().zip(si.exponents).filter(|(_, exponent)| *exponent != 0);
                let mut base: Attributes =
                    exponents.map(|(base, exponent)| (base, exponent.to_string())).collect();
                if si.factor != 1.0 {
                    base.push(("factor", si.factor.to_string()));
                }
                element(xml, "Unit", &name, |xml| empty(xml, "BaseUnit", &base))?;
            }
            Ok(())
        })
    }

    fn variable(&self, xml: &mut Xml, index: usize, variable: &Variable) -> io::Result<()> {
        let is_real = variable.kind() == Kind::Real;
        let is_sampled = self.part == Part::Drive;
        let (causality, variability) = match variable.role {
            Role::Time => ("independent", "continuous"),
            Role::Parameter => ("parameter", "fixed"),
            Role::Input if is_real && !is_sampled => ("input", "continuous"),
            Role::Input => ("input", "discrete"),
            Role::Output if is_real && !is_sampled => ("output", "continuous"),
            Role::Output => ("output", "discrete"),
        };
        let mut head = vec![("name", variable.name.clone()), ("valueReference", index.to_string())];
        if !variable.description.is_empty() {
            head.push(("description", variable.description.clone()));
        }
        head.extend([("causality", causality.to_owned()), ("variability", variability.to_owned())]);
        let mut typed = Vec::new();
        if is_real && !variable.unit.is_empty() {
            typed.push(("unit", unit::name(&variable.unit)));
        }
        let start = matches!(variable.role, Role::Input | Role::Parameter).then(|| text(&variable.start));
        let type_name = self.version.type_name(variable.kind());
        match (self.version, start) {
            (Version::Two, start) => {
                typed.extend(start.map(|start| ("start", start)));
                element(xml, "ScalarVariable", &head, |xml| empty(xml, type_name, &typed))
            }
            (Version::Three, Some(start)) if variable.kind() == Kind::Text => {
                element(xml, type_name, &head, |xml| empty(xml, "Start", &[("value", start)]))
            }
            (Version::Three, start) => {
                head.extend(typed);
                head.extend(start.map(|start| ("start", start)));
                empty(xml, type_name, &head)
            }
        }
    }

    /// No output depends on an input at the same time: a step lies between.
    fn structure(&self, xml: &mut Xml) -> io::Result<()> {
        let outputs = self.interface.outputs.clone();
        match self.version {
            Version::Two => {
                // Indices begin at 1 there, and the time, which would have the first, isn't described.
                let index = |output: usize| ("index", output.to_string());
                let none = ("dependencies", String::new());
                element(xml, "Outputs", &[], |xml| {
                    outputs.clone().try_for_each(|it| empty(xml, "Unknown", &[index(it), none.clone()]))
                })?;
                element(xml, "InitialUnknowns", &[], |xml| {
                    outputs.clone().try_for_each(|it| empty(xml, "Unknown", &[index(it)]))
                })
            }
            Version::Three => {
                let reference = |output: usize| ("valueReference", output.to_string());
                let none = ("dependencies", String::new());
                outputs.clone().try_for_each(|it| empty(xml, "Output", &[reference(it), none.clone()]))?;
                outputs.clone().try_for_each(|it| empty(xml, "InitialUnknown", &[reference(it)]))
            }
        }
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::Real(number) => number.to_string(),
        Value::Integer(number) => number.to_string(),
        Value::Boolean(is_on) => is_on.to_string(),
        Value::Text(text) => text.clone(),
    }
}

fn empty(xml: &mut Xml, name: &'static str, attributes: &[(&'static str, String)]) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_empty().map(|_| ())
}

fn element(
    xml: &mut Xml,
    name: &'static str,
    attributes: &[(&'static str, String)],
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_inner_content(content).map(|_| ())
}
