//! States as lists of numbers, from which a plant continues bit for bit.

use nalgebra::SVector;

use crate::mode::{Contact, DryFriction};

/// Numbers of a saved state that aren't taken yet.
pub type Numbers<'a> = std::iter::Copied<std::slice::Iter<'a, f64>>;

/// A state that can be saved.
pub trait SavedState: Sized {
    /// Appends its numbers.
    fn save(&self, numbers: &mut Vec<f64>);

    /// Takes the numbers that [`save`](Self::save) appended; `None` if they are those of another state.
    fn restored(numbers: &mut Numbers<'_>) -> Option<Self>;
}

impl SavedState for f64 {
    fn save(&self, numbers: &mut Vec<f64>) {
        numbers.push(*self);
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        numbers.next()
    }
}

impl<const N: usize> SavedState for [f64; N] {
    fn save(&self, numbers: &mut Vec<f64>) {
        numbers.extend(self);
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        let mut array = [0.0; N];
        for number in &mut array {
            *number = numbers.next()?;
        }
        Some(array)
    }
}

impl<const N: usize> SavedState for SVector<f64, N> {
    fn save(&self, numbers: &mut Vec<f64>) {
        numbers.extend(self.iter());
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        SavedState::restored(numbers).map(<[f64; N]>::into)
    }
}

impl SavedState for Contact {
    fn save(&self, numbers: &mut Vec<f64>) {
        numbers.push(self.sign());
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        let sign = numbers.next()?;
        [Self::Negative, Self::Gap, Self::Positive].into_iter().find(|it| it.sign() == sign)
    }
}

impl SavedState for DryFriction {
    fn save(&self, numbers: &mut Vec<f64>) {
        numbers.push(self.sign());
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        let sign = numbers.next()?;
        [Self::SlipNegative, Self::Stick, Self::SlipPositive].into_iter().find(|it| it.sign() == sign)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::{Environment, Plant, Plants, Release, Start};

    /// Moves a plant to and fro across its gap, and returns all that is known of it.
    fn moved(plant: &mut dyn Plant, steps: std::ops::Range<u32>) -> Vec<u64> {
        let mut values = vec![0.0; plant.signals().len()];
        let mut bits = Vec::new();
        for step in steps {
            plant.step(if step % 120 < 60 { 6.0 } else { -6.0 }, 1e-3).expect("a step");
            plant.truth(&mut values);
            bits.extend(values.iter().map(|value| value.to_bits()));
        }
        bits
    }

    #[test]
    fn a_restored_plant_continues_bit_for_bit_and_refuses_a_part_of_its_numbers() {
        let plants = Plants::standard();
        let models = ["smooth", "hard-coulomb", "backlash-shaft"];
        let mut all = Vec::new();
        for name in models {
            let model = plants.get(name).expect("a model");
            let values = model.defaults();
            let start = Start::at_rest(0.0, 0.05);
            let release = Release { values: &values, start, period_s: 1e-3, folder: Path::new("") };
            let [mut plant, mut other] = [(); 2].map(|()| model.release(&release).expect("a plant"));
            if model.changes().environment {
                let environment = Environment { gap_growth_rad: 0.1, load_torque_nm: 0.5 };
                plant.set_environment(environment).expect("wear");
            }
            moved(&mut *plant, 0..250);
            let mut numbers = Vec::new();
            assert!(plant.save(&mut numbers), "{name}");
            assert!(other.restore(&mut numbers.iter().copied()), "{name}");
            assert_eq!(moved(&mut *plant, 250..500), moved(&mut *other, 250..500), "{name}");
            all.push((other, numbers));
        }
        for (plant, numbers) in &mut all {
            let short = &numbers[..numbers.len() - 1];
            let mut before = Vec::new();
            plant.save(&mut before);
            assert!(!plant.restore(&mut short.iter().copied()));
            let mut after = Vec::new();
            plant.save(&mut after);
            assert_eq!(before, after, "it stays as it is");
        }
    }
}
