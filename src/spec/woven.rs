//! Takes the tables of a woven assembly; gives its weave, profile, layout and size, with their bounds enforced.
//!
//! Not promised: that ids in `held` of a swatch exist.

use super::pieces::{held_list, held_pieces, pieces};
use super::points::points;
use super::read::home;
use super::reader::{Field, Fields, Reader};
use super::{Bounds, Cut, HeldSpec, Layout, ProfileSpec, Shape, WovenSpec};
use crate::fault::Faults;
use crate::input;
use crate::weave::{self, Draft, Origin, Weave};
use std::ops::Bound::{self, Excluded, Included};
use std::path::Path;

/// Sites that an assembly may have. Each needs about 400 bytes with its cell's share of contact rows: 8 GB in all.
pub const MAX_SITES: u64 = 20_000_000;

/// Largest index of a strand or crossing, and largest phase: far beyond any swatch, far below 32 bits.
pub const MAX_INDEX: i64 = 1_000_000;

const MAX_REPEAT: i64 = 1000;

/// Largest pitch in mm: a crossing of ten metres is a building.
const MAX_PITCH_MM: f64 = 10_000.0;

/// Taken where `[size]` is absent, in mm; no verdict depends on it.
const DEFAULT_PITCH_MM: f64 = 20.0;

/// The assembly, where `pitch` (in mm) could be read.
pub fn woven<'t>(reader: &mut Reader<'t>, root: &Fields<'t>, pitch: Option<f64>) -> Option<WovenSpec> {
    let weave = match reader.get(root, "weave") {
        Some(field) => weave(reader, &field),
        None => {
            let hint = "say what is woven, as in [weave] with abc = [1, 1, 1]; or list meshes as [[part]]";
            reader.lacks(root, "weave", "is missing", hint)
        }
    };
    let profile = match reader.get(root, "profile") {
        Some(field) => profile(reader, &field, weave.as_ref()),
        None => Some(DEFAULT_PROFILE),
    };
    let layout = layout(reader, root);
    let (layout, held) = layout.unzip();
    if let (Some(weave), Some(profile), Some(layout)) = (&weave, &profile, &layout) {
        limit_sites(reader, root, sites(weave, profile, layout));
    }
    Some(WovenSpec { weave: weave?, profile: profile?, layout: layout?, held: held?, pitch_mm: pitch? })
}

fn weave<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<Weave> {
    let fields = reader.table(field)?;
    const KEYS: [&str; 3] = ["abc", "draft", "wif"];
    reader.only(&fields, &KEYS, home);
    let named = |key: &&'static str| Some((*key, reader.get(&fields, key)?));
    let found: Vec<(&str, Field)> = KEYS.iter().filter_map(named).collect();
    for (_, field) in found.iter().skip(1) {
        reader.fault(field, "is a second weave", "leave one of abc, draft, wif");
    }
    match found.first() {
        Some(("abc", field)) => abc(reader, field),
        Some(("draft", field)) => drawn(reader, field),
        Some((_, field)) => wif(reader, field),
        None => {
            let hint = "one of abc = [1, 1, 1], draft = [\"X.\", \".X\"] or wif = \"file.wif\"";
            reader.lacks(&fields, "", "says no weave", hint)
        }
    }
}

fn abc<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<Weave> {
    let hint = "three whole numbers: a overs, b unders, moved by c from weft to weft; as in abc = [2, 2, 1]";
    let items = reader.list(field, hint)?;
    let [a, b, c] = &items[..] else {
        reader.fault(field, format!("has {} numbers", items.len()), hint);
        return None;
    };
    let most = i64::from(weave::MAX_RUN);
    let why = "each strand needs an over and an under, and floats beyond 64 crossings are refused";
    let (a, b) = (reader.integer(a, 1..=most, why), reader.integer(b, 1..=most, why));
    let c = reader.integer(c, i64::MIN..=i64::MAX, "a shift by any whole number of crossings");
    let (a, b, c) = (a?, b?, c?);
    // A shift beyond 32 bits is the same as its rest: the pattern has the period a + b.
    let c = i32::try_from(c).unwrap_or((c % (a + b)) as i32);
    Weave::abc(a as u32, b as u32, c).map_err(|faults| reader.others(faults)).ok()
}

fn drawn<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<Weave> {
    let hint = "one string for each weft, as in draft = [\"X.\", \".X\"]";
    let items = reader.list(field, hint)?;
    let rows: Option<Vec<&str>> = items.iter().map(|item| reader.text(item, hint)).collect();
    match Draft::drawn(&rows?) {
        Ok(draft) => Some(Weave::of_draft(draft, Origin::Drawn)),
        Err(faults) => {
            for fault in faults {
                reader.fault(items.get(fault.row).unwrap_or(field), fault.what, fault.hint);
            }
            None
        }
    }
}

fn wif<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<Weave> {
    let name = reader.text(field, "the path of a WIF file, relative to this one")?;
    let path = reader.file.parent().unwrap_or(Path::new("")).join(name);
    let text = input::bytes(&path).and_then(|bytes| input::legacy_text(bytes, &path));
    match text.and_then(|text| weave::parse_wif(&text, &path)) {
        Ok(weave) => Some(weave),
        Err(Faults(faults)) => {
            for fault in faults {
                match fault.place {
                    Some(_) => reader.others(fault.into()),
                    None => reader.fault(field, format!("{}: {}", fault.file, fault.what), fault.hint),
                }
            }
            None
        }
    }
}

const DEFAULT_PROFILE: ProfileSpec =
    ProfileSpec { shape: Shape::Rise(0.6), lift: 1.0, cover: 1.0, samples: 8, bounds: Bounds::Sandwich };

fn profile<'t>(reader: &mut Reader<'t>, field: &Field<'t>, weave: Option<&Weave>) -> Option<ProfileSpec> {
    let fields = reader.table(field)?;
    reader.only(&fields, &["rise", "points", "lift", "cover", "samples", "bounds"], home);
    let mut height = |key: &str, default: f64, why: &str| match reader.get(&fields, key) {
        Some(field) => reader.number(&field, (MORE_THAN_NONE, MOST_LIFT), why),
        None => Some(default),
    };
    let lift = height("lift", DEFAULT_PROFILE.lift, LIFT_WHY);
    let cover = height("cover", DEFAULT_PROFILE.cover, COVER_WHY);
    let samples = match reader.get(&fields, "samples") {
        Some(field) => reader.integer(&field, 2..=64, SAMPLES_WHY).map(|n| n as u32),
        None => Some(DEFAULT_PROFILE.samples),
    };
    let bounds = match reader.get(&fields, "bounds") {
        Some(field) => reader.choice(&field, &[("sandwich", Bounds::Sandwich), ("prism", Bounds::Prism)]),
        None => Some(DEFAULT_PROFILE.bounds),
    };
    let shape = match (reader.get(&fields, "rise"), reader.get(&fields, "points")) {
        (Some(_), Some(points)) => {
            reader.fault(
                &points,
                "stands beside `rise`",
                "points draw the whole centerline; leave one of them",
            );
            self::points(reader, &points, weave, lift, cover);
            None
        }
        (Some(rise), None) => {
            let why =
                "the width of a change of side: 0 a square wave, 1 triangular; more would overlap the next";
            reader.number(&rise, 0.0..=1.0, why).map(Shape::Rise)
        }
        (None, Some(field)) => points(reader, &field, weave, lift, cover).map(Shape::Points),
        (None, None) => Some(DEFAULT_PROFILE.shape),
    };
    Some(ProfileSpec { shape: shape?, lift: lift?, cover: cover?, samples: samples?, bounds: bounds? })
}

const MORE_THAN_NONE: Bound<f64> = Excluded(0.0);

/// Beyond six crossings a tile is a comb of needles.
const MOST_LIFT: Bound<f64> = Included(6.0);

const LIFT_WHY: &str = "the height of an over above an under, in crossings: without it nothing is woven, beyond six a \
     tile is a comb of needles";

const COVER_WHY: &str = "the distance of the sandwiching planes from the centerlines, in crossings: without it strands \
     have no thickness there";

const SAMPLES_WHY: &str = "with one site in a crossing the cells of a strand that changes side meet in an edge \
     only, and the tile is not one body; beyond 64 nothing changes but the time";

/// Millimetres in one crossing.
pub fn pitch<'t>(reader: &mut Reader<'t>, root: &Fields<'t>) -> Option<f64> {
    let Some(field) = reader.get(root, "size") else { return Some(DEFAULT_PITCH_MM) };
    let fields = reader.table(&field)?;
    reader.only(&fields, &["pitch"], home);
    match reader.get(&fields, "pitch") {
        Some(field) => reader.length(
            &field,
            (MORE_THAN_NONE, Included(MAX_PITCH_MM)),
            "the length of one crossing, up to 10 m",
        ),
        None => Some(DEFAULT_PITCH_MM),
    }
}

fn layout<'t>(reader: &mut Reader<'t>, root: &Fields<'t>) -> Option<(Layout, HeldSpec)> {
    let held = reader.get(root, "held");
    match (reader.get(root, "swatch"), reader.get(root, "piece")) {
        (Some(field), Some(piece)) => {
            reader.fault(&piece, "stands beside [swatch]", "either a regular swatch or pieces one by one");
            swatch(reader, &field, None);
            pieces(reader, &piece);
            None
        }
        (Some(field), None) => swatch(reader, &field, held),
        (None, Some(field)) => {
            let pieces = pieces(reader, &field);
            let held = match held {
                Some(field) => held_list(reader, &field).map(Some),
                None => Some(None),
            };
            let (pieces, flags) = pieces?;
            let held = held_pieces(reader, &pieces, flags, held?)?;
            Some((Layout::Pieces(pieces), held))
        }
        (None, None) => {
            let hint = "say which pieces there are: [swatch] with wefts and warps, or [[piece]] one by one";
            reader.lacks(root, "swatch", "is missing", hint)
        }
    }
}

fn swatch<'t>(
    reader: &mut Reader<'t>,
    field: &Field<'t>,
    outer: Option<Field<'t>>,
) -> Option<(Layout, HeldSpec)> {
    let fields = reader.table(field)?;
    reader.only(&fields, &["wefts", "warps", "cut", "repeat", "phase", "held"], home);
    let count = |reader: &mut Reader<'t>, key: &str| match reader.get(&fields, key) {
        Some(field) => {
            reader.integer(&field, 1..=MAX_INDEX, "how many strands the swatch has").map(|n| n as u32)
        }
        None => reader.lacks(&fields, key, "is missing", "how many strands the swatch has"),
    };
    let (wefts, warps) = (count(reader, "wefts"), count(reader, "warps"));
    let cut = match reader.get(&fields, "cut") {
        Some(field) => reader.choice(&field, &[("window", Cut::Window), ("tiles", Cut::Tiles)]),
        None => Some(Cut::Window),
    };
    let repeat = tiles_only(reader, &fields, "repeat", 1..=MAX_REPEAT, 1, cut);
    let phase = tiles_only(reader, &fields, "phase", -MAX_INDEX..=MAX_INDEX, 0, cut);
    let held = swatch_held(reader, &fields, outer);
    let (repeat, phase) = (repeat? as u32, phase? as i32);
    Some((Layout::Swatch { wefts: wefts?, warps: warps?, cut: cut?, repeat, phase }, held?))
}

/// A number that says where tiles are cut; with cut = "window" nothing but its default makes sense.
fn tiles_only<'t>(
    reader: &mut Reader<'t>,
    fields: &Fields<'t>,
    key: &str,
    range: std::ops::RangeInclusive<i64>,
    default: i64,
    cut: Option<Cut>,
) -> Option<i64> {
    let Some(field) = reader.get(fields, key) else { return Some(default) };
    let value = reader.integer(&field, range, "where strands are cut, in unit tiles and in crossings")?;
    if cut == Some(Cut::Window) && value != default {
        let what =
            format!("is {value}, but with cut = \"window\" each strand is one piece as long as the window");
        reader.fault(&field, what, "for pieces of whole unit tiles write cut = \"tiles\"");
        return None;
    }
    Some(value)
}

fn swatch_held<'t>(
    reader: &mut Reader<'t>,
    fields: &Fields<'t>,
    outer: Option<Field<'t>>,
) -> Option<HeldSpec> {
    match (reader.get(fields, "held"), outer) {
        (Some(_), Some(outer)) => {
            reader.fault(&outer, "is said in [swatch] too", "leave one of them");
            None
        }
        (None, None) => Some(HeldSpec::None),
        (inner, outer) => held_list(reader, &inner.or(outer)?).map(|(held, _)| held),
    }
}

/// Sites on the centerlines of the assembly's pieces, at least.
fn sites(weave: &Weave, profile: &ProfileSpec, layout: &Layout) -> u64 {
    let crossings = match layout {
        Layout::Swatch { wefts, warps, cut, repeat, .. } => {
            let length = |across: u32, tile: u32| match cut {
                Cut::Window => u64::from(across),
                Cut::Tiles => u64::from(across.max(tile.saturating_mul(*repeat))),
            };
            let of_wefts = u64::from(*wefts) * length(*warps, weave.tile.0);
            of_wefts + u64::from(*warps) * length(*wefts, weave.tile.1)
        }
        Layout::Pieces(pieces) => pieces.iter().map(|p| (i64::from(p.to) - i64::from(p.from)) as u64).sum(),
    };
    crossings.saturating_mul(u64::from(profile.samples))
}

fn limit_sites<'t>(reader: &mut Reader<'t>, root: &Fields<'t>, sites: u64) {
    if sites <= MAX_SITES {
        return;
    }
    let field = reader.get(root, "swatch").or_else(|| reader.get(root, "piece"));
    let what = format!("asks for {sites} sites, the limit is {MAX_SITES}");
    let hint =
        "sites are crossings of all strands times samples; at 400 bytes each more would not fit memory";
    field.iter().for_each(|field| reader.fault(field, what.clone(), hint));
}
