use lashloop_identify::coverage::HiddenPlant;
fn main() {
    let seed: u64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let p = HiddenPlant::draw(seed);
    for k in [
        "motor_inertia_kg_m2",
        "motor_friction_nm_s_rad",
        "load_inertia_kg_m2",
        "load_friction_nm_s_rad",
        "stiffness_nm_rad",
        "dead_zone_rad",
        "reduction_ratio",
        "shaft_damping_nm_s_rad",
        "load_coulomb_nm",
        "load_stiction_nm",
        "load_stribeck_rad_s",
        "load_friction_asymmetry",
        "motor_coulomb_nm",
        "motor_stiction_nm",
        "motor_stribeck_rad_s",
        "current_lag_ms",
    ] {
        println!("--set plant.{k}={:?}", p.truth(k));
    }
    println!(
        "--set plant.initial.load_position_rad={:?} --set plant.initial.motor_position_rad={:?}",
        p.start.load_position_rad, p.start.motor_position_rad
    );
    println!(
        "--set encoders.motor_counts_per_rev={} --set encoders.load_counts_per_rev={}",
        p.counts_per_rev[0], p.counts_per_rev[1]
    );
    for (n, s) in ["motor", "load"].iter().zip(p.signs) {
        if s < 0 {
            println!("--set bench.{n}_direction=reverse");
        }
    }
}
