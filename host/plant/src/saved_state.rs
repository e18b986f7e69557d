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
