//! The motor as a free body: its torques balance at every instant, so gap, stiffness, inertia, friction, offset and cogging
//! follow without a simulation. A simulation that begins far from the record loses its way, and a fit with it.
//!
//! ```text
//! U - tau U' + o + A sin(n theta + p) = J a + f v + F sgn v + C(z)        z = theta - N theta_s + t
//! C(z) = K (z - j0 sgn z) + c z'  where |z| > j0, 0 within the gap
//! ```
//!
//! Every term passes the same window. All are linear but the gap j0, the ratio N and the twist t of each motion: a grid over
//! gap and twist of one motion finds where to begin, and steps of Gauss and Newton do the rest. A motor that sticks shows
//! none of it, so slow samples don't count.

use crate::cogging::{Candidate, PER_TURN_MAX};
use crate::least_squares::LeastSquares;
use crate::parameters::{Parameter, Vector};
use crate::replay::Motion;
use crate::window::{Gap, Smooth};

/// Half the window in s.
const HALF_S: f64 = 0.012;
/// Steps of the grid over the gap, and over the twist of a motion.
const GAPS: i32 = 24;
const TWISTS: i32 = 48;
/// Logarithm of the widest gap of the grid over the narrowest; the widest is this fraction of what the motor moves.
const GAP_RANGE: f64 = 4.0;
const WIDEST: f64 = 0.95;
/// Largest offset of the torque in the grid, as a fraction of the motion's largest torque; a larger one would take most of the
/// friction in one direction.
const OFFSET_MAX: f64 = 0.5;
/// Every so many samples make a row of the grid, and of the ranking of the cogging.
const SPARSE: usize = 4;
const RANKED: usize = 2;
/// Fewest rows of the grid, and of a motion with the load still.
const ROWS_MIN: f64 = 20.0;
/// Fewest samples on either flank.
const FLANK_ROWS_MIN: usize = 40;
/// Steps of Gauss and Newton.
const ROUNDS: usize = 40;
/// Median distances beyond which a row counts less.
const OUTLIER: f64 = 3.75;
/// Largest step of an angle, as a fraction of the gap and in rad: a flank is a corner.
const STEP_MAX: f64 = 0.3;
const STEP_MAX_RAD: f64 = 0.01;
/// Step from which the angles have converged.
const CONVERGED_RAD: f64 = 1e-6;
const HALF_GAP_MIN_RAD: f64 = 1e-3;

/// Linear unknowns: J, f, F, o, tau, K and c.
const LINEAR: usize = 7;
const OFFSET: usize = 3;
const STIFFNESS: usize = 5;
const DAMPING: usize = 6;

/// What the torques show.
#[derive(Clone)]
pub(crate) struct FreeBody {
    linear: [f64; LINEAR],
    half_gap_rad: f64,
    ratio: f64,
    pub(crate) twists_rad: Vec<f64>,
    /// Counts of the cogging per turn, that which explains the most first.
    pub(crate) cogging: Vec<Candidate>,
    /// Root mean square of the torques that don't balance.
    left_nm: f64,
}

/// Which samples count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    /// Those before the load moves: they don't depend on the ratio.
    Still,
    All,
}

/// Balances the torques of all motions. `None` if they show no motor between two flanks.
pub(crate) fn free_body(motions: &[Motion], ratio: f64) -> Option<FreeBody> {
    let smooth: Vec<_> = motions.iter().map(|it| Smooth::new(it, HALF_S)).collect();
    let share = |it: &Smooth| {
        let rows = it.motor.moves[..it.still].iter().filter(|it| **it).count();
        rows as f64 / it.motion.samples() as f64
    };
    let first = (0..motions.len()).max_by(|&a, &b| share(&smooth[a]).total_cmp(&share(&smooth[b])))?;
    [OFFSET_MAX, f64::INFINITY].into_iter().find_map(|offset_max| balanced(&smooth, first, ratio, offset_max))
}

/// The balance that begins with one motion, and with an offset up to this fraction of its largest torque.
fn balanced(smooth: &[Smooth], first: usize, ratio: f64, offset_max: f64) -> Option<FreeBody> {
    let mut body = FreeBody::by_grid(&smooth[first], ratio, offset_max)?;
    let twist_rad = body.twists_rad[0];
    let twist = |(index, it)| if index == first { twist_rad } else { body.twist(it) };
    body.twists_rad = smooth.iter().enumerate().map(twist).collect();
    for of in [Of::Still, Of::All] {
        body.refine(smooth, of, None)?;
    }
    if !body.shows_both_flanks(smooth) {
        return None;
    }
    let per_turn = body.ranked(smooth)?.first()?.per_turn;
    body.refine(smooth, Of::All, Some(per_turn))?;
    body.cogging = body.ranked(smooth)?;
    Some(body)
}

/// Least and largest angle of the motor while the load is still.
fn range(smooth: &Smooth) -> [f64; 2] {
    let still = &smooth.motor.angle_rad[..smooth.still];
    still.iter().fold([0.0; 2], |[low, high], it| [low.min(*it), high.max(*it)])
}

/// Factors of the linear unknowns at a sample, with the shaft wound by an angle at a rate.
fn row(smooth: &Smooth, at: usize, wound_rad: f64, rate_rad_s: f64) -> [f64; LINEAR] {
    let [acceleration, velocity, side] = smooth.motor.means[at];
    [acceleration, velocity, side, -1.0, smooth.torque[at][1], wound_rad, rate_rad_s]
}

impl FreeBody {
    /// The best gap and twist of one motion while its load is still.
    fn by_grid(smooth: &Smooth, ratio: f64, offset_max: f64) -> Option<Self> {
        let [low, high] = range(smooth);
        // The motion begins at rest under its first torque.
        let held_nm = smooth.motion.held_nm;
        let peak_nm = smooth.motion.torque_nm.iter().fold(0.0_f64, |peak, it| peak.max((it - held_nm).abs()));
        let mut best: Option<(f64, Self)> = None;
        for gap in 0..GAPS {
            let narrower = GAP_RANGE * f64::from(gap) / f64::from(GAPS - 1);
            let half_rad = WIDEST * 0.5 * (high - low) * (-narrower).exp();
            for twist in 0..TWISTS {
                let middle_rad = low + (high - low) * (f64::from(twist) + 0.5) / f64::from(TWISTS);
                if middle_rad - half_rad < low || middle_rad + half_rad > high {
                    continue;
                }
                let gap = Gap { half_rad, twist_rad: -middle_rad, ratio };
                let mut sums = LeastSquares::new(LINEAR);
                for at in (0..smooth.still).step_by(SPARSE).filter(|&at| smooth.motor.moves[at]) {
                    let [wound, rate, ..] = smooth.contact(at, &gap);
                    sums.add(&row(smooth, at, wound, rate), smooth.torque[at][0], 1.0);
                }
                let Some((solution, left)) = sums.solve() else { continue };
                // A flank far off and a large offset balance as well as those that are.
                let is_machine = solution[0] > 0.0
                    && solution[STIFFNESS] > 0.0
                    && (solution[OFFSET] + held_nm).abs() < offset_max * peak_nm;
                let is_better = best.as_ref().is_none_or(|(least, _)| left < *least);
                if is_machine && is_better && sums.rows() >= ROWS_MIN {
                    let body = Self {
                        linear: std::array::from_fn(|at| solution[at]),
                        half_gap_rad: half_rad,
                        ratio,
                        twists_rad: vec![gap.twist_rad],
                        cogging: Vec::new(),
                        left_nm: (left / sums.rows()).sqrt(),
                    };
                    best = Some((left, body));
                }
            }
        }
        best.map(|(_, it)| it)
    }

    /// The twist under which the torques of a motion balance best while its load is still.
    fn twist(&self, smooth: &Smooth) -> f64 {
        const STEPS: i32 = 4 * TWISTS;
        let [low, high] = range(smooth);
        let (low, high) = (low - self.half_gap_rad, high + self.half_gap_rad);
        let distance = |twist_rad: f64| {
            let gap = Gap { half_rad: self.half_gap_rad, twist_rad, ratio: self.ratio };
            let rows = (0..smooth.still).step_by(SPARSE).filter(|&at| smooth.motor.moves[at]);
            rows.map(|at| (1.0 + (self.left_nm(smooth, at, &gap) / self.left_nm).powi(2)).ln()).sum::<f64>()
        };
        let tried = (0..=STEPS).map(|step| -(low + (high - low) * f64::from(step) / f64::from(STEPS)));
        let tried = tried.map(|twist_rad| (distance(twist_rad), twist_rad));
        tried.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |it| it.1)
    }

    /// The flanks of a motion.
    pub(crate) fn gap(&self, motion: usize) -> Gap {
        Gap { half_rad: self.half_gap_rad, twist_rad: self.twists_rad[motion], ratio: self.ratio }
    }

    /// What the shaft transmits at a sample, in N m at the motor.
    pub(crate) fn shaft_nm(&self, smooth: &Smooth, at: usize, gap: &Gap) -> f64 {
        let [wound_rad, rate_rad_s, ..] = smooth.contact(at, gap);
        self.linear[STIFFNESS] * wound_rad + self.linear[DAMPING].max(0.0) * rate_rad_s
    }

    /// Whether the motor pushes on either flank. A start on one flank would explain a motion on the other as well as a start
    /// within the gap, with a gap of any width.
    fn shows_both_flanks(&self, all: &[Smooth]) -> bool {
        let mut rows = [0; 2];
        for (index, smooth) in all.iter().enumerate() {
            let gap = self.gap(index);
            for at in (0..smooth.motion.samples()).filter(|&at| smooth.motor.moves[at]) {
                let [wound_rad, ..] = smooth.contact(at, &gap);
                rows[0] += usize::from(wound_rad > 0.0);
                rows[1] += usize::from(wound_rad < 0.0);
            }
        }
        rows.into_iter().all(|it| it >= FLANK_ROWS_MIN)
    }

    /// What doesn't balance at a sample, cogging included, in N m.
    fn left_nm(&self, smooth: &Smooth, at: usize, gap: &Gap) -> f64 {
        let [wound_rad, rate_rad_s, ..] = smooth.contact(at, gap);
        let row = row(smooth, at, wound_rad, rate_rad_s);
        smooth.torque[at][0] - row.iter().zip(self.linear).map(|(a, b)| a * b).sum::<f64>()
    }

    /// The samples that count as rows: factors of all unknowns, what doesn't balance, motion and sample. The unknowns are the
    /// linear ones, gap, ratio, the twist of each motion, and room for the two parts of a cogging.
    fn rows(&self, all: &[Smooth], of: Of, step: usize) -> Vec<(Vec<f64>, f64, usize, usize)> {
        let mut rows = Vec::new();
        for (index, smooth) in all.iter().enumerate() {
            let gap = self.gap(index);
            let until = if of == Of::Still { smooth.still } else { smooth.motion.samples() };
            for at in (0..until).step_by(step).filter(|&at| smooth.motor.moves[at]) {
                let [wound, rate, side, touches, load] = smooth.contact(at, &gap);
                let stiffness = self.linear[STIFFNESS];
                let mut factors = vec![0.0; LINEAR + 2 + all.len() + 2];
                factors[..LINEAR].copy_from_slice(&row(smooth, at, wound, rate));
                factors[LINEAR] = -stiffness * side;
                factors[LINEAR + 1] = if of == Of::All { -stiffness * load } else { 0.0 };
                factors[LINEAR + 2 + index] = stiffness * touches;
                rows.push((factors, self.left_nm(smooth, at, &gap), index, at));
            }
        }
        rows
    }

    /// Steps of Gauss and Newton; keeps the nearest.
    fn refine(&mut self, all: &[Smooth], of: Of, per_turn: Option<u32>) -> Option<()> {
        let mut parts_nm = [0.0; 2];
        let mut nearest: Option<Self> = None;
        for _ in 0..ROUNDS {
            let mut rows = self.rows(all, of, 1);
            for (factors, left, index, at) in &mut rows {
                let Some(per_turn) = per_turn else { break };
                let [cosine, sine] = all[*index].waves(*at, per_turn);
                *left += parts_nm[0] * cosine + parts_nm[1] * sine;
                set_waves(factors, [cosine, sine]);
            }
            let sums = robust(&rows)?;
            self.left_nm = sums.root_mean_square();
            if nearest.as_ref().is_none_or(|it| self.left_nm < it.left_nm) {
                nearest = Some(self.clone());
            }
            let (step, _) = sums.solve()?;
            let angles = (LINEAR + 2..LINEAR + 2 + all.len()).chain([LINEAR]);
            let farthest_rad = angles.map(|at| step[at].abs()).fold(0.0, f64::max);
            let part = ((STEP_MAX * self.half_gap_rad + STEP_MAX_RAD) / farthest_rad).min(1.0);
            let mut steps = step.iter().map(|it| part * it);
            self.linear.iter_mut().zip(&mut steps).for_each(|(it, step)| *it += step);
            self.half_gap_rad = (self.half_gap_rad + steps.next()?).max(HALF_GAP_MIN_RAD);
            self.ratio += steps.next()?;
            self.twists_rad.iter_mut().zip(&mut steps).for_each(|(it, step)| *it += step);
            parts_nm.iter_mut().zip(steps).for_each(|(it, step)| *it += step);
            if part * farthest_rad < CONVERGED_RAD {
                break;
            }
        }
        *self = nearest?;
        Some(())
    }

    /// All counts of the cogging per turn by what they explain of what doesn't balance.
    fn ranked(&self, all: &[Smooth]) -> Option<Vec<Candidate>> {
        let mut rows = self.rows(all, Of::All, RANKED);
        let mut found = Vec::new();
        for per_turn in 1..=PER_TURN_MAX {
            for (factors, _, index, at) in &mut rows {
                set_waves(factors, all[*index].waves(*at, per_turn));
            }
            let Some((solution, left)) = robust(&rows)?.solve() else { continue };
            let last = solution.len();
            found.push(Candidate {
                per_turn,
                parts_nm: [solution[last - 2], solution[last - 1]],
                gain: -left,
            });
        }
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Some(found)
    }

    /// Takes over what is shown. `None` if it isn't a drive train.
    pub(crate) fn put_on(&self, vector: &mut Vector) -> Option<()> {
        let [inertia, viscous, coulomb, offset_nm, lag_s, stiffness, damping] = self.linear;
        if inertia.min(stiffness).min(self.ratio) <= 0.0 {
            return None;
        }
        let shown = [
            (Parameter::MotorInertia, inertia),
            (Parameter::MotorViscous, viscous),
            (Parameter::MotorCoulomb, coulomb),
            (Parameter::CurrentLag, lag_s),
            (Parameter::Stiffness, stiffness),
            (Parameter::ShaftDamping, damping),
            (Parameter::DeadZone, self.half_gap_rad),
            (Parameter::Ratio, self.ratio),
        ];
        for (parameter, value) in shown {
            // One below 0 is too small to show.
            if value > 1e-9 {
                vector.set(parameter, value.ln());
            }
        }
        vector.set(Parameter::TorqueOffset, offset_nm);
        Some(())
    }
}

/// The last two unknowns add to the torque.
fn set_waves(factors: &mut [f64], waves: [f64; 2]) {
    let first = factors.len() - 2;
    factors[first..].copy_from_slice(&waves.map(|it| -it));
}

/// Least squares with less weight for rows that are far off. `None` without rows.
fn robust(rows: &[(Vec<f64>, f64, usize, usize)]) -> Option<LeastSquares> {
    let mut sizes: Vec<f64> = rows.iter().map(|(_, left_nm, ..)| left_nm.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let far_nm = OUTLIER * sizes.get(sizes.len() / 2)?.max(1e-9);
    let mut sums = LeastSquares::new(rows[0].0.len());
    for (factors, left_nm, ..) in rows {
        sums.add(factors, *left_nm, (far_nm / left_nm.abs()).min(1.0));
    }
    Some(sums)
}
