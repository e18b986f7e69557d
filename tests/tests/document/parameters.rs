//! The tables of the Lashloop drive: laws, signals, parameters and choices; and what the contract requires of them.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::parameter_names::{CONTROLLER, RESERVED};

use crate::markdown::{section, table};

/// The laws of a mask in the notation of the document.
fn laws(mask: u16) -> String {
    if mask.count_ones() as usize == Laws::NAMES.len() {
        return "all".to_owned();
    }
    let named = Laws::NAMES.iter().enumerate().filter(|(index, _)| mask >> index & 1 == 1);
    named.map(|(_, name)| *name).collect::<Vec<_>>().join(", ")
}

#[test]
fn the_table_of_laws_matches_the_drive() {
    let rows = table(section("### Its laws"), "index");
    let have: Vec<_> = rows.iter().map(|row| row[..2].to_vec()).collect();
    let want: Vec<_> = Laws::NAMES
        .iter()
        .enumerate()
        .map(|(index, name)| vec![index.to_string(), (*name).to_owned()])
        .collect();
    assert_eq!(have, want);
}

#[test]
fn the_table_of_signals_matches_the_drive() {
    let rows = table(section("### Its signals"), "index");
    assert_eq!(rows.len(), Laws::SIGNALS.len());
    for (index, (row, signal)) in rows.iter().zip(Laws::SIGNALS).enumerate() {
        assert_eq!(row[..4], [index.to_string(), signal.name.into(), signal.unit.into(), laws(signal.laws)]);
        assert!(!row[4].is_empty(), "{} has a meaning", signal.name);
    }
}

#[test]
fn the_table_of_parameters_matches_the_drive() {
    let rows = table(section("### Its parameters"), "index");
    assert_eq!(rows.len(), Laws::PARAMETERS.len());
    for (index, (row, parameter)) in rows.iter().zip(Laws::PARAMETERS).enumerate() {
        let range = parameter.range;
        let want = [
            index.to_string(),
            parameter.name.to_owned(),
            parameter.unit.to_owned(),
            format!("{:?}", range.default().ty()),
            range.default().to_string(),
            range.min().to_string(),
            range.max().to_string(),
            laws(parameter.laws),
        ];
        assert_eq!(row[..8], want);
        assert!(!row[8].is_empty(), "{} has a meaning", parameter.name);
    }
}

#[test]
fn the_table_of_choices_matches_the_drive() {
    let rows = table(section("### Its choices"), "parameter");
    let have: Vec<_> = rows.iter().map(|row| row[..3].to_vec()).collect();
    let mut want = Vec::new();
    for parameter in Laws::PARAMETERS {
        for (value, name) in parameter.range.choices().unwrap_or_default().iter().enumerate() {
            want.push(vec![parameter.name.to_owned(), value.to_string(), (*name).to_owned()]);
        }
    }
    assert_eq!(have, want);
}

#[test]
fn the_drive_has_every_reserved_parameter() {
    for name in RESERVED {
        let parameter = Laws::PARAMETERS.iter().find(|parameter| parameter.name == name);
        let parameter = parameter.unwrap_or_else(|| panic!("the drive lacks {name}"));
        assert_eq!(laws(parameter.laws), "all", "{name} is of the drive itself");
    }
    let controller =
        Laws::PARAMETERS.iter().find(|parameter| parameter.name == CONTROLLER).expect("see above");
    assert_eq!(controller.range.choices(), Some(Laws::NAMES));
    assert_eq!(controller.range.min(), ParameterValue::U32(0));
    assert_eq!(controller.range.max(), ParameterValue::U32(Laws::NAMES.len() as u32 - 1));
}
