//! Promise of meshes with very many facets: a right result, and a word on what was left out.

use super::scratch;
use glam::DVec3;
use serde_json::Value;
use std::fs;
use std::process::Command;
use weavelock_fab::files::stl;
use weavelock_fab::mesh::Mesh;

/// A ring of 20 mm around z with a section of 8 mm, in `around` x `across` facets of four corners.
fn ring(around: u32, across: u32) -> Mesh {
    let turn = |k: u32, of: u32| (std::f64::consts::TAU * f64::from(k) / f64::from(of)).sin_cos();
    let at = |k: u32| {
        let ((sin, cos), (up, out)) = (turn(k / across, around), turn(k % across, across));
        DVec3::new((20.0 + 8.0 * out) * cos, (20.0 + 8.0 * out) * sin, 8.0 * up)
    };
    let quad = |k: u32| {
        let (i, j) = (k / across, k % across);
        let number = |i: u32, j: u32| (i % around) * across + j % across;
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let count = around * across;
    Mesh { vertices: (0..count).map(at).collect(), triangles: (0..count).flat_map(quad).collect() }
}

fn fabricated(name: &str, mesh: &Mesh) -> Value {
    let dir = scratch(name);
    fs::create_dir_all(&dir).unwrap();
    stl::write(mesh, &mut fs::File::create(dir.join("ring.stl")).unwrap()).unwrap();
    fs::write(
        dir.join("ring.toml"),
        "name = \"ring\"\n[[part]]\nmesh = \"ring.stl\"\n[size]\nunit = \"mm\"\n",
    )
    .unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    let run =
        program.current_dir(&dir).args(["fab", "ring.toml", "--json", "--out", "out"]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    fs::remove_dir_all(dir).unwrap();
    serde_json::from_slice(&run.stdout).unwrap()
}

/// The volume is that of the polygon of the section turned around in chords: off the ring's own by the facets alone.
fn right(answer: &Value, facets: u64) {
    let part = &answer["parts"][0];
    assert_eq!((part["triangles"].as_u64(), part["watertight"].as_bool()), (Some(facets), Some(true)));
    let scale = answer["scale"].as_f64().unwrap();
    let exact = 2.0 * std::f64::consts::PI.powi(2) * 20.0 * 64.0 * scale.powi(3);
    let off = part["volume_mm3"].as_f64().unwrap() / exact - 1.0;
    assert!(off < 0.0 && off > -80.0 / facets as f64, "{off}");
}

#[test]
fn a_ring_of_ten_thousand_facets_is_made() {
    right(&fabricated("ring-10k", &ring(100, 50)), 10_000);
}

#[test]
#[ignore = "a minute: a million facets"]
fn a_ring_of_a_million_facets_is_made() {
    right(&fabricated("ring-1m", &ring(1000, 500)), 1_000_000);
}
