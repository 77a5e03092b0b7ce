//! Takes a name; gives the process, material or bed of that name, from the files that the program carries.
//!
//! Not promised: that a bed's or a material's figure holds for the one at hand; the files are there to be copied.

use super::{Bed, Figure, Process, ProcessError, read};
use std::path::Path;

const EMBEDDED: [(&str, &str); 11] = [
    ("fdm-pla", include_str!("../../processes/fdm-pla.toml")),
    ("fdm-petg", include_str!("../../processes/fdm-petg.toml")),
    ("fdm-abs", include_str!("../../processes/fdm-abs.toml")),
    ("sla", include_str!("../../processes/sla.toml")),
    ("silicone-platinum", include_str!("../../processes/silicone-platinum.toml")),
    ("silicone-tin", include_str!("../../processes/silicone-tin.toml")),
    ("wax-injected", include_str!("../../processes/wax-injected.toml")),
    ("wax-poured", include_str!("../../processes/wax-poured.toml")),
    ("aluminium-lost-wax", include_str!("../../processes/aluminium-lost-wax.toml")),
    ("aluminium-lost-pla", include_str!("../../processes/aluminium-lost-pla.toml")),
    ("pu-resin", include_str!("../../processes/pu-resin.toml")),
];

const MATERIALS: &str = include_str!("../../processes/materials.toml");
const MELTS: &str = include_str!("../../processes/melts.toml");
const BEDS: &str = include_str!("../../processes/beds.toml");

/// Sides that a bed may have, mm: from a microscope's stage to a gantry.
const BED_SIDES: std::ops::RangeInclusive<f64> = 10.0..=10_000.0;

/// Names of the processes that come with the program.
pub fn names() -> impl Iterator<Item = &'static str> {
    EMBEDDED.iter().map(|(name, _)| *name)
}

/// The text of a process file that comes with the program: what a user copies and edits.
pub fn source(name: &str) -> Option<&'static str> {
    EMBEDDED.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
}

pub(super) fn find(which: &str) -> Result<Process, ProcessError> {
    if let Some(text) = source(which) {
        return Process::parse(&format!("{which}.toml"), text);
    }
    if !which.ends_with(".toml") {
        let known = names().collect::<Vec<_>>().join(", ");
        return Err(ProcessError::Unknown { name: which.to_string(), known });
    }
    let path = Path::new(which);
    let unreadable = |cause| ProcessError::Unreadable { path: path.to_path_buf(), cause };
    Process::parse(which, &std::fs::read_to_string(path).map_err(unreadable)?)
}

/// Materials of cavities with what each bears, C.
pub(super) fn materials() -> Vec<(String, Figure)> {
    read::list(MATERIALS, "material", |m| (m.text("name"), read::bears(m)))
}

/// From what heat on a material is liquid, C, by the first word of the list that its name holds; `None` of what is not known.
pub(super) fn liquid(material: &str) -> Option<Figure> {
    let all = read::list(MELTS, "melt", |m| (m.text("word"), read::figure(m, "liquid", super::sense::HEAT)));
    let name = material.to_lowercase();
    all.into_iter().find(|(word, _)| name.contains(word.as_str())).map(|(_, liquid)| liquid)
}

/// The beds that come with the program.
pub fn beds() -> Vec<Bed> {
    let side = |c: &mut crate::toml_faults::Cursor, key| {
        c.number_in(key, *BED_SIDES.start(), *BED_SIDES.end(), "mm")
    };
    read::list(BEDS, "bed", |b| Bed {
        name: b.text("name"),
        size: [side(b, "x"), side(b, "y"), side(b, "z")],
    })
}

/// A bed by its name or by its size, as in `250 x 210 x 220 mm`; what is wrong otherwise.
pub fn bed(which: &str) -> Result<Bed, String> {
    let all = beds();
    if let Some(bed) = all.iter().find(|b| b.name == which.trim()) {
        return Ok(bed.clone());
    }
    let bare = which.trim().trim_end_matches("mm");
    let sides: Vec<f64> = bare.split(['x', 'X', '\u{d7}']).filter_map(|s| s.trim().parse().ok()).collect();
    match sides[..] {
        [x, y, z]
            if bare.split(['x', 'X', '\u{d7}']).count() == 3
                && sides.iter().all(|s| BED_SIDES.contains(s)) =>
        {
            Ok(Bed { name: format!("{x} x {y} x {z} mm"), size: [x, y, z] })
        }
        _ => {
            let known = all.iter().map(|b| b.name.as_str()).collect::<Vec<_>>().join(", ");
            Err(format!("no bed {which:?}: known are {known}; or a size as \"250 x 210 x 220 mm\""))
        }
    }
}
