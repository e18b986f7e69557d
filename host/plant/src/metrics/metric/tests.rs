//! The list of metrics against its page.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde::Deserialize as _;
use serde::de::IntoDeserializer as _;
use serde::de::value::{Error, StrDeserializer};

use super::Metric;
use crate::metrics::Statistic;

/// Every table of definitions in `docs/metrics.md` is printed from the code.
#[test]
fn page_has_the_definitions_of_the_code() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/metrics.md");
    let page = fs::read_to_string(path).expect("docs/metrics.md");
    let mut metrics = "| metric | unit | definition |\n|---|---|---|\n".to_owned();
    for metric in Metric::ALL {
        writeln!(metrics, "| `{metric}` | {} | {} |", metric.unit(), metric.meaning()).expect("a String");
    }
    let mut statistics = "| statistic | definition |\n|---|---|\n".to_owned();
    for statistic in Statistic::ALL {
        writeln!(statistics, "| `{statistic}` | {} |", statistic.meaning()).expect("a String");
    }
    for table in [metrics, statistics] {
        // The empty line ends the table, so that no row is left over.
        assert!(page.contains(&format!("\n{table}\n")), "docs/metrics.md lacks this table:\n{table}");
    }
}

/// A record is written by serde and read by name.
#[test]
fn a_statistic_has_one_name() {
    for statistic in Statistic::ALL {
        let name: StrDeserializer<'_, Error> = statistic.name().into_deserializer();
        assert_eq!(Statistic::deserialize(name).expect("a name"), statistic);
    }
}

#[test]
fn name_of_a_metric_ends_with_its_unit() {
    for metric in Metric::ALL {
        let end = match metric.unit() {
            "s" => "_s",
            "rad" => "_rad",
            "N m" => "_nm",
            "N^2 m^2 s" => "_nm2s",
            "" => "_deviations",
            other => panic!("{metric}: no ending for {other}"),
        };
        assert!(metric.name().ends_with(end), "{metric}");
    }
}
