//! A Latin hypercube: each axis is divided into as many strata as there are points, and each stratum has one point.

use lashloop_plant::random::{Pcg64Mcg, SeedableRng, uniform};

/// Fractions, 0 to 1, of each axis for each point. Every axis has a stream of its own, so a further axis changes none of
/// the others.
pub(super) fn fractions(seed: u64, axes: usize, points: u32) -> Vec<Vec<f64>> {
    const STREAM: u64 = 0x9e37_79b9_7f4a_7c15;
    let columns: Vec<_> = (0..axes as u64)
        .map(|axis| column(Pcg64Mcg::seed_from_u64(seed ^ STREAM.wrapping_mul(axis + 1)), points))
        .collect();
    (0..points as usize).map(|point| columns.iter().map(|column| column[point]).collect()).collect()
}

fn column(mut random: Pcg64Mcg, points: u32) -> Vec<f64> {
    let mut strata: Vec<u32> = (0..points).collect();
    for last in (1..strata.len()).rev() {
        let other = (uniform(&mut random) * (last + 1) as f64) as usize;
        strata.swap(last, other);
    }
    strata
        .into_iter()
        .map(|stratum| (f64::from(stratum) + uniform(&mut random)) / f64::from(points))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_of_every_axis_has_one_point() {
        let rows = fractions(7, 3, 50);
        for axis in 0..3 {
            let mut strata: Vec<_> = rows.iter().map(|row| (row[axis] * 50.0) as usize).collect();
            assert_ne!(strata, (0..50).collect::<Vec<_>>(), "axis {axis} is not in order");
            strata.sort_unstable();
            assert_eq!(strata, (0..50).collect::<Vec<_>>(), "axis {axis}");
        }
    }

    #[test]
    fn a_further_axis_changes_no_other() {
        let (two, three) = (fractions(7, 2, 20), fractions(7, 3, 20));
        assert!(two.iter().zip(&three).all(|(two, three)| *two == three[..2]));
        assert_ne!(two, fractions(8, 2, 20), "the seed counts");
    }
}
