//! The registry of models that scenarios can choose.

use std::sync::Arc;

use crate::{PlantModel, backlash_shaft, hard_coulomb, smooth};

/// The models that scenarios can choose, each name once.
#[derive(Debug, Clone)]
pub struct Plants(Vec<Arc<PlantModel>>);

impl Plants {
    /// The models of this crate. A further one is a file and a line here.
    #[must_use]
    pub fn standard() -> Self {
        let models = [smooth::model(), hard_coulomb::model(), backlash_shaft::model()];
        Self(models.map(Arc::new).into())
    }

    /// The same models and another one. It replaces a model of its name.
    #[must_use]
    pub fn with(mut self, model: PlantModel) -> Self {
        let model = Arc::new(model);
        match self.0.iter_mut().find(|registered| registered.name() == model.name()) {
            Some(registered) => *registered = model,
            None => self.0.push(model),
        }
        self
    }

    /// The models, in the order of their registration.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<PlantModel>> {
        self.0.iter()
    }

    /// The model of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Arc<PlantModel>> {
        self.0.iter().find(|model| model.name() == name)
    }
}
