//! `lashloop fmu show`: what an FMU is and has, and a `[plant]` section for it.

use std::fmt::Write;
use std::path::Path;

use crate::archive::Archive;
use crate::description::{Description, Version};
use crate::names::Role;
use crate::variable::{Kind, Variable};

/// The text. Writing to a text can't fail, so its results are dropped.
pub(crate) fn text(file: &Path, description: &Description, archive: &Archive) -> String {
    let mut text = String::new();
    let tool = if description.tool.is_empty() { String::new() } else { format!(", by {}", description.tool) };
    let _ =
        writeln!(text, "{}: FMI {}, model {}{tool}", file.display(), description.version, description.model);
    let mut kinds = Vec::new();
    kinds.extend(is_co_simulation(description).then_some("co-simulation"));
    kinds.extend(description.has_model_exchange.then_some("model exchange"));
    let mut platforms = archive.platforms();
    platforms.extend(archive.has_sources().then(|| "C sources".to_owned()));
    let _ = writeln!(text, "kinds       {}", kinds.join(", "));
    let _ = writeln!(text, "platforms   {}", platforms.join(", "));
    let _ = writeln!(text, "step        {}", step(description));
    if description.co_simulation.as_ref().is_some_and(|it| it.needs_tool) {
        let _ = writeln!(text, "needs       the tool that made it, on this machine");
    }
    for (causality, title) in [("input", "inputs"), ("output", "outputs"), ("parameter", "parameters")] {
        let of_kind: Vec<_> = description.variables.iter().filter(|it| it.causality == causality).collect();
        if !of_kind.is_empty() {
            let _ = writeln!(text, "\n{title}");
            let width = of_kind.iter().map(|it| it.name.chars().count()).max().unwrap_or_default();
            for variable in of_kind {
                let start = variable.start.as_deref().filter(|start| !start.is_empty());
                let start = start.map(|start| format!("= {start}")).unwrap_or_default();
                let facts = [&*variable.type_name, &*variable.unit, &*start];
                let facts: Vec<_> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
                let _ = writeln!(text, "  {:<width$}  {}", variable.name, facts.join(" "));
            }
        }
    }
    text + "\n" + &section(file, description)
}

/// FMI 1.0 has no element of this name; what isn't for model exchange is for co-simulation.
fn is_co_simulation(description: &Description) -> bool {
    description.co_simulation.is_some()
        || (description.version == Version::One && !description.has_model_exchange)
}

fn step(description: &Description) -> String {
    let mut facts = Vec::new();
    if let Some(fmu) = &description.co_simulation {
        let any = if fmu.takes_any_step { "of any size" } else { "of one size" };
        facts.push(any.to_owned());
        facts.extend(fmu.inner_step_s.map(|step_s| format!("a multiple of {step_s} s")));
    }
    facts.extend(description.preferred_step_s.map(|step_s| format!("the FMU prefers {step_s} s")));
    if facts.is_empty() { "not stated".to_owned() } else { facts.join(", ") }
}

/// A section that runs, if names tell motor from load; what to fill in is a comment.
fn section(file: &Path, description: &Description) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let of_role = |role: Role, causality: &'static str| {
        description.variables.iter().filter(move |it| it.causality == causality && role.takes(it))
    };
    let torques: Vec<_> = of_role(Role::Torque, "input").collect();
    let positions: Vec<_> = of_role(Role::Position, "output").collect();
    let torque = pick(&torques, &["torque", "tau", "moment"]).or(torques.first().copied());
    let motor = pick(&positions, &["motor_position", "motor.phi", "motor", "theta_m", "theta_e"]);
    let load = pick(&positions, &["load_position", "load.phi", "load", "theta_l", "theta_s"]);
    let mut text = format!("[plant]\nmodel = \"fmu\"\nfile = {name:?}\n");
    for (key, chosen, needs) in [
        ("torque_input", torque, "the input with the torque at the motor, in N m"),
        ("motor_output", motor, "the output with the position of the motor, in rad"),
        ("load_output", load, "the output with the position of the load, in rad"),
    ] {
        let _ = match chosen {
            Some(variable) => writeln!(text, "{key} = {:?}", variable.name),
            None => writeln!(text, "{key} = \"\"  # {needs}"),
        };
    }
    let is_position = |it: &&Variable| [motor, load].contains(&Some(*it));
    let signals = of_role(Role::Signal, "output").filter(|it| !is_position(it));
    let names: Vec<_> = signals.map(|it| format!("{:?}", it.name)).collect();
    let _ = writeln!(text, "signals = [{}]", names.join(", "));
    if description.co_simulation.is_none() || description.version == Version::One {
        let _ = writeln!(text, "command = [\"python3\", \"-m\", \"lashloop.fmu\"]");
    }
    let _ = writeln!(text, "\n[plant.initial]");
    for (key, variable) in [("motor_position_rad", motor), ("load_position_rad", load)] {
        let start = variable.and_then(|it| it.start.as_deref()).unwrap_or("0.0");
        let _ = writeln!(text, "{key} = {start}");
    }
    let parameters: Vec<_> = of_role(Role::Start, "parameter").collect();
    if !parameters.is_empty() {
        let _ = writeln!(text, "\n[plant.start]");
        for parameter in parameters {
            let start = parameter.start.as_deref();
            let start = match parameter.kind {
                Kind::Text => format!("{:?}", start.unwrap_or_default()),
                Kind::Boolean => start.unwrap_or("false").to_owned(),
                _ => start.unwrap_or("0").to_owned(),
            };
            let unit =
                if parameter.unit.is_empty() { String::new() } else { format!("  # {}", parameter.unit) };
            let _ = writeln!(text, "# {:?} = {start}{unit}", parameter.name);
        }
    }
    text
}

/// The first variable whose name has one of the words, the words in their order.
fn pick<'a>(variables: &[&'a Variable], words: &[&str]) -> Option<&'a Variable> {
    let find = |word: &&str| variables.iter().find(|it| it.name.to_lowercase().contains(*word)).copied();
    words.iter().find_map(find)
}
