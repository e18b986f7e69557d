//! `runs.csv`: a row per run. A missing score is its reason.

use std::io::{self, Write};

use super::case::{Case, CaseResult};
use super::score::Criterion;

/// Writes the rows in the given order. Numbers have the fewest digits that restore the same bits.
///
/// # Errors
/// Errors of `out`.
pub fn write<'a>(
    out: impl Write,
    results: impl Iterator<Item = (&'a Case, &'a CaseResult)>,
) -> io::Result<()> {
    let mut table = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    let criteria = Criterion::ALL.map(Criterion::key);
    let columns = ["part", "row", "controller"].into_iter().chain(criteria);
    table.write_record(columns.chain(["end", "torque_sha256", "set"]))?;
    for (case, CaseResult { scores, end, torque_sha256, .. }) in results {
        table.serialize((case.id, scores, end, torque_sha256, case.settings.join(" ")))?;
    }
    table.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::law::Law;
    use crate::campaign::plan::{Settings, cases};

    #[test]
    fn columns_are_in_the_order_of_the_heading() {
        let settings = Settings { seed: 1, plants: 1, laws: vec![Law::BEFORE], sweeps: false };
        let case = &cases(&settings).expect("a case")[0];
        let scores = r#"{"settle_time_s":"never","overshoot_rad":0.0,"static_error_rad":-1e-7,
            "static_error_bands":-5e-5,"hunting_rad":0.5,"dead_zone_error_rad":1.0,
            "learnt_dead_zone_error_rad":"not learnt","dead_zone_deviation_rad":0.25,"effort_nm2s":"not finite",
            "torque_total_variation_nm":0.1}"#;
        let result = CaseResult {
            case: case.id,
            end: "complete".to_owned(),
            scores: serde_json::from_str(scores).expect("scores"),
            torque_sha256: "00ff".to_owned(),
        };
        let mut text = Vec::new();
        write(&mut text, [(case, &result)].into_iter()).expect("a table");
        let text = String::from_utf8(text).expect("text");
        let (heading, row) = text.split_once('\n').expect("two lines");
        assert_eq!(
            heading,
            "part,row,controller,settle_time_s,overshoot_rad,static_error_rad,static_error_bands,hunting_rad,\
             dead_zone_error_rad,learnt_dead_zone_error_rad,dead_zone_deviation_rad,effort_nm2s,\
             torque_total_variation_nm,end,torque_sha256,set"
        );
        let cells = "random-plants,0,pd,never,0.0,-1e-7,-0.00005,0.5,1.0,not learnt,0.25,not finite,0.1,complete,00ff,\
                     plant.load_inertia_kg_m2=";
        assert!(row.starts_with(cells), "{row}");
    }
}
