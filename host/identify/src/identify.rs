//! From motions to estimates.

use lashloop_plant::Mechanics;
use lashloop_plant::backlash_shaft::ShaftParameters;

use crate::cogging::Candidate;
use crate::fit::Fit;
use crate::identified::Identified;
use crate::parameters::{Parameter, Vector};
use crate::prior::Prior;
use crate::problem::{Point, Problem};
use crate::replay::{Motion, Substeps};
use crate::series::{Instruments, Series};
use crate::signs::{Direction, directions};
use crate::staged;

const ITERATIONS: usize = 40;
const RESTARTS: usize = 2;
/// Counts of the cogging per turn that a fit is made with.
const CANDIDATES: usize = 5;
const CANDIDATES_OF_FOLLOWED: usize = 2;
const ITERATIONS_OF_CANDIDATE: usize = 15;
/// Rounds in which motions may begin in another dent of the cogging.
const DENTS: usize = 3;
/// Squares of the residuals up to which another count per turn, or none, may be the true one.
const LIKELY: f64 = 1.1;
/// Quantities that a fit bends first.
const BENT: [Parameter; 6] = [
    Parameter::MotorViscous,
    Parameter::MotorExcess,
    Parameter::MotorStribeck,
    Parameter::LoadExcess,
    Parameter::LoadStribeck,
    Parameter::CurrentLag,
];

/// Where the estimation starts. The motions move it by factors of some 50 at most; what they don't show stays near it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Masses, spring and gap.
    pub mechanics: Mechanics,
    /// Damping, dry friction and drive.
    pub shaft: ShaftParameters,
}

impl Default for Start {
    /// The bench of the paper.
    fn default() -> Self {
        Self { mechanics: Mechanics::paper(), shaft: ShaftParameters::paper() }
    }
}

/// Why there are no estimates.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum IdentifyError {
    /// No series.
    #[error("there is no motion to estimate from; give at least one record")]
    NoSeries,
    /// The motor encoder shows no motion.
    #[error(
        "the motor encoder moves by less than 3 counts under the torques of the record: nothing is observable"
    )]
    MotorAtRest,
    /// The model can't be integrated from any start.
    #[error("no plant model near the start follows the record; give another start with --start SCENARIO")]
    NotFollowed,
}

/// Estimates the drive train of these motions, each of which begins at rest.
///
/// # Errors
/// The motions show nothing, or no model follows them.
pub fn identify(
    series: &[Series],
    instruments: &Instruments,
    start: &Start,
) -> Result<Identified, IdentifyError> {
    if series.is_empty() {
        return Err(IdentifyError::NoSeries);
    }
    let shown = directions(series);
    let motor = shown.motor.ok_or(IdentifyError::MotorAtRest)?;
    // A load at rest has no direction, and any one will do.
    let load = shown.load.unwrap_or(Direction::Forward);
    let motions: Vec<_> = series.iter().map(|it| Motion::new(it, instruments, [motor, load])).collect();
    let fallback = Vector::of(&start.mechanics, &start.shaft);
    let peak_nm = series.iter().map(Series::peak_nm).fold(0.0, f64::max);
    let prior = Prior::new(instruments, peak_nm);
    let [likely, other] = staged::starts(&motions, &fallback, &prior);
    let noise_counts = instruments.noise_counts;
    let first = polished(&motions, likely, &prior, noise_counts);
    let fit = match first {
        Some(fit) if fit.is_followed(noise_counts) => Some(fit),
        first => nearer(first, polished(&motions, other, &prior, noise_counts)),
    };
    let fit = fit.ok_or(IdentifyError::NotFollowed)?;
    Ok(Identified::new(&fit, &prior, shown, instruments))
}

/// The fit that leaves less of the motor's counts.
fn nearer(first: Option<Fit>, second: Option<Fit>) -> Option<Fit> {
    let motor = |fit: &Fit| fit.residual_counts[0];
    first.into_iter().chain(second).min_by(|a, b| motor(a).total_cmp(&motor(b)))
}

/// Fits all parameters. A fit that ends away from the record is repeated from where it ended, with the quantities that it
/// may have bent instead of those that it missed back at their start.
fn polished(motions: &[Motion], point: Point, prior: &Prior, noise_counts: f64) -> Option<Fit> {
    let start = point.vector;
    let mut best = fitted(motions, point, &start, prior, noise_counts)?;
    for _ in 0..RESTARTS {
        if best.is_followed(noise_counts) {
            break;
        }
        let mut kicked = best.point.clone();
        for parameter in BENT {
            kicked.vector.set(parameter, start.get(parameter));
        }
        let Some(other) = fitted(motions, kicked, &start, prior, noise_counts) else { break };
        if other.residual_counts[0] >= best.residual_counts[0] {
            break;
        }
        best = other;
    }
    Some(best)
}

/// Fits all but the cogging, then all with the counts per turn that explain the most of what is left.
fn fitted(
    motions: &[Motion],
    mut point: Point,
    start: &Vector,
    prior: &Prior,
    noise_counts: f64,
) -> Option<Fit> {
    let problem = |is_free, substeps| Problem {
        motions,
        used: (0..motions.len()).collect(),
        start: *start,
        prior: *prior,
        is_free,
        substeps,
    };
    point.vector = point.vector.smooth();
    let smooth = problem(prior.free(|it| !Parameter::COGGING.contains(&it)), Substeps::Coarse);
    let coarse = smooth.fit(point, ITERATIONS)?;
    let candidates = smooth.cogging(&coarse.point)?;
    let all = prior.free(|_| true);
    // A model that follows without cogging leaves little to it.
    let number = if coarse.is_followed(noise_counts) { CANDIDATES_OF_FOLLOWED } else { CANDIDATES };
    let mut tried: Vec<Fit> = Vec::new();
    for Candidate { per_turn, parts_nm, .. } in candidates.into_iter().take(number) {
        let mut next = coarse.point.clone();
        next.vector.cogging_per_turn = per_turn;
        next.vector.set(Parameter::CoggingCosine, parts_nm[0]);
        next.vector.set(Parameter::CoggingSine, parts_nm[1]);
        tried.extend(problem(all, Substeps::Coarse).fit(next, ITERATIONS_OF_CANDIDATE));
        // The others only show how sure the count is.
        if tried.len() >= CANDIDATES_OF_FOLLOWED && tried.iter().any(|it| it.is_followed(noise_counts)) {
            break;
        }
    }
    tried.sort_by(|a, b| a.squares().total_cmp(&b.squares()));
    let nearest = tried.first()?;
    let is_likely = |it: &&Fit| it.squares() < LIKELY * nearest.squares();
    if is_likely(&&coarse) {
        // The others don't pay for a cogging that isn't there, and its bound is that of the nearest.
        let without = prior.free(|it| !Parameter::COGGING.contains(&it));
        let mut fit = problem(without, Substeps::Fine).fit(coarse.point.clone(), ITERATIONS)?;
        fit.take_cogging(nearest);
        return Some(fit);
    }
    let fine = problem(all, Substeps::Fine);
    let mut fit = fine.fit(nearest.point.clone(), ITERATIONS)?;
    for _ in 0..DENTS {
        let Some(other) = fine.other_dents(&fit.point).and_then(|it| fine.fit(it, ITERATIONS)) else { break };
        if other.squares() >= fit.squares() {
            break;
        }
        fit = other;
    }
    fit.per_turn = tried.iter().filter(is_likely).map(|it| it.point.vector.cogging_per_turn).collect();
    Some(fit)
}
