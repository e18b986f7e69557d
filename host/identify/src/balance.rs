//! The load by the balance of its torques: what the shaft transmits accelerates it and overcomes its friction.

use crate::free_body::FreeBody;
use crate::least_squares::LeastSquares;
use crate::parameters::{Parameter, Vector};
use crate::replay::Motion;
use crate::window::Smooth;

/// Half the window in s. The load is slower than the motor, and its encoder shows less of an acceleration.
const HALF_S: f64 = 0.04;
/// Every so many samples make a row.
const SPARSE: usize = 2;
/// Widest asymmetry of the friction that is taken over.
const ASYMMETRY_MAX: f64 = 0.7;

/// Inertia, viscous and Coulomb friction of the load. What the motions don't show stays as it is.
pub(crate) fn balance(motions: &[Motion], body: &FreeBody, vector: &mut Vector) {
    let mut sums = LeastSquares::new(4);
    for (index, motion) in motions.iter().enumerate() {
        let smooth = Smooth::new(motion, HALF_S);
        let gap = body.gap(index);
        for at in (0..motion.samples()).step_by(SPARSE).filter(|&at| smooth.load.moves[at]) {
            let [acceleration, velocity, side] = smooth.load.means[at];
            // All at the motor. A forward friction of F (1 + a) and a backward one of F (1 - a) are F sgn v + F a.
            let row = [gap.ratio * acceleration, gap.ratio * velocity, side, 1.0];
            sums.add(&row, body.shaft_nm(&smooth, at, &gap), 1.0);
        }
    }
    let Some((solution, _)) = sums.solve() else { return };
    let of_load = [Parameter::LoadInertia, Parameter::LoadViscous, Parameter::LoadCoulomb];
    for (parameter, &value) in of_load.into_iter().zip(solution.iter()) {
        if value > 0.0 {
            vector.set(parameter, value.ln());
        }
    }
    let asymmetry = solution[3] / solution[2];
    if asymmetry.abs() < ASYMMETRY_MAX {
        vector.set(Parameter::LoadAsymmetry, asymmetry);
    }
}
