//! Quantiles of Student's distribution.

/// The value within which +- lie 95 % of a t-distribution, to 0.3 %: the expansion of Cornish and Fisher around the normal
/// quantile (Abramowitz and Stegun, 26.7.5).
pub(crate) fn within_95_percent(degrees_of_freedom: f64) -> f64 {
    const Z: f64 = 1.959_963_984_540_054;
    let n = degrees_of_freedom.max(2.0);
    let z2 = Z * Z;
    let first = Z * (z2 + 1.0) / 4.0;
    let second = Z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let third = Z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    let fourth = Z * ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92160.0;
    Z + first / n + second / n.powi(2) + third / n.powi(3) + fourth / n.powi(4)
}

#[cfg(test)]
mod tests {
    use super::within_95_percent;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, want) in
            [(4.0, 2.776), (6.0, 2.447), (10.0, 2.228), (14.0, 2.145), (60.0, 2.000), (1e9, 1.960)]
        {
            let have = within_95_percent(freedom);
            assert!((have / want - 1.0).abs() < 3e-3, "{freedom}: have {have}, want {want}");
        }
    }
}
