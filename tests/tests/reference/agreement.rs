use crate::closed_loop::{Ideal, Timing, run};
use crate::paper;
use crate::recorded::{difference, read};

#[test]
fn explore() {
    let t = std::time::Instant::now();
    let r =
        |law, _s| run::<f64, _, _>(&paper::smooth(4), paper::START, &law, Ideal, |_| 0.0, Timing::RECORDED);
    println!("{:?}", difference(&r(paper::pd(), 0), &read("zoh_smooth_pd"), 10));
    println!("{:?}", t.elapsed());
    println!("{:?}", difference(&r(paper::faithful_nominal(1e-3), 0), &read("zoh_smooth_faithful"), 10));
    let r = |law, _s| {
        run::<f64, _, _>(&paper::hard_coulomb(4), paper::START, &law, Ideal, |_| 0.0, Timing::RECORDED)
    };
    println!("{:?}", difference(&r(paper::pd(), 0), &read("zoh_hardcoul_pd"), 10));
    println!("{:?}", difference(&r(paper::faithful_observed(1e-3), 0), &read("zoh_hardcoul_faithful"), 10));
}
