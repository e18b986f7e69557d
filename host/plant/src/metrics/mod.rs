//! The metrics of a run.
//!
//! With the error e = load position - reference, sampled once per control period:
//!
//! | metric | unit | meaning |
//! |---|---|---|
//! | `settle_time_s` | s | first sample time after the last sample with abs(e) > 0.05 rad |
//! | `settle_time_5pct_s` | s | the same with a band of 5 % of the initial abs(e) |
//! | `settle_time_2pct_s` | s | the same with a band of 2 % |
//! | `settle_time_1pct_s` | s | the same with a band of 1 % |
//! | `static_error_rad` | rad | mean of e over the last second |
//! | `hunting_rad` | rad | peak to peak of e over the last 10 s |
//! | `overshoot_rad` | rad | largest abs(e) on the far side of the reference, seen from the initial error; 0 if none |
//! | `lost_motion_rad` | rad | distance between the load's positions at the reference's last upward and last downward passage through its middle |
//! | `effort_nm2s` | N^2 m^2 s | integral of the squared torque, which is held over each period |
//! | `torque_total_variation_nm` | N m | sum of abs(U_k - U_(k-1)) |
//! | `dead_zone_estimate_rad` | rad | the drive's last estimate of j0 |
//! | `dead_zone_error_rad` | rad | the drive's last estimate less the true j0 at that time |
//!
//! The drive's estimates are scored sample by sample. Telemetry comes every n-th step; each estimate is compared with the
//! truth of its own sample, and steps without telemetry contribute nothing:
//!
//! | metric | unit | meaning |
//! |---|---|---|
//! | `dead_zone_settle_time_s` | s | time of the first estimate after the last one more than 0.02 rad from the true j0 |
//! | `dead_zone_bias_rad` | rad | mean of estimate less true j0 over the last 5 s |
//! | `dead_zone_largest_error_rad` | rad | largest abs(estimate - j0) since the first estimate within 0.02 rad, settled or not |
//! | `disturbing_torque_rms_error_nm` | N m | root of the mean square of w_hat - w over the run, with the plant's own w = C - K z |
//! | `disturbing_torque_bias_nm` | N m | mean of w_hat - w over the run |
//!
//! A law without an estimator is scored like any other: it reports its initial amplitude and w_hat = 0, so its root mean
//! square is that of w, which an estimator has to beat. On the paper's smooth plant the gap is four times as wide as j0; a
//! law that identifies the actual gap is far from j0 there.
//!
//! A metric without a value has a reason ([`Measured`]). One position, reference or torque that isn't finite takes the
//! value from every metric of the run, and so does a plant that could not be integrated to the end. So a run that diverged
//! can't score well by its beginning, or by a comparison that drops NaN. An estimate that isn't finite takes the value
//! from the scores of that estimate only.

mod estimator_score;
mod lost_motion;
mod measurement;
mod metric;
mod sample;
mod settling;

pub use self::measurement::Measurement;
pub use self::metric::{Measured, Metric, Metrics};
pub use self::sample::{Estimates, Sample};
