//! Parameters: descriptions, ranges, refusals, read-back (here), what keeps and ends a value (`persistence`), and whether
//! a value has an effect (`effect`).

mod effect;
mod persistence;
mod refusals;
pub(super) mod values;

use std::collections::HashSet;

use crate::prelude::checks::*;
use values::each;

pub(super) use effect::another;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R9.13", "the drive has every required parameter", |client| {
            let mut missing = REQUIRED.to_vec();
            missing.retain(|name| client.description.parameters.iter().all(|it| it.name != *name));
            expect(missing.is_empty(), format!("the parameters {}", REQUIRED.join(", ")), {
                format!("none named {}", missing.join(", "))
            })
        }),
        check(
            "R9.10 R9.12",
            "parameters with a reserved name have the type and the range of the name, and all laws",
            reserved,
        ),
        check("R9.9", "every parameter name is unique", |client| {
            let mut seen = HashSet::new();
            client.note = foreign_names(client.description.parameters.iter().map(|it| &*it.name));
            client.description.parameters.iter().try_for_each(|it| {
                expect(!it.name.is_empty() && seen.insert(&it.name), "a name no other has", &it.name)
            })
        }),
        check("R9.1", "default, minimum and maximum have one type", |client| {
            client.description.parameters.iter().try_for_each(|it| {
                let types = (it.default.ty(), it.min.ty(), it.max.ty());
                expect(types.0 == types.1 && types.1 == types.2, format!("{}: one type", it.name), types)
            })
        }),
        check("R3.2 R9.2", "default, minimum and maximum are finite", |client| {
            client.description.parameters.iter().try_for_each(|it| {
                let finite = |value| !matches!(value, F32(value) if !value.is_finite());
                let values = [it.default, it.min, it.max];
                expect(values.into_iter().all(finite), format!("{}: finite values", it.name), values)
            })
        }),
        check("R9.2", "every default lies in its range", |client| {
            client.description.parameters.iter().try_for_each(|it| {
                let range = format!("{} within {} to {}", it.name, it.min, it.max);
                expect(holds(it, it.default), range, it.default)
            })
        }),
        check(
            "R4.6 R9.2 R9.4 R9.7 R9.11",
            "every parameter accepts its minimum and maximum and reads them back",
            |client| {
                client.idle()?;
                each(client, |client, it| {
                    let mut values = vec![it.min, it.max];
                    // -0 is not below a minimum of 0, and keeps its sign.
                    if it.min == F32(0.0) {
                        values.push(F32(-0.0));
                    }
                    // Numbers that a processor may flush to zero.
                    let smallest = [1e-40, f32::from_bits(1)].map(F32);
                    values.extend(smallest.into_iter().filter(|value| holds(it, *value)));
                    values.push(it.default);
                    let exchanges = values.into_iter().flat_map(|value| {
                        let set = sets(it.index, value, Accepted, value, Idle);
                        [set, reads(it.index, value, Idle)]
                    });
                    client.exchange(&it.name, &exchanges.collect::<Vec<_>>())
                })
            },
        ),
    ];
    checks.extend(refusals::checks());
    checks.extend(persistence::checks());
    checks.extend(effect::checks());
    checks
}

/// Names whose ranges every drive has at least.
const LEAST_RANGES: [(&str, [ParameterValue; 2]); 2] =
    [(WATCHDOG_US, [U32(10_000), U32(30_000_000)]), (TORQUE_LIMIT_NM, [F32(0.0), F32(1.0)])];

/// A warning of names that a scenario, which is TOML, must quote.
pub(super) fn foreign_names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let is_bare =
        |name: &&str| name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte));
    let foreign: Vec<_> = names.filter(|name| !is_bare(name)).collect();
    if foreign.is_empty() {
        return String::new();
    }
    format!("warning: in a scenario these names need quotes: {}", foreign.words())
}

fn reserved(client: &mut Client) -> RuleResult {
    for name in REQUIRED {
        let it = client.parameter(name)?;
        expect(!it.live, format!("{name} without LIVE"), it.live)?;
        if [TORQUE_LIMIT_NM, MOTOR_SPEED_LIMIT_RAD_S, LOAD_SPEED_LIMIT_RAD_S].contains(&name) {
            equal(&format!("{name}: type"), ParameterType::F32, it.default.ty())?;
        }
        let laws = client.description.laws.len();
        expect(
            it.laws.is_all(&client.description.laws),
            format!("{name} in {laws} of {laws} laws"),
            it.laws.0,
        )?;
    }
    for (name, values) in LEAST_RANGES {
        let it = client.parameter(name)?;
        for value in values.map(|value| in_type_of(it, value)) {
            expect(holds(it, value), format!("{name}: a range with {value}"), (it.min, it.max))?;
        }
    }
    if client.description.laws.len() > 1 {
        let it = client.parameter(CONTROLLER)?;
        equal("controller: type", ParameterType::U32, it.default.ty())?;
    }
    Ok(())
}
