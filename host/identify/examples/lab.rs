use lashloop_identify::*;
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

fn ramp(points: &[(f64, f64)]) -> Vec<f64> {
    // (duration s, torque at end)
    let mut out = vec![]; let mut last = 0.0;
    for &(d, t) in points { let n = (d * 1000.0).round() as usize; for k in 0..n { out.push(last + (t - last) * (k + 1) as f64 / n as f64); } last = t; }
    out
}
fn steps(points: &[(f64, f64)]) -> Vec<f64> {
    points.iter().flat_map(|&(d, t)| std::iter::repeat_n(t, (d * 1000.0).round() as usize)).collect()
}

fn main() {
    let args: Vec<u64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let mut covered = vec![(0, 0, Vec::new()); 17];
    let dbg = std::env::var("DBG").is_ok();
    for seed in args[0]..args[1] {
        let h = draw(seed);
        // breakaway by ramp
        let mut ub = 0.0;
        let r: Vec<f64> = (0..4000).map(|k| 20.0 * 10f64.powf(-3.0 + 3.0 * k as f64 / 4000.0)).collect();
        let s = make(&h, &r);
        for k in 0..4000 { if (s.load_counts()[k] - s.load_counts()[0]).abs() >= 6 { ub = r[k]; break; } }
        let rev = make(&h, &ramp(&[(0.35, 0.7 * ub), (0.7, -0.7 * ub), (0.9, 1.1 * ub), (1.1, -1.2 * ub), (0.6, 0.0)]));
        let st = make(&h, &steps(&[(0.02, 0.0), (0.3, 0.5 * ub), (0.3, -0.5 * ub), (0.3, 0.5 * ub), (0.3, 0.0)]));
        let p = 4.0 * ub;
        let pu = make(&h, &steps(&[(0.02, 0.0), (0.15, 0.3*ub), (0.15, -0.3*ub), (0.3, p), (0.4, 0.3*ub), (0.3, -p), (0.4, -0.3*ub), (0.3, -p), (0.4, -0.3*ub), (0.3, p), (0.4, 0.3*ub), (0.1, 0.0)]));
        let series = [rev, st, pu];
        let trav = |s: &Series, e: usize| { let c = if e == 0 { s.motor_counts() } else { s.load_counts() }; (c.iter().max().unwrap() - c.iter().min().unwrap()) as f64 / h.cpr[e] as f64 * 6.283 };
        let ins = Instruments { motor_counts_per_rev: h.cpr[0], load_counts_per_rev: h.cpr[1], torque_delay_us: 1000 };
        let truth = truth_of(&h.m, &h.s);
        if dbg { eprintln!("seed {seed} ub {ub:.2} travel load {:.2} {:.2} {:.2}", trav(&series[0], 1), trav(&series[1], 1), trav(&series[2], 1)); }
        let d = directions(&series); if d.motor.map(|x| x.sign()) != Some(h.sign[0]) || d.load.map(|x| x.sign()) != Some(h.sign[1]) { println!("signs {:?} {d:?}", h.sign); }
        let Some(out) = try_it(&series, &ins) else { println!("seed {seed}: none"); continue };
        let mut line = format!("seed {seed} res {:.2} {:.2}: ", out[0].1, out[0].2);
        for (k, (name, v, sd)) in out[1..].iter().enumerate() {
            let z = (v - truth[k]) / sd;
            if *sd < 0.35 { covered[k].0 += (z.abs() < 1.96) as u32; covered[k].1 += 1; covered[k].2.push((*sd, z)); }
            if z.abs() > 1.96 { line += &format!("{name} {:.3} sd {:.4} z {z:.1}; ", v - truth[k], sd); }
        }
        println!("{line}");
        if dbg { for (k, (name, v, sd)) in out[1..].iter().enumerate() { eprintln!("     {name:14} {:.4} true {:.4} sd {sd:.4}", v, truth[k]); } }
    }
    let names = ["Jm","fm","Fcm","rm","vm","Js","fs","Fc","rl","vl","a","N0","K","j0","c","Ti"];
    for (k, n) in names.iter().enumerate() {
        let (c, t, v) = &mut covered[k];
        v.sort_by(|a, b| a.0.total_cmp(&b.0));
        let med = v.get(v.len() / 2).map_or(0.0, |x| x.0);
        let rms = (v.iter().map(|x| x.1 * x.1).sum::<f64>() / v.len().max(1) as f64).sqrt();
        println!("{n:4} covered {c}/{t} median sd {med:.4} rms z {rms:.2}");
    }
}
