//! Runs whose steps are not timed.

use lashloop::{Bench, Execution};
use lashloop_bench::run::{Clock, Outcome};
use lashloop_bench::supervisor::Supervisor;

fn run(device: &str, clock: Clock, settings: &[&str]) -> Outcome {
    let bench = Bench::new();
    let settings = [&["run.duration_s=0.3", "expect=[]"], settings].concat();
    let scenario = bench.scenario("../scenarios/smooth-after.toml", &settings).expect("a scenario");
    let device = bench.device(device).expect("a device");
    let supervisor = Supervisor::without_signals(None).expect("a thread");
    Execution::new(scenario, (&device).into()).clock(clock).run(&supervisor).expect("a run").outcome
}

#[test]
fn an_untimed_run_has_torques_and_counts_of_lockstep_and_no_times() {
    // 120 s of waiting in the link's time; a run may wait for 40 s of the wall clock.
    let slow = "fault=[{kind=\"link-delay\", at_s=0.0, for_s=0.3, delay_ms=200.0}]";
    for settings in [&[][..], &["link.modelled_baud=921600"], &[slow]] {
        let [timed, untimed] = [Clock::Lockstep, Clock::Untimed].map(|clock| run("inproc", clock, settings));
        assert_eq!(untimed.torque_sha256, timed.torque_sha256, "{settings:?}");
        assert_eq!(untimed.link, timed.link, "{settings:?}");
        assert_eq!((untimed.timing.steps, untimed.timing.clock), (300, timed.timing.clock));
        assert!(timed.timing.round_trip_us.is_some() && untimed.timing.round_trip_us.is_none());
        assert!(timed.wall_s > 0.0);
    }
}
