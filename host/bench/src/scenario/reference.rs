//! `[reference]`: the commanded load position. Each profile has keys of its own; the error for a key of another profile
//! names that profile.

use super::key::Choice;
use super::key_error::KeyError;
use super::range::positive;
use super::reader::Section;
use super::tables::Tables;
use lashloop_plant::reference::{Interpolation, Reference, Trapezoid};

/// Reads the keys of one profile; `None` if a table can't be used.
type ReadProfile = fn(&mut Section<'_>, Tables<'_>) -> Option<Reference>;

const PROFILES: [(&str, ReadProfile); 5] = [
    ("constant", read_constant),
    ("step", read_step),
    ("sine", read_sine),
    ("trapezoid", read_trapezoid),
    ("table", read_table),
];

pub(super) fn read(reference: &mut Section<'_>, tables: Tables<'_>) -> Reference {
    let choices = PROFILES.map(|(name, _)| (name, name));
    let Some(chosen) = reference
        .doc("Shape of the reference over time.")
        .choice_docs(DOCS.to_vec())
        .choice("profile", None, &choices)
    else {
        reference.accept_the_rest();
        return STAND_IN;
    };
    reference.attribute_to_option("profile");
    let mut result = None;
    for (name, read_profile) in PROFILES {
        if name == chosen {
            result = read_profile(reference, tables);
        } else {
            reference.belongs_to("profile", name, chosen, |section| read_profile(section, tables));
        }
    }
    result.unwrap_or(STAND_IN)
}

/// Takes the place of a faulty reference until the scenario is rejected.
const STAND_IN: Reference = Reference::Constant { position_rad: 0.0 };

/// A position within 1600 revolutions, which every encoder counts.
fn position(section: &mut Section<'_>, key: &'static str, default: Option<f64>) -> f64 {
    section.number(key, default, -1e4..=1e4)
}

const DOCS: [Choice; 5] = [
    Choice {
        name: "constant",
        doc: "One position for the whole run; regulation from the start to this position.",
    },
    Choice { name: "step", doc: "A jump from one position to another." },
    Choice { name: "sine", doc: "offset + amplitude sin(2 pi frequency t + phase)." },
    Choice { name: "trapezoid", doc: "A move with limited velocity and acceleration." },
    Choice { name: "table", doc: "Points of a file." },
];

fn read_constant(constant: &mut Section<'_>, _: Tables<'_>) -> Option<Reference> {
    Some(Reference::Constant {
        position_rad: position(constant.doc("Position of the load."), "position_rad", None),
    })
}

fn read_step(step: &mut Section<'_>, _: Tables<'_>) -> Option<Reference> {
    Some(Reference::Step {
        before_rad: position(step.doc("Position before the jump."), "before_rad", None),
        after_rad: position(step.doc("Position from the jump on."), "after_rad", None),
        at_s: step.doc("First time at which `after_rad` holds.").number("at_s", None, 0.0..=1e6),
    })
}

fn read_sine(sine: &mut Section<'_>, _: Tables<'_>) -> Option<Reference> {
    Some(Reference::Sine {
        amplitude_rad: sine.doc("Half of peak to peak.").number("amplitude_rad", None, 0.0..=1e4),
        frequency_hz: sine.doc("Frequency.").number("frequency_hz", None, positive(1e4)),
        offset_rad: position(sine.doc("Middle of the sine."), "offset_rad", Some(0.0)),
        phase_rad: position(sine.doc("Phase at time 0."), "phase_rad", Some(0.0)),
    })
}

fn read_trapezoid(move_: &mut Section<'_>, _: Tables<'_>) -> Option<Reference> {
    Some(Reference::Trapezoid(Trapezoid {
        from_rad: position(move_.doc("Position before the move."), "from_rad", None),
        to_rad: position(move_.doc("Position after the move."), "to_rad", None),
        start_s: move_.doc("Begin of the move.").number("start_s", 0.0, 0.0..=1e6),
        velocity_rad_s: move_.doc("Largest velocity.").number("velocity_rad_s", None, positive(1e4)),
        acceleration_rad_s2: move_.doc("Acceleration and deceleration.").number(
            "acceleration_rad_s2",
            None,
            positive(1e6),
        ),
    }))
}

fn read_table(table: &mut Section<'_>, tables: Tables<'_>) -> Option<Reference> {
    let interpolations = [("linear", Interpolation::Linear), ("hold", Interpolation::Hold)];
    let interpolation = table
        .doc("Positions between two points: on a line, or that of the point before.")
        .choice("interpolation", Interpolation::Linear, &interpolations);
    let file = table
        .doc("CSV file with the columns `time_s,position_rad`, relative to the folder of the scenario.")
        .text("file", Some("the path of a CSV file with the columns time_s,position_rad"))?;
    match tables.read(file, interpolation.unwrap_or(Interpolation::Linear)) {
        Ok(points) => Some(Reference::Table(points)),
        Err(error) => {
            if let Some(node) = table.node("file") {
                table.error("file", node, KeyError::Table(error));
            }
            None
        }
    }
}
