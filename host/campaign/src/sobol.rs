//! Sobol points by index.
//!
//! Primitive polynomials and initial direction numbers are those of Joe and Kuo, "Constructing Sobol sequences with better
//! two-dimensional projections", SIAM J. Sci. Comput. 30 (2008), file `new-joe-kuo-6.21201`, dimensions 1 to 21. A digital
//! shift per axis makes different seeds different point sets with the same equidistribution.

/// Degree, coefficients between the first and the last, and initial numbers m of each dimension from the second.
const DIRECTIONS: [(usize, u32, &[u32]); 20] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
    (6, 25, &[1, 1, 5, 5, 19, 61]),
    (7, 1, &[1, 3, 7, 11, 23, 15, 103]),
    (7, 4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Axes at most.
pub const DIMENSIONS: usize = DIRECTIONS.len() + 1;

const BITS: usize = 32;

/// One axis of a Sobol sequence.
#[derive(Debug, Clone)]
pub struct Dimension {
    directions: [u32; BITS],
    shift: u32,
}

impl Dimension {
    /// Dimension `number`, from 0; `None` beyond [`DIMENSIONS`]. `key` is the digital shift.
    #[must_use]
    pub fn new(number: usize, key: u64) -> Option<Self> {
        let mut directions = [0; BITS];
        match number.checked_sub(1) {
            None => {
                for (bit, direction) in directions.iter_mut().enumerate() {
                    *direction = 1 << (BITS - 1 - bit);
                }
            }
            Some(row) => {
                let (degree, coefficients, initial) = *DIRECTIONS.get(row)?;
                for bit in 0..BITS {
                    directions[bit] = match initial.get(bit) {
                        Some(m) => m << (BITS - 1 - bit),
                        None => (1..degree).fold(
                            directions[bit - degree] ^ directions[bit - degree] >> degree,
                            |sum, term| match coefficients >> (degree - 1 - term) & 1 {
                                1 => sum ^ directions[bit - term],
                                _ => sum,
                            },
                        ),
                    };
                }
            }
        }
        Some(Self { directions, shift: (key >> BITS) as u32 })
    }

    /// Coordinate of a point, in [0, 1). The sequence repeats after 2^32 points.
    #[must_use]
    pub fn at(&self, index: u64) -> f64 {
        let set = (0..BITS).filter(|bit| index >> bit & 1 == 1);
        let bits = set.fold(self.shift, |sum, bit| sum ^ self.directions[bit]);
        f64::from(bits) / (1_u64 << BITS) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dimension(number: usize, key: u64) -> Dimension {
        Dimension::new(number, key).expect("a dimension")
    }

    #[test]
    fn first_points_are_those_of_the_published_sequence() {
        // Joe and Kuo's own program prints these points in the order of the Gray code; by index they are a permutation of it.
        let points: Vec<Vec<f64>> =
            (0..4).map(|index| (0..5).map(|number| dimension(number, 0).at(index)).collect()).collect();
        assert_eq!(points[0], [0.0; 5]);
        assert_eq!(points[1], [0.5; 5]);
        assert_eq!(points[3], [0.75, 0.25, 0.25, 0.25, 0.75]);
        assert_eq!(points[2], [0.25, 0.75, 0.75, 0.75, 0.25]);
    }

    #[test]
    fn each_interval_of_each_axis_has_one_of_2_to_the_k_points() {
        for number in 0..DIMENSIONS {
            for key in [0, 0x1234_5678_9abc_def0] {
                let axis = dimension(number, key);
                let mut strata: Vec<_> = (0..256).map(|index| (axis.at(index) * 256.0) as u32).collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..256).collect::<Vec<_>>(), "dimension {number}");
            }
        }
    }

    /// Of a random point set of this size a tenth of the squares would be empty for most pairs.
    #[test]
    fn pairs_of_axes_cover_the_square_more_evenly_than_random_points() {
        for one in 0..DIMENSIONS {
            for other in 0..one {
                let (one_axis, other_axis) = (dimension(one, 0), dimension(other, 0));
                let mut counts = [0; 64];
                for index in 0..4096 {
                    let cell = |axis: &Dimension| (axis.at(index) * 8.0) as usize;
                    counts[cell(&one_axis) * 8 + cell(&other_axis)] += 1;
                }
                assert!(counts.iter().all(|count| *count == 64), "axes {one} and {other}: {counts:?}");
            }
        }
    }

    #[test]
    fn further_dimensions_are_refused() {
        assert!(Dimension::new(DIMENSIONS, 0).is_none());
    }
}
