//! Identification of a drive train with backlash.
#![forbid(unsafe_code)]

mod fit;
mod parameters;
mod replay;
mod series;
mod signs;
mod staged;

pub use series::{Instruments, Series, SeriesError};
pub use signs::{Direction, Directions, directions};

/// temporary
pub fn try_it(series: &[Series], instruments: &Instruments) -> Option<Vec<(String, f64, f64)>> {
    use lashloop_plant::Mechanics;
    use lashloop_plant::backlash_shaft::ShaftParameters;
    let d = directions(series);
    let (Some(m), Some(l)) = (d.motor, d.load) else { return None };
    let motions: Vec<_> = series.iter().map(|s| replay::Motion::new(s, instruments, [m, l])).collect();
    let fallback = parameters::Vector::of(&Mechanics::paper(), &ShaftParameters::paper());
    let t = std::time::Instant::now();
    let point = staged::start(&motions, &fallback);
    let t1 = t.elapsed();
    let problem = fit::Problem { motions: &motions, start: point.vector, used: (0..motions.len()).collect(), is_free: [true; parameters::COUNT] };
    let fit = problem.fit(point, 25)?;
    let t2 = t.elapsed();
    if std::env::var("DBG").is_ok() {
        eprintln!("   start {t1:?} fit {:?} residual {:?}", t2 - t1, fit.residual_counts);
    }
    let mut out = vec![("residual".to_string(), fit.residual_counts[0], fit.residual_counts[1])];
    for p in parameters::Parameter::ALL {
        out.push((format!("{p:?}"), fit.point.vector.get(p), fit.covariance[(p as usize, p as usize)].sqrt()));
    }
    Some(out)
}

/// temporary
pub fn truth_of(m: &lashloop_plant::Mechanics, s: &lashloop_plant::backlash_shaft::ShaftParameters) -> Vec<f64> {
    parameters::Vector::of(m, s).0.to_vec()
}
