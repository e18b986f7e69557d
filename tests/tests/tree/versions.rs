//! One version for everything that a release has.

use std::fs;

use crate::metadata::packages;

#[test]
fn public_crates_and_the_python_package_have_one_version() {
    let read = |path: &str| fs::read_to_string(tests::workspace().join(path)).expect("a file of the tree");
    let manifest = read("Cargo.toml");
    let (_, version) = manifest.split_once("[workspace.package]\nversion = \"").expect("a version");
    let (version, _) = version.split_once('"').expect("a string");

    assert!(read("clients/python/pyproject.toml").contains(&format!("\nversion = \"{version}\"\n")));
    let packages = packages().expect("packages");
    let public: Vec<_> = packages.iter().filter(|package| package["publish"].is_null()).collect();
    assert!(public.len() > 20, "{} public crates", public.len());
    for package in public {
        let name = package["name"].as_str().expect("a name");
        assert_eq!(package["version"], version, "{name}");
        for dependency in package["dependencies"].as_array().expect("dependencies") {
            // Without a path: another project's.
            let is_published = dependency["path"].is_string() && dependency["kind"] != "dev";
            let asked = dependency["req"].as_str();
            assert!(
                !is_published || asked == Some(&format!("={version}")),
                "{name} asks for {} {asked:?}: a registry may have other versions",
                dependency["name"],
            );
        }
    }
}
