//! What no statistic and no map can be made of: runs that aren't samples of one population, points that are repeated or not in
//! order.

use std::collections::BTreeSet;

use crate::axis::{Axis, AxisValue, Values};
use crate::settings::{CampaignFile, Expectation, Method};

/// Why the runs of an expectation aren't independent samples of one population, which a confidence interval needs.
pub(crate) fn population(file: &CampaignFile, expectation: &Expectation) -> Option<&'static str> {
    let mut parts = file.parts.iter().filter(|it| expectation.part.iter().all(|name| *name == it.name));
    let is_sampled = parts.all(|part| part.method.is_sampled());
    if expectation.variant.is_none() && file.variants.len() > 1 {
        Some("which pools variants on the same points; add variant")
    } else if !is_sampled {
        Some(
            "which covers a grid or a list, whose points aren't samples; add part = a sampled part, or remove confidence",
        )
    } else if expectation.part.is_none() && file.parts.len() > 1 {
        Some("which pools parts, whose points share their random streams; add part")
    } else {
        None
    }
}

/// What is wrong with the points of a grid or a list: one that is repeated counts twice, and a map interpolates between
/// neighbouring values.
pub(crate) fn points(method: Method, axes: &[Axis]) -> Option<String> {
    let repeats = |axis: &&Axis| !axis.values.are_distinct();
    match method {
        Method::Grid => {
            if let Some(axis) = axes.iter().find(repeats) {
                let name = axis.name();
                return Some(format!(
                    "is a grid that has a value of {name} twice; remove one, or take fewer points"
                ));
            }
            let unordered = axes.iter().find(|axis| axes.len() > 1 && !is_ordered(&axis.values))?;
            Some(format!(
                "is a grid whose values of {} neither rise nor fall; sort them, because maps interpolate between neighbours",
                unordered.name()
            ))
        }
        Method::List if !axes.is_empty() && axes.iter().all(|axis| repeats(&axis)) => {
            let mut rows = BTreeSet::new();
            let row = |at| axes.iter().map(|axis| axis.values.at_index(at).setting()).collect::<Vec<_>>();
            let twice = (0..axes[0].values.len()).find(|at| !rows.insert(row(*at)))?;
            Some(format!("is a list whose row {twice} repeats an earlier one; remove it"))
        }
        Method::List | Method::Random | Method::LatinHypercube | Method::Sobol => None,
    }
}

/// Whether numbers rise or fall; other values have no order.
fn is_ordered(values: &Values) -> bool {
    let Values::Listed(listed) = values else { return true };
    let numbers: Option<Vec<_>> = listed.iter().map(AxisValue::number).collect();
    numbers.is_none_or(|it| it.is_sorted() || it.is_sorted_by(|one, next| one >= next))
}
