//! Takes written parts; asks the programs of others about each, and about each pair of neighbours.

use crate::check::openscad::OpenScad;
use crate::check::{Check, Outcome, Programs, admesh, check, slicer};
use crate::make::Piece;
use crate::report::{PairCheck, Report};
use glam::DVec3;
use rayon::prelude::*;
use std::path::Path;

pub(crate) fn check_all(report: &mut Report, pieces: &[Piece], programs: &Programs, folder: &Path) {
    let openscad =
        OpenScad::new(&programs.openscad, folder).map_err(|e| format!("no room for its files: {e}"));
    let names = (slicer::name(&programs.slicer), admesh::name(&programs.admesh));
    let high = |p: usize| pieces[p].made.as_ref().map_or(DVec3::ZERO, |m| m.mesh.bounds().1);
    let of_part = |(p, part): (usize, &crate::report::PartReport)| -> Vec<Check> {
        let Some(file) = part.file.as_ref().map(Path::new) else { return vec![] };
        vec![
            match &openscad {
                Ok(scad) => scad.volume(file, part.expected_volume_mm3, high(p)),
                Err(why) => check(&programs.openscad, "volume", Err(Outcome::NotRun(why.clone()))),
            },
            slicer::part(&programs.slicer, &names.0, file),
            admesh::part(&programs.admesh, &names.1, file),
        ]
    };
    let checks: Vec<Vec<Check>> = report.parts.par_iter().enumerate().map(of_part).collect();
    let find = |id: &str| report.parts.iter().position(|p| p.id == id);
    let of_pair = |gap: &crate::gap::Gap| {
        let (a, b) = (find(&gap.a)?, find(&gap.b)?);
        let (fa, fb) = (report.parts[a].file.as_ref()?, report.parts[b].file.as_ref()?);
        let check = match &openscad {
            Ok(scad) => scad.apart(Path::new(fa), Path::new(fb), high(a).max(high(b))),
            Err(why) => check(&programs.openscad, "shares no volume", Err(Outcome::NotRun(why.clone()))),
        };
        Some(PairCheck { a: gap.a.clone(), b: gap.b.clone(), check })
    };
    report.pair_checks = report.gaps.par_iter().filter_map(of_pair).collect();
    report.parts.iter_mut().zip(checks).for_each(|(part, checks)| part.checks = checks);
}
