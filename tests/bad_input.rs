//! Promises about files that are wrong, and about those that are right.

use std::path::{Path, PathBuf};
use weavelock::spec::{Layout, Spec, Subject, Syntax, parse, read};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn good(name: &str) -> Spec {
    read(&fixture(name)).unwrap_or_else(|faults| panic!("{faults}"))
}

#[test]
fn print_all() {
    for name in [
        "plain-2x2.toml",
        "plain-2x2.json",
        "twill-tiles.toml",
        "satin-pieces.toml",
        "paper-points.toml",
        "meshes.toml",
    ] {
        println!("{:#?}", good(&format!("specs/{name}")));
    }
}
