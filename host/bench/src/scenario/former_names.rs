//! Former names that scenarios may use until release 1.0.
//!
//! | key | former | now |
//! |---|---|---|
//! | `controller.name` | `faithful`, `literal`, `compensating` | `merzouki`, `merzouki-as-printed`, `backlash-inverse` |
//! | `plant.model` | `bench` | `backlash-shaft` |
//! | `controller.parameters` | `hold_share` | `hold_fraction` |
//!
//! They are replaced in the tree, from file and command line alike, so that everything after it has the present names only.

use lashloop_plant::backlash_shaft;

use super::tree::Table;

/// Former names of laws, each with the present one.
const LAWS: [(&str, &str); 3] =
    [("faithful", "merzouki"), ("literal", "merzouki-as-printed"), ("compensating", "backlash-inverse")];

/// The present name of a law; any other name as it is.
#[must_use]
pub fn present_law(name: &str) -> &str {
    LAWS.iter().find(|(former, _)| *former == name).map_or(name, |(_, present)| present)
}

/// Replaces former names by present ones.
pub(super) fn replace(root: &mut Table) {
    if let Some(model) = root.section_mut("plant").and_then(|plant| plant.text_mut("model"))
        && model == "bench"
    {
        backlash_shaft::NAME.clone_into(model);
    }
    let Some(controller) = root.section_mut("controller") else { return };
    if let Some(name) = controller.text_mut("name") {
        *name = present_law(name).to_owned();
    }
    if let Some(parameters) = controller.section_mut("parameters") {
        parameters.rename("hold_share", "hold_fraction");
    }
}

#[cfg(test)]
mod tests {
    use crate::scenario::{Override, Scenario};

    fn read(text: &str, options: &[Override]) -> String {
        let scenario =
            Scenario::from_str("x.toml", text, options).unwrap_or_else(|errors| panic!("{errors}"));
        scenario.to_toml().expect("TOML")
    }

    fn text(model: &str, law: &str, parameter: &str) -> String {
        format!(
            "title = \"a run\"\n[run]\nduration_s = 1.0\n[plant]\nmodel = \"{model}\"\n[controller]\nname = \"{law}\"\n\
             parameters.{parameter} = 0.25\n[reference]\nprofile = \"constant\"\nposition_rad = 0.0\n"
        )
    }

    #[test]
    fn former_names_read_as_present_ones() {
        for (former, now) in [
            ("faithful", "merzouki"),
            ("literal", "merzouki-as-printed"),
            ("compensating", "backlash-inverse"),
        ] {
            let present = text("backlash-shaft", now, "hold_fraction");
            assert_eq!(read(&text("bench", former, "hold_share"), &[]), read(&present, &[]));
            let options =
                [Override::Set("plant.model=bench".to_owned()), Override::Controller(former.to_owned())];
            assert_eq!(read(&text("smooth", "pd", "hold_fraction"), &options), read(&present, &[]));
        }
    }

    #[test]
    fn a_former_name_next_to_the_present_one_is_left_to_the_drive() {
        let both = text("smooth", "pd", "hold_share = 0.5\nparameters.hold_fraction");
        let printed = read(&both, &[]);
        assert!(
            printed.contains("hold_share = 0.5") && printed.contains("hold_fraction = 0.25"),
            "{printed}"
        );
    }
}
