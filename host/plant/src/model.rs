//! Models of plants: registered values with a name, keys and a function that builds the plant.

use std::fmt;
use std::sync::Arc;

use crate::signal::validate_signals;
use crate::{Key, Plant, PlantError, PlantValues, Release};

type Build = dyn Fn(&Release<'_>) -> Result<Box<dyn Plant>, PlantError> + Send + Sync;

/// What a run may change in a plant. The default is nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Changes {
    /// Whether the plant takes wear and load torque by [`Plant::set_environment`]. Its scenarios then have the sections
    /// `[plant.wear]` and `[plant.load_torque]`, and the faults `gap-growth` and `load-torque`.
    pub environment: bool,
    /// Keys that the fault `stiffness-drop` scales; none if the plant does not take it.
    pub stiffness: &'static [&'static str],
    /// Keys that the fault `friction-change` scales; none if the plant does not take it.
    pub friction: &'static [&'static str],
}

/// A model of a plant. A scenario chooses it by `plant.model` and gives its keys in `[plant]`.
#[derive(Clone)]
pub struct PlantModel {
    name: &'static str,
    summary: &'static str,
    keys: Vec<Key>,
    changes: Changes,
    build: Arc<Build>,
}

impl PlantModel {
    /// A model. `summary` is one sentence for documents, `build` makes a plant from values that lie in the ranges of `keys`.
    pub fn new(
        name: &'static str,
        summary: &'static str,
        keys: Vec<Key>,
        build: impl Fn(&Release<'_>) -> Result<Box<dyn Plant>, PlantError> + Send + Sync + 'static,
    ) -> Self {
        Self { name, summary, keys, changes: Changes::default(), build: Arc::new(build) }
    }

    /// The same model of plants that change during a run.
    #[must_use]
    pub fn with_changes(self, changes: Changes) -> Self {
        Self { changes, ..self }
    }

    /// Name in scenarios, in lower case with hyphens.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// One sentence for documents.
    #[must_use]
    pub fn summary(&self) -> &'static str {
        self.summary
    }

    /// Keys in `[plant]`, in the order of documents and records.
    #[must_use]
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// What a run may change.
    #[must_use]
    pub fn changes(&self) -> &Changes {
        &self.changes
    }

    /// The values of a scenario that gives no key: every default.
    #[must_use]
    pub fn defaults(&self) -> PlantValues {
        let mut values = PlantValues::default();
        for key in &self.keys {
            if let Some(value) = key.default_value() {
                values.insert(key.name, value);
            }
        }
        values
    }

    /// A plant of this model.
    ///
    /// # Errors
    /// A value is outside its range, a required one is missing, the plant can't be built from them, or its signals don't fit into
    /// a record.
    pub fn release(&self, release: &Release<'_>) -> Result<Box<dyn Plant>, PlantError> {
        for key in &self.keys {
            if let Some(value) = release.values.get(key.name) {
                key.check(value)?;
            }
        }
        let plant = (self.build)(release)?;
        validate_signals(plant.signals())?;
        Ok(plant)
    }
}

impl fmt::Debug for PlantModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("PlantModel").field(&self.name).finish()
    }
}

impl PartialEq for PlantModel {
    /// Models are equal if they have one name: a registry has each name once.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{PlantValue, Plants, Positions, Signal, Start, backlash_shaft, hard_coulomb, smooth};

    /// A plant that does not move.
    struct Fixed(Vec<Signal>);

    impl Plant for Fixed {
        fn signals(&self) -> &[Signal] {
            &self.0
        }

        fn truth(&self, values: &mut [f64]) {
            values.fill(0.0);
        }

        fn positions(&self) -> Positions {
            Positions { motor_position_rad: 0.0, load_position_rad: 0.0 }
        }

        fn step(&mut self, _torque_nm: f64, _dt_s: f64) -> Result<(), PlantError> {
            Ok(())
        }
    }

    fn release(model: &PlantModel, values: &PlantValues) -> Result<Box<dyn Plant>, PlantError> {
        let start = Start::at_rest(0.0, 0.1);
        model.release(&Release { values, start, period_s: 1e-3, folder: Path::new("") })
    }

    fn error(model: &PlantModel, values: &PlantValues) -> String {
        release(model, values).err().expect("an error").to_string()
    }

    fn with_signals(signals: Vec<Signal>) -> String {
        let model = PlantModel::new("fixed", "", Vec::new(), move |_| Ok(Box::new(Fixed(signals.clone()))));
        error(&model, &model.defaults())
    }

    #[test]
    fn values_out_of_range_are_rejected_by_name() {
        let model = smooth::model();
        let mut values = model.defaults();
        values.insert("dead_zone_rad", PlantValue::Number(0.0));
        let want =
            "parameter dead_zone_rad of the simulated plant is 0, allowed is 0.000001 to 3.141592653589793";
        assert_eq!(error(&model, &values), want);
        let model = hard_coulomb::model();
        let mut values = model.defaults();
        values.insert("load_coulomb_nm", PlantValue::Number(f64::NAN));
        assert!(
            error(&model, &values).starts_with("parameter load_coulomb_nm of the simulated plant is NaN")
        );
        let mut values = model.defaults();
        values.insert("substeps", PlantValue::Integer(0));
        assert!(error(&model, &values).starts_with("parameter substeps of the simulated plant is 0"));
    }

    #[test]
    fn a_missing_value_is_an_error_that_names_the_key() {
        let want = "key substeps of the simulated plant has no whole number; declare it in the model's keys, or give it in [plant]";
        let mut values = PlantValues::default();
        for (key, value) in smooth::model().defaults().iter().filter(|(key, _)| *key != "substeps") {
            values.insert(key, value.clone());
        }
        assert_eq!(error(&smooth::model(), &values), want);
    }

    #[test]
    fn signals_must_fit_into_a_record() {
        let many =
            (0..49).map(|index| Signal { name: format!("s{index}").into(), unit: "".into() }).collect();
        assert_eq!(with_signals(many), "the plant has 49 signals, at most 48 are allowed; leave some out");
        for name in ["torque_nm", "drive.x", ""] {
            assert!(with_signals(vec![Signal::new(name, "")]).contains("rename the signal"), "{name}");
        }
        let twice = vec![Signal::new("speed_rad_s", "rad/s"); 2];
        assert!(with_signals(twice).contains("\"speed_rad_s\", but a column of the record has this name"));
    }

    #[test]
    fn a_plant_that_takes_no_change_rejects_it() {
        let values = smooth::model().defaults();
        let mut plant = release(&smooth::model(), &values).expect("a plant");
        let mut before = vec![0.0; plant.signals().len()];
        plant.truth(&mut before);
        let environment = crate::Environment { gap_growth_rad: 0.1, load_torque_nm: 0.0 };
        let want = Err(PlantError::FixedEnvironment);
        assert_eq!(plant.set_environment(environment), want);
        let start = Start::at_rest(0.0, 0.1);
        let release = Release { values: &values, start, period_s: 1e-3, folder: Path::new("") };
        assert_eq!(plant.change_parameters(&release), want);
        let mut after = vec![0.0; plant.signals().len()];
        plant.truth(&mut after);
        assert_eq!(before, after);
    }

    #[test]
    fn a_model_replaces_the_one_of_its_name() {
        let own = PlantModel::new("smooth", "mine", Vec::new(), |_| Ok(Box::new(Fixed(Vec::new()))));
        let plants = Plants::standard().with(own);
        let names: Vec<_> = plants.iter().map(|model| model.name()).collect();
        assert_eq!(names, ["smooth", "hard-coulomb", backlash_shaft::NAME]);
        assert_eq!(plants.get("smooth").map(|model| model.summary()), Some("mine"));
    }
}
