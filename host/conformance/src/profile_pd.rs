//! The optional profile `pd`: the law of that name against the golden trace of the specification.

use crate::prelude::checks::*;

/// Name of the law.
const LAW: &str = "pd";
/// Runs of the trace, in the order of the columns of [`PARAMETERS`].
const RUNS: [&str; 2] = ["coarse", "fine"];
/// Largest difference of a torque from that of the trace, in N m.
const TOLERANCE_NM: f32 = 0.001;
const PARAMETERS: &str = include_str!("../data/pd-parameters.csv");
const TRACE: &str = include_str!("../data/pd.csv");
/// Parameters of [`PARAMETERS`] that every drive has.
const OF_EVERY_DRIVE: usize = 6;

pub(super) fn checks() -> Vec<Check> {
    let replayed = |run| {
        let name = format!("the law pd requests the torques of the golden trace, run {run}");
        check("R17.1 R17.2 R17.3", name, move |client| replay(client, run))
    };
    RUNS.map(replayed).into()
}

/// Index of the law. Skips the check if the drive doesn't offer the profile.
fn offered(client: &Client) -> Result<u32, Failure> {
    let laws = &client.description.laws;
    let Some(law) = laws.iter().find(|law| law.name == LAW) else {
        return skip("the drive has no law pd, so it does not offer the profile");
    };
    let has = |name: &str| {
        client
            .description
            .parameters
            .iter()
            .any(|it| it.name == name && it.laws.contains(law.index) && matches!(it.default, F32(_)))
    };
    if !settings(RUNS[0]).iter().skip(OF_EVERY_DRIVE).all(|(name, _)| has(name)) {
        return skip("the law pd of this drive lacks a parameter of the profile, so it is another law");
    }
    Ok(law.index.into())
}

/// Sends the samples of a run, and compares the answers with those of the trace.
fn replay(client: &mut Client, run: &str) -> RuleResult {
    let law = offered(client)?;
    let mut settings = settings(run);
    for (name, value) in &settings {
        let parameter = client.parameter(name)?;
        if !holds(parameter, in_type_of(parameter, *value)) {
            return skip("not run: the drive's ranges exclude a parameter of this run");
        }
    }
    if client.description.parameters.iter().any(|it| it.name == CONTROLLER) {
        settings.push((CONTROLLER, U32(law)));
    }
    client.running(&settings)?;
    let rows = rows(run);
    let samples: Vec<_> = rows.iter().map(|row| row.sample.into()).collect();
    let answers = client.answers(&samples)?;
    for (place, Row { sample, torque_nm, is_gap }) in rows.iter().enumerate() {
        let at = format!("sample {}:", sample.sequence);
        let answer: &[DriveMessage] = answers.get(place..=place).unwrap_or_default();
        let answer = torque(answer)?;
        equal(&format!("{at} state"), Running, answer.status.state)?;
        equal(&format!("{at} flag GAP"), *is_gap, answer.status.flags.contains(TorqueFlags::GAP))?;
        let is_near = (answer.torque_nm - torque_nm).abs() <= TOLERANCE_NM;
        expect(is_near, format!("{at} torque {torque_nm} N m to {TOLERANCE_NM} N m"), answer.torque_nm)?;
    }
    Ok(())
}

/// The parameters of a run, as the Lashloop drive has them.
fn settings(run: &str) -> Vec<Setting> {
    let rows = PARAMETERS.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = 2 + RUNS.iter().position(|name| *name == run).expect("a run of the trace");
    let value = |row: &[&str]| match row[column].parse() {
        Ok(whole) if row[0] == "period_us" || row[0].ends_with("_counts_per_rev") => U32(whole),
        _ => F32(row[column].parse().expect("a number")),
    };
    rows.skip(1).map(|row| (row[0], value(&row))).collect()
}

/// A row of the trace.
#[derive(Debug, PartialEq)]
struct Row {
    sample: EncoderSample,
    torque_nm: f32,
    is_gap: bool,
}

/// The rows of a run.
fn rows(run: &str) -> Vec<Row> {
    let rows = TRACE.lines().map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[0] == run);
    let row = |row: Vec<&str>| {
        let counts = |text: &str| EncoderCounts::wrapping(text.parse().expect("counts"));
        let sample = EncoderSample {
            sequence: row[1].parse().expect("a sequence"),
            motor_counts: counts(row[2]),
            load_counts: counts(row[3]),
            reference_rad: row[4].parse().expect("a reference"),
        };
        Row { sample, torque_nm: row[5].parse().expect("a torque"), is_gap: row[6].contains("GAP") }
    };
    rows.map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trace_and_parameters_are_read_whole() {
        assert_eq!(RUNS.map(|run| rows(run).len()), [236, 238]);
        for run in RUNS {
            let settings = settings(run);
            assert_eq!(settings.len(), 19);
            assert_eq!(settings[OF_EVERY_DRIVE].0, "reduction_ratio");
            assert!(matches!(settings[0], ("period_us", U32(_))));
            assert!(rows(run).iter().any(|row| row.is_gap));
        }
    }
}
