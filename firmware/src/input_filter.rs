//! The filters of the inputs of an encoder: pulses that they stop are noise.

/// Lengths of the input filters of an STM32F405 at a timer clock of 84 MHz, in ns, ascending: a shorter pulse is noise (RM0090 18.4.7).
pub const FILTERS_NS: [f32; 8] = [47.6, 95.2, 142.9, 190.5, 381.0, 761.9, 1523.8, 3047.6];

/// Index of the shortest of these filters that stops pulses of up to this length, to the nearest ns.
#[must_use]
pub fn filter_for(filters_ns: &[f32], pulse_ns: u32) -> Option<usize> {
    filters_ns.iter().position(|filter_ns| filter_ns + 0.5 >= pulse_ns as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_for_a_pulse_is_the_shortest_that_stops_it() {
        let of = |pulse_ns| filter_for(&FILTERS_NS, pulse_ns).map(|at| FILTERS_NS[at]);
        for (pulse_ns, want) in [
            (0, 47.6),
            (48, 47.6),
            (60, 95.2),
            (95, 95.2),
            (120, 142.9),
            (143, 142.9),
            (144, 190.5),
            (3048, 3047.6),
        ] {
            assert_eq!(of(pulse_ns), Some(want), "{pulse_ns}");
        }
        assert_eq!(of(3049), None);
    }
}
