//! From motions to estimates.

use lashloop_plant::Mechanics;
use lashloop_plant::backlash_shaft::ShaftParameters;

use crate::fit::Fit;
use crate::identified::Identified;
use crate::parameters::{Parameter, Vector};
use crate::prior::Prior;
use crate::problem::{Point, Problem};
use crate::replay::{Motion, Substeps};
use crate::series::{Instruments, Series};
use crate::signs::{Direction, directions};
use crate::staged::{self, Begin};

const ITERATIONS: usize = 40;
/// Of a fit for the estimates, which may follow a valley for long.
const ITERATIONS_OF_ESTIMATE: usize = 80;
const RESTARTS: usize = 2;
/// Counts of the cogging per turn that a fit is made with.
const CANDIDATES: usize = 5;
const CANDIDATES_OF_FOLLOWED: usize = 2;
const ITERATIONS_OF_CANDIDATE: usize = 15;
/// Rounds in which motions may begin in another dent of the cogging.
const DENTS: usize = 3;
/// Squares of the residuals up to which another count per turn, or none, may be the true one.
const LIKELY: f64 = 1.1;
/// Squares of the residuals without cogging over those with it, from which its count per turn is sure.
const DECISIVE: f64 = 100.0;
/// Change of the squares of the residuals that isn't worth another fit.
const SAME: f64 = 0.02;
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
    let noise_counts = instruments.noise_counts;
    let mut fit: Option<Fit> = None;
    for begin in staged::starts(&motions, &fallback) {
        fit = nearer(fit, polished(&motions, begin, &prior, noise_counts));
        if fit.as_ref().is_some_and(|it| it.is_followed(noise_counts)) {
            break;
        }
    }
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
fn polished(motions: &[Motion], begin: Begin, prior: &Prior, noise_counts: f64) -> Option<Fit> {
    let start = begin.point.vector;
    let mut best = fitted(motions, &begin, &start, prior, noise_counts)?;
    for _ in 0..RESTARTS {
        if best.is_followed(noise_counts) {
            break;
        }
        let mut point = best.point.clone();
        let cogging = begin.cogging_of(&point);
        point.vector = point.vector.smooth();
        for parameter in BENT {
            point.vector.set(parameter, start.get(parameter));
        }
        let kicked = Begin { point, cogging };
        let Some(other) = fitted(motions, &kicked, &start, prior, noise_counts) else { break };
        if other.residual_counts[0] >= best.residual_counts[0] {
            break;
        }
        best = other;
    }
    Some(best)
}

/// Fits all with the count of the cogging per turn that the balance of the torques shows. Unless that leaves the quantisation
/// alone, fits all but the cogging, then all with the counts that explain the most of what is left, and takes the nearest.
fn fitted(
    motions: &[Motion],
    begin: &Begin,
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
    let of_all = |substeps| problem(prior.free(|_| true), substeps);
    let all = of_all(Substeps::Coarse);
    let is_smooth = prior.free(|it| !Parameter::COGGING.contains(&it));
    let smooth = problem(is_smooth, Substeps::Coarse);
    let shown = begin.cogging.first().and_then(|it| all.fit(it.put_on(&begin.point), ITERATIONS));
    let finished_shown = shown.as_ref().and_then(|it| finished(of_all, &it.point, noise_counts));
    if finished_shown.is_some() && begin.shows_cogging() {
        return finished_shown;
    }
    let is_exact = finished_shown.as_ref().is_some_and(|it| it.is_exact(noise_counts));
    let from = finished_shown.as_ref().filter(|_| is_exact).map_or(&begin.point, |it| &it.point);
    let without = Point { vector: from.vector.smooth(), ..from.clone() };
    let iterations = if is_exact { ITERATIONS_OF_CANDIDATE } else { ITERATIONS };
    let Some(coarse) = smooth.fit(without, iterations) else { return finished_shown };
    let mut tried: Vec<Fit> = Vec::new();
    if finished_shown.is_some() && shown.as_ref().is_some_and(|it| coarse.squares() > DECISIVE * it.squares())
    {
        return finished_shown;
    }
    let candidates = if is_exact {
        begin.cogging.iter().skip(1).take(1).copied().collect()
    } else {
        // A model that follows without cogging leaves little to it.
        let number = if coarse.is_followed(noise_counts) { CANDIDATES_OF_FOLLOWED } else { CANDIDATES };
        let Some(mut found) = smooth.cogging(&coarse.point) else { return finished_shown };
        found.truncate(number);
        found
    };
    tried.extend(shown);
    for candidate in candidates {
        tried.extend(all.fit(candidate.put_on(&coarse.point), ITERATIONS_OF_CANDIDATE));
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
        let mut fit = problem(is_smooth, Substeps::Fine).fit(coarse.point.clone(), ITERATIONS)?;
        fit.take_cogging(nearest);
        return Some(fit);
    }
    let per_turn = |it: &Fit| it.point.vector.cogging_per_turn;
    let mut fit = match finished_shown {
        Some(shown) if is_exact => shown,
        shown => {
            let tried = finished(of_all, &nearest.point, noise_counts);
            shown.into_iter().chain(tried).min_by(|a, b| a.squares().total_cmp(&b.squares()))?
        }
    };
    fit.per_turn = tried.iter().filter(is_likely).map(per_turn).collect();
    Some(fit)
}

/// The fit for the estimates, in smaller steps where the motor passes the teeth of the cogging too fast for the usual ones.
fn finished<'a>(problem: impl Fn(Substeps) -> Problem<'a>, point: &Point, noise_counts: f64) -> Option<Fit> {
    let fit = dented(&problem(Substeps::Fine), point)?;
    if fit.is_followed(noise_counts) {
        return Some(fit);
    }
    let finest = problem(Substeps::Finest);
    let is_same =
        finest.squares(&fit.point).is_none_or(|squares| (squares / fit.squares() - 1.0).abs() < SAME);
    let finest = if is_same { None } else { dented(&finest, &fit.point) };
    if finest.as_ref().is_some_and(|it| it.is_followed(noise_counts)) {
        return finest;
    }
    let recorded = problem(Substeps::Recorded).fit(point.clone(), ITERATIONS_OF_ESTIMATE);
    [finest, recorded].into_iter().flatten().chain([fit]).min_by(|a, b| a.squares().total_cmp(&b.squares()))
}

/// The fit with motions that may begin in other dents of the cogging.
fn dented(fine: &Problem, point: &Point) -> Option<Fit> {
    let mut fit = fine.fit(point.clone(), ITERATIONS_OF_ESTIMATE)?;
    for _ in 0..DENTS {
        let Some(other) = fine.other_rests(&fit.point).and_then(|it| fine.fit(it, ITERATIONS_OF_ESTIMATE))
        else {
            break;
        };
        if other.squares() >= fit.squares() {
            break;
        }
        fit = other;
    }
    Some(fit)
}
