//! A motion behind a smooth window: means, velocities and accelerations of counts.
//!
//! The window is (1 - x^2)^3. Its derivatives under the sum take those of the counts, and every term of a linear equation that
//! passes the same window still balances. So no term lags behind another, and quantisation averages out.

use crate::replay::Motion;

/// Counts within a window below which a shaft may stick.
const SLOW_COUNTS: f64 = 4.0;
/// Load counts up to which the load counts as still at its first position, without noise.
const STILL_COUNTS: f64 = 1.0;

/// Weights of the samples of a window.
pub(crate) struct Window {
    mean: Vec<f64>,
    /// Gives the velocity, in 1/s.
    slope: Vec<f64>,
    /// Gives the acceleration, in 1/s^2.
    bend: Vec<f64>,
    width_s: f64,
}

impl Window {
    /// `half_s` is half the width.
    pub(crate) fn new(half_s: f64, period_s: f64) -> Self {
        let half = ((half_s / period_s).round() as i32).max(3);
        let width_s = f64::from(half + 1) * period_s;
        let places: Vec<f64> = (-half..=half).map(|at| f64::from(at) / f64::from(half + 1)).collect();
        let of = |weight: fn(f64) -> f64| places.iter().map(|x| weight(x * x)).collect::<Vec<_>>();
        let mean = of(|square| (1.0 - square).powi(3));
        let flat = of(|square| (1.0 - square).powi(2));
        let mut bend = of(|square| (5.0 * square - 1.0) * (1.0 - square));
        let middle = bend.iter().sum::<f64>() / bend.len() as f64;
        bend.iter_mut().for_each(|it| *it -= middle);
        // A parabola has exactly its own mean, velocity and acceleration.
        let moment = |weights: &[f64], of: fn(f64) -> f64| {
            weights.iter().zip(&places).map(|(weight, x)| weight * of(x * width_s)).sum::<f64>()
        };
        let slope: Vec<f64> = flat.iter().zip(&places).map(|(weight, x)| weight * x).collect();
        let scaled = |weights: Vec<f64>, by: f64| weights.into_iter().map(|it| it / by).collect::<Vec<_>>();
        let [of_mean, of_slope, of_bend] =
            [moment(&mean, |_| 1.0), moment(&slope, |t| t), moment(&bend, |t| 0.5 * t * t)];
        Self {
            mean: scaled(mean, of_mean),
            slope: scaled(slope, of_slope),
            bend: scaled(bend, of_bend),
            width_s,
        }
    }

    fn half(&self) -> usize {
        self.mean.len() / 2
    }

    /// Velocity at which a shaft passes 4 counts within the window.
    fn slow_rad_s(&self, counts_per_rad: f64) -> f64 {
        SLOW_COUNTS / counts_per_rad / (2.0 * self.width_s)
    }

    /// The mean of several quantities around a sample.
    pub(crate) fn mean<const N: usize>(&self, at: usize, of: impl Fn(usize) -> [f64; N]) -> [f64; N] {
        let mut sum = [0.0; N];
        for (place, weight) in self.mean.iter().enumerate() {
            for (sum, it) in sum.iter_mut().zip(of(at + place - self.half())) {
                *sum += weight * it;
            }
        }
        sum
    }
}

/// Values around each sample with these weights; beyond the ends the last value stays.
fn weighted(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let (half, last) = (weights.len() / 2, values.len() - 1);
    let value = |at: usize| values[at.saturating_sub(half).min(last)];
    let sum = |at: usize| weights.iter().enumerate().map(|(place, it)| it * value(at + place)).sum();
    (0..values.len()).map(sum).collect()
}

/// A shaft behind the window.
pub(crate) struct Shaft {
    /// By the counts, in rad from the first sample.
    pub(crate) angle_rad: Vec<f64>,
    pub(crate) velocity_rad_s: Vec<f64>,
    /// Acceleration in rad/s^2, velocity in rad/s, and direction from -1 to 1, each as the window's mean.
    pub(crate) means: Vec<[f64; 3]>,
    /// Whether the shaft moves, and the window and those of its samples are within the motion.
    pub(crate) moves: Vec<bool>,
}

impl Shaft {
    fn new(motion: &Motion, encoder: usize, window: &Window) -> Self {
        let samples = motion.samples();
        let angle_rad: Vec<_> = (0..samples).map(|at| motion.position_rad(encoder, at)).collect();
        let velocity_rad_s = weighted(&angle_rad, &window.slope);
        let slow_rad_s = window.slow_rad_s(motion.counts_per_rad[encoder]);
        let side: Vec<_> = velocity_rad_s.iter().map(|it| (it / slow_rad_s).clamp(-1.0, 1.0)).collect();
        let side = weighted(&side, &window.mean);
        let acceleration = weighted(&angle_rad, &window.bend);
        let velocity = weighted(&velocity_rad_s, &window.mean);
        let means = (0..samples).map(|at| [acceleration[at], velocity[at], side[at]]).collect();
        let edge = 2 * window.half();
        let moves = |at: usize| {
            (edge..samples.saturating_sub(edge)).contains(&at) && velocity_rad_s[at].abs() > slow_rad_s
        };
        let moves = (0..samples).map(moves).collect();
        Self { angle_rad, velocity_rad_s, means, moves }
    }
}

/// A motion behind the window.
pub(crate) struct Smooth<'a> {
    pub(crate) motion: &'a Motion,
    pub(crate) window: Window,
    pub(crate) motor: Shaft,
    pub(crate) load: Shaft,
    /// Torque at the motor in N m, and its rate in N m/s.
    pub(crate) torque: Vec<[f64; 2]>,
    /// The first sample at which the load has moved.
    pub(crate) still: usize,
}

impl<'a> Smooth<'a> {
    /// `half_s` is half the width of the window.
    pub(crate) fn new(motion: &'a Motion, half_s: f64) -> Self {
        let window = Window::new(half_s, motion.period_s);
        let [motor, load] = [0, 1].map(|encoder| Shaft::new(motion, encoder, &window));
        let torque_nm = motion.arriving_nm();
        let rates = weighted(&torque_nm, &window.slope);
        let torque =
            weighted(&torque_nm, &window.mean).into_iter().zip(rates).map(|(it, rate)| [it, rate]).collect();
        let has_moved = |it: &f64| it.abs() > STILL_COUNTS + motion.noise_counts;
        let still = motion.counts[1].iter().position(has_moved).unwrap_or(motion.samples());
        let still = still.saturating_sub(window.half());
        Self { motion, window, motor, load, torque, still }
    }

    /// Cosine and sine of the motor's angle times a count per turn.
    pub(crate) fn waves(&self, at: usize, per_turn: u32) -> [f64; 2] {
        self.window.mean(at, |at| {
            let (sine, cosine) = (f64::from(per_turn) * self.motion.shown_rad(at)).sin_cos();
            [cosine, sine]
        })
    }

    /// The shaft behind a gap, as means of the window: angle by which it is wound, rate of that, side of the contact, share of
    /// the time in contact, and the load's angle there.
    pub(crate) fn contact(&self, at: usize, gap: &Gap) -> [f64; 5] {
        self.window.mean(at, |at| {
            let load_rad = self.load.angle_rad[at];
            let z = self.motor.angle_rad[at] - gap.ratio * load_rad + gap.twist_rad;
            if z.abs() <= gap.half_rad {
                return [0.0; 5];
            }
            let rate = self.motor.velocity_rad_s[at] - gap.ratio * self.load.velocity_rad_s[at];
            [z - gap.half_rad * z.signum(), rate, z.signum(), 1.0, load_rad]
        })
    }
}

/// Where the flanks are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    pub(crate) half_rad: f64,
    /// Twist at the first sample of the motion.
    pub(crate) twist_rad: f64,
    pub(crate) ratio: f64,
}
