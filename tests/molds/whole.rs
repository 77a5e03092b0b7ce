//! Promises at the command line: the direct mold of a woven tile, and a run that makes the whole package with its molds.

use super::{find, scratch};
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

/// One weft tile of a weave of period `n`, alone.
pub fn lone_spec(abc: &str, n: usize, process: &str) -> String {
    let profile = "[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n";
    let piece = format!("[[piece]]\nweft = 0\nfrom = 0\nto = {n}\n");
    let made = format!("[size]\npitch = \"20 mm\"\n[fab]\nprocess = \"{process}\"\n");
    format!("name = \"lone\"\n[weave]\nabc = [{abc}]\n{profile}{piece}{made}")
}

fn ran(name: &str, spec: &str, args: &[&str]) -> (Output, PathBuf) {
    let dir = scratch(name);
    std::fs::create_dir_all(&dir).unwrap();
    std::fs::write(dir.join("lone.toml"), spec).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    (program.current_dir(&dir).args(args).output().unwrap(), dir)
}

/// The hollow among the other cells is the tile as it touches: its volume is that of the exact solid, at the scale of the
/// process, and the cells share nothing with it.
#[test]
fn the_cells_of_the_weave_form_the_cavity_of_a_tile_and_of_a_gang() {
    for (abc, n, gang) in [("1, 1, 1", 2, 1), ("1, 1, 1", 2, 2)] {
        let spec = lone_spec(abc, n, "silicone-platinum");
        let args = ["fab", "lone.toml", "--direct", "--gang", &gang.to_string(), "--json", "--out", "out"];
        let (out, dir) = ran(&format!("direct-{n}-{gang}"), &spec, &args);
        let answer: Value = serde_json::from_slice(&out.stdout).unwrap();
        let errors = answer["findings"].as_array().unwrap().iter().filter(|f| f["severity"] == "error");
        assert_eq!(errors.collect::<Vec<_>>(), Vec::<&Value>::new());
        assert_eq!(answer["molds"].as_array().map(Vec::len), Some(2), "{}", answer["molds"]);
        let sheet = &answer["mold_sheets"][0];
        let listed = |list: &str, of: &str| -> Value {
            let all = sheet[list].as_array().unwrap();
            all.iter().find(|v| v["of"].as_str().is_some_and(|o| o.starts_with(of))).unwrap().clone()
        };
        assert_eq!(listed("measured", "what the cells around")["kept"], true);
        let cavity = listed("volumes", "cavity")["mm3"].as_f64().unwrap();
        // Nothing touches the tile, so that its part has no clearance: it is the nominal solid.
        let part = answer["parts"][0]["volume_mm3"].as_f64().unwrap();
        assert!((cavity / (f64::from(gang) * part) - 1.0).abs() < 1e-4, "{cavity} against {gang} x {part}");
        std::fs::remove_dir_all(dir).unwrap();
    }
}

#[test]
#[ignore = "half a minute: every question of a run"]
fn a_run_makes_the_package_with_its_molds() {
    let spec = lone_spec("1, 1, 1", 2, "silicone-platinum");
    let (out, dir) = ran("run", &spec, &["run", "lone.toml", "--out", "out"]);
    let said = String::from_utf8_lossy(&out.stderr);
    for file in ["weft-0-mold.lower.mm.stl", "weft-0-mold.upper.mm.stl", "weft-0-mold.scad", "ledger.md"] {
        assert!(find(&dir.join("out"), file).is_some(), "{file} is not there: {said}");
    }
    std::fs::remove_dir_all(dir).unwrap();
}
