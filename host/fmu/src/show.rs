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
    let (version, model, tool) = (description.version, plain(&description.model), plain(&description.tool));
    let by = if tool.is_empty() { String::new() } else { format!(", by {tool}") };
    let _ = writeln!(text, "{}: FMI {version}, model {model}{by}", plain(&file.display().to_string()));
    let mut kinds = Vec::new();
    kinds.extend(is_co_simulation(description).then_some("co-simulation"));
    kinds.extend(description.has_model_exchange.then_some("model exchange"));
    let mut platforms = archive.platforms();
    platforms.extend(archive.has_sources().then(|| "C sources".to_owned()));
    let _ = writeln!(text, "kinds       {}", kinds.join(", "));
    let _ = writeln!(text, "platforms   {}", plain(&platforms.join(", ")));
    let _ = writeln!(text, "step        {}", step(description));
    if description.co_simulation.as_ref().is_some_and(|it| it.needs_tool) {
        let _ = writeln!(text, "needs       the tool that made it, on this machine");
    }
    for (causality, title) in [("input", "inputs"), ("output", "outputs"), ("parameter", "parameters")] {
        let of_kind: Vec<_> = description.variables.iter().filter(|it| it.causality == causality).collect();
        if !of_kind.is_empty() {
            let _ = writeln!(text, "\n{title}");
            let width = of_kind.iter().map(|it| plain(&it.name).chars().count()).max().unwrap_or_default();
            for variable in of_kind {
                let start = variable.start.as_deref().filter(|start| !start.is_empty());
                let start = start.map(|start| format!("= {start}")).unwrap_or_default();
                let facts = [&*variable.type_name, &*variable.unit, &*start];
                let facts: Vec<_> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
                let _ = writeln!(text, "  {:<width$}  {}", plain(&variable.name), plain(&facts.join(" ")));
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

/// Columns that every record has: no signal may have their names, nor the prefix of a drive's signals. This program shares no code with
/// the bench; a test compares the list with that of `lashloop-plant`.
const COLUMNS: [&str; 9] = [
    "time_s",
    "reference_rad",
    "load_position_rad",
    "motor_position_rad",
    "torque_nm",
    "telemetry_time_s",
    "motor_counts",
    "load_counts",
    "sent_reference_rad",
];
const OF_DRIVE: &str = "drive.";

/// A section that runs, if names tell motor from load; what to fill in is a comment.
fn section(file: &Path, description: &Description) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let of_role = |role: Role, causality: &'static str| {
        description.variables.iter().filter(move |it| it.causality == causality && role.takes(it))
    };
    let torques: Vec<_> = of_role(Role::Torque, "input").collect();
    let of_plant = |it: &&Variable| !it.name.starts_with(OF_DRIVE);
    let positions: Vec<_> = of_role(Role::Position, "output").filter(of_plant).collect();
    let torque = pick(&torques, &["torque", "tau", "moment"]).or(torques.first().copied());
    let motor = pick(&positions, &["motor_position", "motor.phi", "motor", "theta_m", "theta_e"]);
    let load = pick(&positions, &["load_position", "load.phi", "load", "theta_l", "theta_s"]);
    let mut text = format!("[plant]\nmodel = \"fmu\"\nfile = {}\n", quoted(&name));
    for (key, chosen, needs) in [
        ("torque_input", torque, "the input with the torque at the motor, in N m"),
        ("motor_output", motor, "the output with the position of the motor, in rad"),
        ("load_output", load, "the output with the position of the load, in rad"),
    ] {
        let _ = match chosen {
            Some(variable) => writeln!(text, "{key} = {}", quoted(&variable.name)),
            None => writeln!(text, "{key} = \"\"  # {needs}"),
        };
    }
    let is_position = |it: &&Variable| [motor, load].contains(&Some(*it));
    let is_free = |it: &&Variable| !COLUMNS.contains(&&*it.name) && of_plant(it);
    let signals = of_role(Role::Signal, "output").filter(|it| !is_position(it)).filter(is_free);
    let names: Vec<_> = signals.map(|it| quoted(&it.name)).collect();
    let _ = writeln!(text, "signals = [{}]", names.join(", "));
    if description.co_simulation.is_none() || description.version == Version::One {
        let _ = writeln!(text, "command = [\"python3\", \"-m\", \"lashloop.fmu\"]");
    }
    let _ = writeln!(text, "\n[plant.initial]");
    for (key, variable) in [("motor_position_rad", motor), ("load_position_rad", load)] {
        // An output has a start, or a parameter states it, as those of Lashloop's own plants do.
        let stated = description.variables.iter().find(|it| it.name == format!("plant.initial.{key}"));
        let start = [variable, stated].into_iter().flatten().find_map(|it| it.start.as_deref());
        let remark = if start.is_none() { "  # not stated by the FMU: fill in" } else { "" };
        let _ = writeln!(text, "{key} = {}{remark}", float(start));
    }
    let parameters: Vec<_> = of_role(Role::Start, "parameter").collect();
    if !parameters.is_empty() {
        let _ = writeln!(text, "\n[plant.start]");
        for parameter in parameters {
            let start = parameter.start.as_deref();
            let start = match parameter.kind {
                Kind::Text => quoted(start.unwrap_or_default()),
                Kind::Boolean => start.is_some_and(|it| matches!(it.trim(), "true" | "1")).to_string(),
                kind if kind.is_float() => float(start),
                _ => start.and_then(|it| it.trim().parse::<i64>().ok()).unwrap_or_default().to_string(),
            };
            let unit = if parameter.unit.is_empty() {
                String::new()
            } else {
                format!("  # {}", plain(&parameter.unit))
            };
            let _ = writeln!(text, "# {} = {start}{unit}", quoted(&parameter.name));
        }
    }
    text
}

/// A number as TOML has it; 0 for one that isn't finite, which no scenario may have.
fn float(start: Option<&str>) -> String {
    let number = start.and_then(|it| it.trim().parse::<f64>().ok()).filter(|it| it.is_finite());
    format!("{:?}", number.unwrap_or_default())
}

/// A text of TOML, whose escapes are those of JSON and that of DEL.
fn quoted(text: &str) -> String {
    let json = serde_json::Value::from(text).to_string();
    let escape = |c: char| {
        if steers(c) { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() }
    };
    json.chars().map(escape).collect()
}

/// Whether a terminal acts on a character instead of showing it: control characters, marks of the direction of the text.
fn steers(c: char) -> bool {
    let is_of_direction = |it| matches!(it, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || is_of_direction(c)
}

/// A text of the FMU on one line: it can't steer the terminal.
pub(crate) fn plain(text: &str) -> String {
    let escape = |c: char| if steers(c) { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(escape).collect()
}

/// The first variable whose name has one of the words, the words in their order.
fn pick<'a>(variables: &[&'a Variable], words: &[&str]) -> Option<&'a Variable> {
    let find = |word: &&str| variables.iter().find(|it| it.name.to_lowercase().contains(*word)).copied();
    words.iter().find_map(find)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_values_and_names_are_those_of_toml() {
        let two = include_str!("../../../tests/data/fmu/two.xml")
            .replace(
                "<Real unit=\"rad\" start=\"0.16\"/>",
                "<Real unit=\"rad&#10;x = 1\" start=\" 16E-2 \"/>",
            )
            .replace("<Real start=\"4\"/>", "<Real start=\"INF\"/>")
            .replace("<Boolean start=\"false\"/>", "<Boolean start=\"1\"/>")
            .replace("<String start=\"\"/>", "<String start=\"a&quot;&#9;\u{7f}\"/>")
            .replace("name=\"twist\"", "name=\"tw&#10;ist&#x85;\"")
            .replace("<Integer start=\"0\"/>", "<Integer start=\"+7\"/>");
        let text = section(Path::new("a\"b.fmu"), &Description::parse(&two).expect("a description"));
        for want in [
            "file = \"a\\\"b.fmu\"",
            "signals = [\"tw\\nist\\u0085\", \"steps\"]",
            "# \"dead_zone\" = 0.16  # rad\\nx = 1",
            "# \"substeps\" = 0.0",
            "# \"is_wet\" = true",
            "# \"note\" = \"a\\\"\\t\\u007f\"",
            "# \"mode\" = 7",
        ] {
            assert!(text.lines().any(|line| line == want), "{want}\n{text}");
        }
    }
}
