//! The runs that the figures are drawn from.

use lashloop_plant::metrics::Metrics;
use lashloop_record::columns::Columns;

use lashloop_plot::Role;

/// One run.
#[derive(Debug, Clone)]
pub struct Run {
    /// The steps to draw, with the columns of [`columns`](lashloop_record::trace::columns).
    pub trace: Columns,
    /// Metrics of the whole run.
    pub metrics: Metrics,
}

/// The three laws on one plant.
#[derive(Debug, Clone)]
pub struct Laws {
    /// The PD cascade.
    pub before: Run,
    /// The cascade with the paper's compensation.
    pub after: Run,
    /// The law beyond the paper, which inverts the gap along a braking curve.
    pub beyond: Run,
}

/// All runs of the figures.
#[derive(Debug, Clone)]
pub struct Runs {
    /// The paper's simulation: smooth dead zone, viscous friction.
    pub smooth: Laws,
    /// The paper's experiment, simplified: hard gap, Coulomb friction.
    pub friction: Laws,
    /// The paper's experiment in full: backlash shaft, Stribeck friction, lag, delay, coarse encoders.
    pub shaft: Laws,
    /// The full experiment under a slow sine; rows of the last period only.
    pub sine: Laws,
    /// The smooth plant at rest, at each twist in turn.
    pub smooth_gap: Columns,
    /// The backlash shaft at rest, at each twist in turn.
    pub hard_gap: Columns,
    /// Reduction ratio N0 of all plants.
    pub ratio: f64,
}

impl Run {
    /// A column of the trace; not a number in every row if plant or drive lack the signal, so that a panel shows no curve.
    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        values(&self.trace, name)
    }

    /// One column less another.
    pub(crate) fn difference(&self, name: &str, less: &str) -> Vec<f64> {
        difference(&self.trace, name, less)
    }
}

/// As [`Run::column`].
pub(super) fn values(trace: &Columns, name: &str) -> Vec<f64> {
    trace.get(name).map_or_else(|| vec![f64::NAN; trace.len()], <[f64]>::to_vec)
}

/// As [`Run::difference`].
pub(super) fn difference(trace: &Columns, name: &str, less: &str) -> Vec<f64> {
    values(trace, name).iter().zip(values(trace, less)).map(|(value, less)| value - less).collect()
}

impl Laws {
    /// Name and role of each law in the legends, with its run.
    pub(super) fn each(&self) -> [(&'static str, Role, &Run); 3] {
        [
            ("before: PD", Role::Before, &self.before),
            ("after: compensation", Role::After, &self.after),
            ("beyond the paper: braking-curve", Role::Other(0), &self.beyond),
        ]
    }
}
