//! Any bytes are the samples of a run or an error, in bounded memory.

#![no_main]

use lashloop_record::samples::Samples;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match Samples::from_bytes(bytes) {
        Ok(Samples { trace, timing, .. }) => {
            // Each column has a value for each step.
            let is_whole = |values: Option<&[f64]>| values.is_some_and(|it| it.len() == trace.len());
            assert!(trace.signals().iter().all(|signal| is_whole(trace.get(&signal.name))));
            assert_eq!(timing.len(), trace.len());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
