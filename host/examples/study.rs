//! study SCENARIO SEEDS PLANTS [--dump] [KEY=VALUE...]
use lashloop::campaign::plants::RandomPlant;
use lashloop::{Bench, run};
use std::env;
use std::thread;
#[derive(Default, Clone, Debug)]
struct Row {
    name: String,
    settle: f64,
    over: f64,
    stat: f64,
    lsb: f64,
    hunt: f64,
    var: f64,
    jerr: f64,
    dev: f64,
    effort: f64,
    dens: String,
}
fn main() {
    let mut args: Vec<String> = env::args().skip(1).collect();
    let dump = args.iter().position(|a| a == "--dump").map(|i| args.remove(i)).is_some();
    let (scenario, seeds, count) = (args[0].clone(), args[1].clone(), args[2].parse::<u32>().unwrap());
    let sets: Vec<String> = args[3..].to_vec();
    let cases: Vec<(u64, u32)> =
        seeds.split(',').flat_map(|s| (0..count).map(move |i| (s.parse().unwrap(), i))).collect();
    let next = std::sync::atomic::AtomicUsize::new(0);
    let text = std::fs::read_to_string(&scenario).unwrap();
    let rows: Vec<Row> = thread::scope(|scope| {
        let hs: Vec<_> = (0..2)
            .map(|_| {
                scope.spawn(|| {
                    let bench = Bench::new();
                    let mut out = vec![];
                    loop {
                        let i = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                        let Some(&(seed, index)) = cases.get(i) else { break };
                        let mut settings =
                            if count == 1 { vec![] } else { RandomPlant::draw(seed, index).settings() };
                        settings.push("expect=[]".into());
                        settings.extend(sets.iter().cloned());
                        let refs: Vec<&str> = settings.iter().map(|s| s.as_str()).collect();
                        let sc = bench.scenario_from_str(&text, &refs).unwrap();
                        let counts = settings
                            .iter()
                            .rev()
                            .find_map(|s| s.strip_prefix("encoders.load_counts_per_rev="))
                            .map_or(4000.0, |v| v.parse().unwrap());
                        let o = match run(&sc, &bench.device("inproc").unwrap()) {
                            Ok(o) => o,
                            Err(e) => {
                                eprintln!("{seed}/{index}: {e}");
                                continue;
                            }
                        };
                        let m = |n: &str| o.metric(n).unwrap_or(f64::INFINITY);
                        out.push(Row {
                            name: format!("{seed}/{index}"),
                            settle: m("settle_time_s"),
                            over: m("overshoot_rad") * 1e3,
                            stat: m("static_error_rad").abs() * 1e3,
                            lsb: 6283.185 / counts,
                            hunt: m("hunting_rad") * 1e3,
                            var: m("torque_total_variation_nm"),
                            jerr: m("dead_zone_error_rad").abs() * 1e3,
                            effort: m("effort_nm2s"),
                            dev: o
                                .signal("drive.dead_zone_deviation_rad")
                                .map_or(f64::NAN, |s| *s.last().unwrap() * 1e3),
                            dens: settings.join(" "),
                        });
                    }
                    out
                })
            })
            .collect();
        hs.into_iter().flat_map(|h| h.join().unwrap()).collect()
    });
    let q = |f: &dyn Fn(&Row) -> f64, rows: &[Row]| {
        let mut v: Vec<f64> = rows.iter().map(f).collect();
        v.sort_by(f64::total_cmp);
        let n = v.len();
        if n == 0 {
            return (f64::NAN, f64::NAN, f64::NAN);
        }
        (v[(n - 1) / 2], v[(n * 95).div_ceil(100) - 1], v[n - 1])
    };
    for (name, f) in [
        ("settle", &(|r: &Row| r.settle) as &dyn Fn(&Row) -> f64),
        ("overshoot mrad", &|r| r.over),
        ("static mrad", &|r| r.stat),
        ("hunting", &|r| r.hunt),
        ("variation", &|r| r.var),
        ("effort", &|r| r.effort),
        ("jerr mrad", &|r| r.jerr),
        ("dev mrad", &|r| r.dev),
        ("jerr/dev", &|r| r.jerr / r.dev),
    ] {
        let (a, b, c) = q(f, &rows);
        println!("{name:16} {a:8.3} {b:8.3} {c:8.3}");
    }
    let ok = rows.iter().filter(|r| r.stat <= r.lsb.max(2.0)).count();
    println!("static ok {ok}/{}", rows.len());
    for t in [15.0, 20.0, 25.0, 30.0, 40.0, 60.0, 100.0] {
        let l: Vec<Row> = rows.iter().filter(|r| r.dev <= t).cloned().collect();
        let (a, b, c) = q(&|r| r.jerr, &l);
        println!("dev<={t}: {} of {}: jerr {a:.1} {b:.1} {c:.1}", l.len(), rows.len());
    }
    if dump {
        let mut rows = rows;
        rows.sort_by(|a, b| b.settle.total_cmp(&a.settle));
        for r in rows {
            println!(
                "{} settle {:.3} over {:.2} stat {:.2} lsb {:.2} hunt {:.2} var {:.0} jerr {:.1} dev {:.1} {}",
                r.name, r.settle, r.over, r.stat, r.lsb, r.hunt, r.var, r.jerr, r.dev, r.dens
            );
        }
    }
}
