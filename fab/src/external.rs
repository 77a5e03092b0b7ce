//! Takes written parts; asks the programs of others about each, and about each pair that comes near.

use crate::check::openscad::{OpenScad, Pair};
use crate::check::{Check, Outcome, Programs, admesh, check, slicer};
use crate::make::Piece;
use crate::report::{PairCheck, PartReport, Report};
use glam::DVec3;
use rayon::prelude::*;
use std::path::Path;

type Scad<'a> = Result<&'a OpenScad, Outcome>;

pub(crate) fn check_all(report: &mut Report, pieces: &[Piece], programs: &Programs) {
    let scratch = std::env::temp_dir();
    let openscad = OpenScad::new(&programs.openscad, &scratch);
    let scad: Scad =
        openscad.as_ref().map_err(|e| Outcome::NotRun(format!("no room in {}: {e}", scratch.display())));
    let names = (slicer::name(&programs.slicer), admesh::name(&programs.admesh));
    let of_part = |(part, piece): (&PartReport, &Piece)| -> Vec<Check> {
        let Some(file) = part.file.as_ref().map(Path::new) else { return vec![] };
        vec![
            volume(&scad, programs, file, part, high(piece)),
            slicer::bodies(&programs.slicer, &names.0, file, part.read_back.shells()),
            admesh::part(&programs.admesh, &names.1, file),
        ]
    };
    let checks: Vec<Vec<Check>> = report.parts.par_iter().zip(pieces).map(of_part).collect();
    report.pair_checks =
        pairs(report, &scad, programs, pieces.iter().map(high).fold(DVec3::ZERO, DVec3::max));
    report.parts.iter_mut().zip(checks).for_each(|(part, checks)| part.checks = checks);
}

fn high(piece: &Piece) -> DVec3 {
    piece.made.as_ref().map_or(DVec3::ZERO, |_| piece.master.bounds().1)
}

fn volume(scad: &Scad, programs: &Programs, file: &Path, part: &PartReport, high: DVec3) -> Check {
    match scad {
        Ok(scad) => scad.volume(file, part.expected_volume_mm3, high),
        Err(why) => check(&programs.openscad, "volume", Err(why.clone())),
    }
}

/// Every pair whose gap was measured and of which both parts are written; at finished size where their scales differ.
fn pairs(report: &Report, scad: &Scad, programs: &Programs, high: DVec3) -> Vec<PairCheck> {
    let part = |id: &str| report.parts.iter().find(|p| p.id == id).filter(|p| p.file.is_some());
    let wanted: Vec<_> =
        report.gaps.iter().filter_map(|g| Some((g, pair(part(&g.a)?, part(&g.b)?)?))).collect();
    let asked: Vec<Pair> = wanted.iter().map(|w| w.1).collect();
    let checks = match scad {
        Ok(scad) => scad.apart(&asked, report.datum, high),
        Err(why) => {
            asked.iter().map(|_| check(&programs.openscad, "shares no volume", Err(why.clone()))).collect()
        }
    };
    wanted
        .iter()
        .zip(checks)
        .map(|((g, _), check)| PairCheck { a: g.a.clone(), b: g.b.clone(), check })
        .collect()
}

fn pair<'a>(a: &'a PartReport, b: &'a PartReport) -> Option<Pair<'a>> {
    let files = [Path::new(a.file.as_ref()?), Path::new(b.file.as_ref()?)];
    // Where both are scaled alike, whether they share volume does not depend on it.
    let factors = if a.scale == b.scale { [1.0; 2] } else { [1.0 / a.scale, 1.0 / b.scale] };
    Some(Pair { files, factors })
}
