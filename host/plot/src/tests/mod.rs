//! The document, parsed back as a viewer does.

mod document;

use roxmltree::Document;

const SAMPLES: usize = 25_000;

fn times() -> Vec<f64> {
    (0..SAMPLES).map(|sample| sample as f64 * 1e-3).collect()
}

/// Noise that differs from sample to sample by far more than a pixel.
fn noise(sample: usize) -> f64 {
    (sample.wrapping_mul(2_654_435_761) % 1_000) as f64 / 1_000.0
}

fn texts<'a>(document: &'a Document) -> Vec<&'a str> {
    document.descendants().filter(|node| node.has_tag_name("text")).filter_map(|node| node.text()).collect()
}
