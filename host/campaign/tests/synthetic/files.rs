//! Errors of campaign files: place, key and remedy.

use crate::support::{PARTS, TWO_VARIANTS, read};

const AXIS: &str = "[[part.axis]]\nkey = \"plant.dead_zone_rad\"\n";

const COUNTS: &str = "[[part.axis]]\nkey = \"encoders.load_counts_per_rev\"\n";

#[test]
fn wrong_campaign_files_are_refused_with_the_remedy() {
    let part = |rest: &str| format!("[[part]]\nname = \"p\"\n{rest}");
    for (text, expected) in [
        (String::new(), "has no part; add [[part]]"),
        (part("[[part.axis]]\nvalues = [1]"), "must give either key, or keys"),
        (part(&format!("{AXIS}min = 1\nmax = 2")), "has a range without points; add points"),
        (part(&format!("{AXIS}min = 2\nmax = 1\npoints = 3")), "must be > 2"),
        (part(&format!("method = \"random\"\n{AXIS}values = [1]")), "samples without points"),
        (part(&format!("{AXIS}values = [1]\nvalue = 2")), "c.toml:10: part.0.axis.0.value"),
        (part(&format!("{AXIS}values = [1]\n{AXIS}values = [2]")), "in two axes"),
        (part("[[part.axis]]\nkey = \"plant.gap\"\nvalues = [1]"), "plant.gap"),
        (part(&format!("{AXIS}values = [1]\ntimes = \"plant.none\"")), "no number of this key"),
        (
            format!(
                "{PARTS}{}",
                part(&format!("method = \"sobol\"\npoints = 10000000\n{AXIS}min = 1\nmax = 2"))
            ),
            "at most 10000000 are allowed",
        ),
        (
            format!("{PARTS}[[expect]]\nmetric = \"settle\"\nquantile = 0.5\nmax = 1"),
            "which is neither a metric",
        ),
        (format!("{PARTS}[[expect]]\nmetric = \"settle_time_s\"\nmax = 1"), "must give metric, quantile and"),
        (format!("{PARTS}[[expect]]\npass = 0.9\npart = \"none\""), "no [[part]] of this name"),
        (format!("{PARTS}[[expect]]\npass = 0.9\njudge = \"interval\""), "add confidence"),
        (
            format!("{PARTS}[[expect]]\npass = 1\nconfidence = 0.9\njudge = \"interval\""),
            "take quantile or pass < 1",
        ),
        (
            format!("{TWO_VARIANTS}{PARTS}[[expect]]\npass = 0.9\npart = \"random\"\nconfidence = 0.9"),
            "pools variants on the same points; add variant",
        ),
        (format!("{PARTS}[[expect]]\npass = 0.9\nconfidence = 0.9"), "covers a grid or a list"),
        (
            format!(
                "{}{}[[expect]]\npass = 0.9\nconfidence = 0.9",
                part(&format!("method = \"random\"\npoints = 2\n{AXIS}min = 0.1\nmax = 0.2\n")),
                part(&format!("method = \"sobol\"\npoints = 2\n{AXIS}min = 0.1\nmax = 0.2\n"))
                    .replace("\"p\"", "\"q\""),
            ),
            "pools parts",
        ),
        (
            part(&format!("{AXIS}values = [0.2, 0.1, 0.20]")),
            "a grid that has a value of plant.dead_zone_rad twice",
        ),
        (
            part(&format!("{COUNTS}min = 2000\nmax = 2003\nscale = \"whole\"\npoints = 5")),
            "a grid that has a value of encoders.load_counts_per_rev twice",
        ),
        (
            part(&format!("{AXIS}values = [0.2, 0.1, 0.3]\n{COUNTS}values = [2000, 4000]")),
            "values of plant.dead_zone_rad neither rise nor fall; sort them",
        ),
        (
            part(&format!(
                "method = \"list\"\n{AXIS}values = [0.2, 0.1, 0.2]\n{COUNTS}values = [2000, 2000, 2000]"
            )),
            "a list whose row 2 repeats an earlier one",
        ),
        // Neither of the ends: 4666.67.
        (
            part(&format!("{COUNTS}min = 2000\nmax = 10000\npoints = 4")),
            "axis encoders.load_counts_per_rev at 4666.66",
        ),
        (
            part(&format!("method = \"list\"\n{COUNTS}min = 2000\nmax = 10000\npoints = 4")),
            "c.toml: part p, variant default, case 1: ",
        ),
        (
            part(&format!("{AXIS}values = [0.2, nan]")),
            "part.0.axis.0.values: [2 items] has a number that is not finite",
        ),
        // The second value, and the end of a range at which a multiplier is largest.
        (
            part(&format!("{AXIS}values = [0.2, -5]")),
            "c.toml: part p, variant default, axis plant.dead_zone_rad at -5: ",
        ),
        (
            part(
                "method = \"random\"\npoints = 1\n[[part.axis]]\nkey = \"plant.load_inertia_kg_m2\"\nmin = 1\nmax = 4\n\
                 [[part.axis]]\nkey = \"plant.stiffness_nm_rad\"\nmin = 1\nmax = 4e5\ntimes = \"plant.load_inertia_kg_m2\"",
            ),
            "axis plant.stiffness_nm_rad at 1600000",
        ),
        (
            part(
                "[[part.axis]]\nkey = \"controller.name\"\nvalues = [\"pd\"]\n\
                 [[part.axis]]\nkey = \"plant.dead_zone_rad\"\nvalues = [0.1]\ntimes = \"controller.name\"",
            ),
            "whose axis has other values than numbers",
        ),
        (
            format!("{PARTS}[[derive]]\nname = \"case\"\nmetric = \"settle_time_s\""),
            "has two columns of the name case",
        ),
        (
            part(&format!("method = \"random\"\npoints = 1\n{AXIS}min = 1.5\nmax = 3\nscale = \"whole\"")),
            "needs whole ends, and the range is 1.5 to 3",
        ),
        (format!("{PARTS}[evidence]\nworst = 3"), "evidence.worst without evidence.of"),
    ] {
        let error = read(&text).expect_err(expected).to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}
