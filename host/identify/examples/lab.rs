use lashloop_identify::{Instruments, Series, SeriesError, identify};
use lashloop_plant::backlash_shaft::*;
use lashloop_plant::random::*;
use lashloop_plant::{Mechanics, RunningPlant, Start, Plant, TransportDelay, encoder::Encoder};

struct Hidden { m: Mechanics, s: ShaftParameters, cpr: [u32; 2], sign: [i64; 2], start: Start }

fn draw(seed: u64) -> Hidden {
    let mut r = Pcg64Mcg::seed_from_u64(seed);
    let mut u = |a: f64, b: f64| a + (b - a) * uniform(&mut r);
    let mut m = Mechanics::paper();
    let mut s = ShaftParameters::paper();
    let l = |x: f64| x.exp();
    let w = 0.7;
    m.motor_inertia_kg_m2 *= l(u(-w, w));
    m.motor_friction_nm_s_rad *= l(u(-w, w));
    m.load_inertia_kg_m2 *= l(u(-w, w));
    m.load_friction_nm_s_rad *= l(u(-w, w));
    m.stiffness_nm_rad *= l(u(-w, w));
    m.ratio = u(2.0, 6.0);
    m.dead_zone_rad = 0.5 * u(0.02, 0.5);
    s.shaft_damping_nm_s_rad *= l(u(-w, w));
    s.load.coulomb_nm *= l(u(-w, w));
    s.load.stiction_nm = s.load.coulomb_nm * u(1.0, 1.5);
    s.load.velocity_rad_s *= l(u(-0.35, 0.35));
    s.load_asymmetry = u(-0.2, 0.2);
    s.motor.coulomb_nm *= l(u(-w, w));
    s.motor.stiction_nm = s.motor.coulomb_nm * u(1.0, 1.5);
    s.motor.velocity_rad_s *= l(u(-0.35, 0.35));
    s.current_lag_s *= l(u(-w, w));
    let cpr = [u(2000.0, 10000.0) as u32, u(2000.0, 10000.0) as u32];
    let sign = [u(-1.0, 1.0), u(-1.0, 1.0)].map(|x| if x < 0.0 { -1 } else { 1 });
    let load = u(-1.0, 1.0);
    let z0 = u(-0.9, 0.9) * m.dead_zone_rad;
    Hidden { m, s, cpr, sign, start: Start::at_rest(load, m.ratio * load + z0) }
}

fn make(h: &Hidden, torque: &[f64]) -> Series {
    let mut p = RunningPlant::released(BacklashShaft::new(h.m, h.s, 16).unwrap(), h.start);
    let mut e = h.cpr.map(|c| Encoder::new(c, 0.0, 1).unwrap());
    let mut d = TransportDelay::new(1000, 1000);
    let (mut a, mut b) = (vec![], vec![]);
    for &t in torque {
        let x = p.positions();
        a.push(h.sign[0] * e[0].read(x.motor_position_rad));
        b.push(h.sign[1] * e[1].read(x.load_position_rad) + 77);
        for (nm, s) in d.step(t) { p.step(nm, s).unwrap(); }
    }
    Series::new(1000, torque.to_vec(), a, b).unwrap()
}

use lashloop_identify::excitation::*;
struct Machine<'a>(&'a Hidden);
impl DriveTrain for Machine<'_> {
    type Error = SeriesError;
    fn make(&mut self, m: &PlannedMotion, mut guard: Guard) -> Result<Made, SeriesError> {
        let s = make(self.0, &m.torque_nm);
        let mut halt = None;
        let mut n = 0;
        for k in 0..m.torque_nm.len() { n = k + 1; halt = guard.check(s.motor_counts()[k], s.load_counts()[k]); if halt.is_some() { break; } }
        let series = Series::new(1000, m.torque_nm[..n].to_vec(), s.motor_counts()[..n].to_vec(), s.load_counts()[..n].to_vec())?;
        Ok(Made { series, halt, peaks: guard.peaks() })
    }
}

fn main() {
    let args: Vec<u64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let dbg = std::env::var("DBG9").is_ok();
    let limits = Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 10.0, load_travel_rad: 1.5 };
    let mut stat: std::collections::BTreeMap<String, (u32, u32, u32, Vec<(f64, f64)>)> = Default::default();
    let mut secs = 0.0;
    for seed in args[0]..args[1] {
        let h = draw(seed);
        let ins = Instruments { motor_counts_per_rev: h.cpr[0], load_counts_per_rev: h.cpr[1], torque_delay_us: 1000 };
        let c = match commission(&mut Machine(&h), &ins, &limits, 1000) { Ok(c) => c, Err(e) => { println!("seed {seed}: {e}"); continue } };
        let t = std::time::Instant::now();
        if dbg { let s: Vec<_> = c.records.iter().map(|r| r.1.clone()).collect(); identify(&s, &ins, &lashloop_identify::Start::default()).unwrap(); }
        secs += t.elapsed().as_secs_f64();
        let i = &c.identified;
        let sg = [i.directions.motor, i.directions.load].map(|d| d.map(|d| d.sign()));
        if sg != h.sign.map(Some) { println!("seed {seed}: signs"); }
        let mut line = format!("seed {seed} {} res {:.2} {:.2} n {}: ", c.records[2].0, i.residual_counts[0], i.residual_counts[1], c.records.iter().map(|r| r.1.torque_nm().len()).sum::<usize>());
        let truths = truths(&h);
        for q in &i.quantities {
            let truth = truths.iter().find(|t| t.0 == q.name).unwrap().1;
            let st = stat.entry(q.name.to_string()).or_default();
            st.2 += 1;
            if let Some(e) = q.estimate {
                let inside = e.low <= truth && truth <= e.high;
                st.0 += inside as u32; st.1 += 1;
                let (half, z) = if q.name == "load_friction_asymmetry" { ((e.high - e.low) / 2.0, (e.value - truth) / (e.high - e.low) * 6.0) } else { ((e.high / e.low).ln() / 2.0, (e.value / truth).ln() / (e.high / e.low).ln() * 6.0) };
                st.3.push((half, z));
                if !inside { line += &format!("{} {:.4} z {z:.1}; ", q.name, (e.value / truth).ln()); }
            }
        }
        println!("{line}");
    }
    println!("seconds {secs:.1}");
    for (n, (c, t, a, v)) in &mut stat {
        v.sort_by(|a, b| a.0.total_cmp(&b.0));
        let med = v.get(v.len() / 2).map_or(0.0, |x| x.0);
        let mut z: Vec<f64> = v.iter().map(|x| x.1.abs()).collect(); z.sort_by(f64::total_cmp);
        println!("{n:28} {c}/{t} of {a}, median half width {:.3} %, z95 {:.2}", med * 100.0, z.get(z.len() * 95 / 100).copied().unwrap_or(0.0));
    }
}

fn truths(h: &Hidden) -> Vec<(&'static str, f64)> {
    let (m, s) = (&h.m, &h.s);
    let a = s.load_asymmetry;
    vec![("reduction_ratio", m.ratio), ("gap_width_rad", 2.0 * m.dead_zone_rad), ("dead_zone_rad", m.dead_zone_rad), ("stiffness_nm_rad", m.stiffness_nm_rad),
    ("shaft_damping_nm_s_rad", s.shaft_damping_nm_s_rad), ("motor_inertia_kg_m2", m.motor_inertia_kg_m2), ("motor_friction_nm_s_rad", m.motor_friction_nm_s_rad),
    ("motor_coulomb_nm", s.motor.coulomb_nm), ("motor_stiction_nm", s.motor.stiction_nm), ("motor_stribeck_rad_s", s.motor.velocity_rad_s),
    ("load_inertia_kg_m2", m.load_inertia_kg_m2), ("load_friction_nm_s_rad", m.load_friction_nm_s_rad), ("load_coulomb_nm", s.load.coulomb_nm),
    ("load_coulomb_forward_nm", s.load.coulomb_nm * (1.0 + a)), ("load_coulomb_backward_nm", s.load.coulomb_nm * (1.0 - a)),
    ("load_stiction_nm", s.load.stiction_nm), ("load_stiction_forward_nm", s.load.stiction_nm * (1.0 + a)), ("load_stiction_backward_nm", s.load.stiction_nm * (1.0 - a)),
    ("load_stribeck_rad_s", s.load.velocity_rad_s), ("load_friction_asymmetry", a), ("current_lag_ms", s.current_lag_s * 1e3),
    ("inertia_at_motor_kg_m2", m.motor_inertia_kg_m2 + m.load_inertia_kg_m2 / m.ratio / m.ratio)]
}
