//! Holds the crates to `docs/architecture.md`: who may know whom; and the pages to the crates.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use cargo_metadata::{DependencyKind, MetadataCommand, Package};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const ARCHITECTURE: &str = include_str!("../../docs/architecture.md");

/// Crates that read captures or know how wind is measured: the simulator must not reach one of them.
const CAPTURE_SIDE: [&str; 9] = ["c3d", "csv", "trc", "ingest", "head", "fit", "raster", "pipeline", "bench"];

fn packages() -> Vec<Package> {
    let metadata = MetadataCommand::new()
        .manifest_path(concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml"))
        .no_deps()
        .other_options(["--offline".to_owned()])
        .exec()
        .expect("cargo metadata runs in a checkout");
    metadata.packages
}

fn short_name(name: &str) -> &str {
    name.strip_prefix("tousle-").unwrap_or(name)
}

/// What each crate of the workspace depends on among ours, in builds (not in tests).
fn real_dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let packages = packages();
    let ours: BTreeSet<&str> = packages.iter().map(|p| short_name(&p.name)).collect();
    let of = |p: &Package| -> BTreeSet<String> {
        let built = p.dependencies.iter().filter(|d| d.kind != DependencyKind::Development);
        built
            .map(|d| short_name(&d.name).to_owned())
            .filter(|n| ours.contains(n.as_str()) && n != short_name(&p.name))
            .collect()
    };
    packages.iter().map(|p| (short_name(&p.name).to_owned(), of(p))).collect()
}

/// The last table of the page: crate, job, dependencies. `None` for a crate that may depend on any.
fn documented_dependencies() -> BTreeMap<String, Option<BTreeSet<String>>> {
    let table = ARCHITECTURE.split("## The crates").nth(1).expect("the page has a section for the crates");
    let rows = table.lines().filter(|line| line.starts_with("| `"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let name = cells[0].trim_matches('`').to_owned();
        let allowed = match cells[2] {
            "any" => None,
            "–" => Some(BTreeSet::new()),
            list => Some(list.split(", ").map(str::to_owned).collect()),
        };
        (name, allowed)
    };
    rows.map(row).collect()
}

#[test]
fn every_crate_is_on_the_page_and_no_other() {
    let real: Vec<String> = real_dependencies().into_keys().collect();
    let documented: Vec<String> = documented_dependencies().into_keys().collect();
    assert_eq!(real, documented, "crates in the workspace (left) and in docs/architecture.md (right)");
}

#[test]
fn no_crate_knows_more_than_the_page_says() {
    let documented = documented_dependencies();
    for (name, real) in real_dependencies() {
        if let Some(Some(allowed)) = documented.get(&name) {
            let forbidden: Vec<_> = real.difference(allowed).collect();
            assert!(
                forbidden.is_empty(),
                "tousle-{name} depends on {forbidden:?}, which docs/architecture.md does not allow"
            );
        }
    }
}

#[test]
fn the_simulator_cannot_reach_a_capture() {
    let dependencies = real_dependencies();
    let mut reached: BTreeSet<&str> = BTreeSet::new();
    let mut open = vec!["sim"];
    while let Some(name) = open.pop() {
        if reached.insert(name) {
            open.extend(dependencies[name].iter().map(String::as_str));
        }
    }
    for name in CAPTURE_SIDE {
        assert!(!reached.contains(name), "tousle-sim reaches tousle-{name}");
    }
}

#[test]
fn the_code_that_pages_name_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let docs = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = docs.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    for page in pages.chain([root.join("README.md")]) {
        let text = std::fs::read_to_string(&page).unwrap();
        let named = text.split('`').skip(1).step_by(2).filter(|word| word.starts_with("crates/"));
        for path in named {
            assert!(root.join(path).exists(), "{} names {path}", page.display());
        }
    }
}
