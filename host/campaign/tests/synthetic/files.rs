//! Errors of campaign files: place, key and remedy.

use crate::support::{PARTS, read};

const AXIS: &str = "[[part.axis]]\nkey = \"plant.dead_zone_rad\"\n";

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
        (format!("{PARTS}[[expect]]\nmetric = \"settle\"\nquantile = 0.5\nmax = 1"), "which is no metric"),
        (format!("{PARTS}[[expect]]\nmetric = \"settle_time_s\"\nmax = 1"), "must give metric, quantile and"),
        (format!("{PARTS}[[expect]]\npass = 0.9\npart = \"none\""), "no [[part]] of this name"),
        (format!("{PARTS}[[expect]]\npass = 0.9\njudge = \"interval\""), "add confidence"),
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
