//! The torque at which the load leaves a rest.

use crate::replay::Motion;

/// Mean torque at which the load leaves a rest, in N m at the motor. `None` if it never does.
pub(crate) fn breakaway_nm(motions: &[Motion]) -> Option<f64> {
    let mut found = Vec::new();
    for motion in motions {
        let rest = ((0.2 / motion.period_s) as usize).max(1);
        let load = &motion.counts[1];
        let mut since = 0;
        for at in 1..load.len() {
            if (load[at] - load[since]).abs() < 2.0 {
                continue;
            }
            if at - since > rest {
                found.push((motion.torque_nm[at - 1] - motion.held_nm).abs());
            }
            since = at;
        }
    }
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied()
}
