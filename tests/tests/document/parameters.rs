//! What the contract requires of the parameters of the Lashloop drive, and the meanings in its tables.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::parameter_names::{CONTROLLER, RESERVED};

use crate::markdown::{section, table};

#[test]
fn every_row_of_the_drive_s_tables_has_a_meaning() {
    let tables = [
        ("### Its laws", "index"),
        ("### Its signals", "index"),
        ("### Its parameters", "index"),
        ("### Its choices", "parameter"),
        ("## 18. Bench mode", "name"),
    ];
    for (heading, header) in tables {
        for row in table(section(heading), header) {
            assert!(row.last().is_some_and(|meaning| !meaning.is_empty()), "{heading}: {row:?}");
        }
    }
}

#[test]
fn the_drive_has_every_reserved_parameter() {
    for name in RESERVED {
        let parameter = Laws::PARAMETERS.iter().find(|parameter| parameter.name == name);
        let parameter = parameter.unwrap_or_else(|| panic!("the drive lacks {name}"));
        assert_eq!(parameter.laws.count_ones() as usize, Laws::NAMES.len(), "{name} is of the drive itself");
        assert!(!parameter.live, "{name} is never live");
    }
    let controller =
        Laws::PARAMETERS.iter().find(|parameter| parameter.name == CONTROLLER).expect("see above");
    assert_eq!(controller.range.choices(), Some(Laws::NAMES));
    assert_eq!(controller.range.min(), ParameterValue::U32(0));
    assert_eq!(controller.range.max(), ParameterValue::U32(Laws::NAMES.len() as u32 - 1));
}
