//! Takes a motion of a swatch, its pieces and the draft; gives for each piece that comes loose what a weaver would say:
//! where it floats, and at which crossings the thread that should hold it is not there.
//!
//! First order, as the motion is. Said is what this motion does; there may be others, which move other pieces.

use crate::assembly::Assembly;
use crate::locking::{Motion, Twist};
use crate::spec::ProfileSpec;
use crate::tile::Piece;
use crate::weave::{Draft, Kind, Strand, Weave};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a piece starts to move, from its velocities at its crossings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum How {
    /// Up at every crossing.
    Lifts,
    /// Down at every crossing.
    Drops,
    /// Up at some crossings, down at others.
    Tips,
    /// Along its own length.
    SlidesAlong,
    /// Across its length, in the plane of the cloth.
    SlidesAcross,
}

/// One crossing of a loose piece.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CrossingAnswer {
    /// The strand that is crossed.
    pub strand: String,
    /// Whether the loose piece passes `over` or `under` it.
    pub passes: String,
    /// The part of that strand at this crossing; null where no piece of it reaches here.
    pub part: Option<String>,
    /// Upward speed of the piece here, as a share of the fastest.
    pub rises: f64,
}

/// Why a piece is loose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loose {
    pub part: String,
    pub how: How,
    pub crossings: Vec<CrossingAnswer>,
    /// Most crossings in a row at which it passes over threads that are there, and under.
    pub float_over: usize,
    pub float_under: usize,
    pub words: String,
}

/// Pieces explained; where more move at once their number is told by the motion.
const MOST_EXPLAINED: usize = 3;

/// A part whose speed is below this share of the fastest is told as standing still: motions are known to about 1e-10.
const MOVING_SHARE: f64 = 1e-6;

/// The pieces that move against the largest group of parts that keep together, fastest first.
pub fn loose(
    weave: &Weave,
    profile: &ProfileSpec,
    asm: &Assembly,
    pieces: &[Piece],
    motion: &Motion,
) -> Vec<Loose> {
    if pieces.len() != asm.parts.len() {
        return Vec::new();
    }
    let fields = against_most(asm, motion);
    let height = profile.lift / 2.0;
    let speeds: Vec<Vec<DVec3>> = pieces
        .iter()
        .zip(&fields)
        .map(|(p, f)| (p.from..p.to).map(|c| f.at(place(p.strand, c, height))).collect())
        .collect();
    let speed = |k: usize| speeds[k].iter().map(|v| v.length()).fold(0.0, f64::max);
    let top = (0..pieces.len()).map(speed).fold(0.0, f64::max);
    let mut moving: Vec<usize> = (0..pieces.len()).filter(|&k| speed(k) > MOVING_SHARE * top).collect();
    moving.sort_by(|&a, &b| speed(b).total_cmp(&speed(a)).then(a.cmp(&b)));
    let told = moving.into_iter().take(MOST_EXPLAINED);
    told.map(|k| explained(&weave.draft, asm, pieces, k, &speeds[k])).collect()
}

/// Velocity field of a rigid motion: v(p) = shift + turn x p.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Field {
    shift: DVec3,
    turn: DVec3,
}

impl Field {
    const STILL: Field = Field { shift: DVec3::ZERO, turn: DVec3::ZERO };

    fn of(t: &Twist) -> Field {
        Field { shift: t.translation - t.rotation.cross(t.centre), turn: t.rotation }
    }

    fn at(&self, p: DVec3) -> DVec3 {
        self.shift + self.turn.cross(p)
    }

    fn less(&self, other: &Field) -> Field {
        Field { shift: self.shift - other.shift, turn: self.turn - other.turn }
    }

    fn size(&self) -> f64 {
        self.shift.length().max(self.turn.length())
    }
}

/// Each part's field, seen from the largest set of parts that have one field in common (the first of equals).
fn against_most(asm: &Assembly, motion: &Motion) -> Vec<Field> {
    let mut fields = vec![Field::STILL; asm.parts.len()];
    motion.twists.iter().for_each(|(p, t)| fields[p.at()] = Field::of(t));
    let top = fields.iter().map(Field::size).fold(0.0, f64::max);
    let alike = |f: &Field| fields.iter().filter(|g| g.less(f).size() <= MOVING_SHARE * top).count();
    let most = fields.iter().rev().max_by_key(|f| alike(f)).copied().unwrap_or(Field::STILL);
    fields.iter().map(|f| f.less(&most)).collect()
}

fn place(strand: Strand, crossing: i32, z: f64) -> DVec3 {
    let (along, across) = (f64::from(crossing) + 0.5, f64::from(strand.index) + 0.5);
    match strand.kind {
        Kind::Weft => DVec3::new(along, across, z),
        Kind::Warp => DVec3::new(across, along, z),
    }
}

fn other(strand: Strand, crossing: i32) -> Strand {
    let kind = if strand.kind == Kind::Weft { Kind::Warp } else { Kind::Weft };
    Strand { kind, index: crossing }
}

fn explained(draft: &Draft, asm: &Assembly, pieces: &[Piece], k: usize, speeds: &[DVec3]) -> Loose {
    let piece = pieces[k];
    let top = speeds.iter().map(|v| v.length()).fold(f64::MIN_POSITIVE, f64::max);
    let crossing = |(c, v): (i32, &DVec3)| CrossingAnswer {
        strand: other(piece.strand, c).to_string(),
        passes: if draft.is_over(piece.strand, c) { "over" } else { "under" }.into(),
        part: present(pieces, piece.strand, c).map(|q| asm.parts[q].id.clone()),
        rises: v.z / top,
    };
    let crossings: Vec<CrossingAnswer> = (piece.from..piece.to).zip(speeds).map(crossing).collect();
    let how = how(piece.strand.kind, speeds);
    let (float_over, float_under) = (float(&crossings, "over"), float(&crossings, "under"));
    let words = words(&asm.parts[k].id, how, &crossings);
    Loose { part: asm.parts[k].id.clone(), how, crossings, float_over, float_under, words }
}

/// The piece of the crossed strand that is there.
fn present(pieces: &[Piece], strand: Strand, crossing: i32) -> Option<usize> {
    let crossed = other(strand, crossing);
    pieces.iter().position(|p| p.strand == crossed && p.from <= strand.index && strand.index < p.to)
}

/// The largest component of the mean velocity names the motion; a piece whose ends go up and down by more, tips.
fn how(kind: Kind, speeds: &[DVec3]) -> How {
    let mean = speeds.iter().sum::<DVec3>() / speeds.len().max(1) as f64;
    let (along, across) = if kind == Kind::Weft { (mean.x, mean.y) } else { (mean.y, mean.x) };
    let (lo, hi) =
        speeds.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v.z), h.max(v.z)));
    let level = lo.abs().max(hi.abs());
    match () {
        () if level >= along.abs().max(across.abs()) && lo < 0.0 && hi > 0.0 => How::Tips,
        () if level >= along.abs().max(across.abs()) => {
            if hi > -lo {
                How::Lifts
            } else {
                How::Drops
            }
        }
        () if along.abs() >= across.abs() => How::SlidesAlong,
        () => How::SlidesAcross,
    }
}

/// Most crossings in a row that pass this way over or under a thread that is there.
fn float(crossings: &[CrossingAnswer], way: &str) -> usize {
    let mut longest = 0;
    let mut run = 0;
    for c in crossings {
        run = if c.part.is_some() && c.passes == way { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    longest
}

fn words(id: &str, how: How, crossings: &[CrossingAnswer]) -> String {
    let list = |way: &str, there: bool| -> Vec<&str> {
        let here = crossings.iter().filter(|c| c.passes == way && c.part.is_some() == there);
        here.map(|c| c.strand.as_str()).collect()
    };
    let (over, under) = (list("over", true), list("under", true));
    let (no_under, no_over) = (list("over", false), list("under", false));
    match how {
        How::Lifts => format!("{id} lifts out: {}", held("above", &under, &no_over, "over", &over)),
        How::Drops => format!("{id} drops out: {}", held("below", &over, &no_under, "under", &under)),
        How::Tips => format!(
            "{id} tips: it passes over {} and under {}, and no thread stops its rising end from above and its sinking \
             end from below{}",
            joined(&over),
            joined(&under),
            missing(&[no_over, no_under].concat())
        ),
        How::SlidesAlong => format!(
            "{id} slides along itself: no bend of it is caught between threads on both sides (over {}, under {}){}",
            joined(&over),
            joined(&under),
            missing(&[no_over, no_under].concat())
        ),
        How::SlidesAcross => format!(
            "{id} slides sideways: over {}, under {}, with nothing beside it on one side{}",
            joined(&over),
            joined(&under),
            missing(&[no_over, no_under].concat())
        ),
    }
}

/// `side`: where a thread would have to be to hold the piece; `stops` are those that are there, and move with it.
fn held(side: &str, stops: &[&str], absent: &[&str], floats: &str, on: &[&str]) -> String {
    let holder = if stops.is_empty() {
        format!("no thread lies {side} it")
    } else {
        format!("the threads {side} it ({}) give way with it", stops.join(", "))
    };
    let float = format!("it floats {floats} {} ({} in all)", joined(on), on.len());
    let lacks = match absent.len() {
        0 => format!("and within its length the draft puts no thread {side} it that is not there"),
        _ => format!("and where {} should lie {side} it, no piece of them reaches", absent.join(", ")),
    };
    format!("{holder}; {float}, {lacks}")
}

fn missing(absent: &[&str]) -> String {
    if absent.is_empty() { String::new() } else { format!("; no piece of {} reaches it", absent.join(", ")) }
}

fn joined(names: &[&str]) -> String {
    if names.is_empty() { "nothing".into() } else { names.join(", ") }
}

/// Fewest changes of side among the pieces: from over to under a present thread, or back, along the piece.
pub fn least_interlacing(draft: &Draft, pieces: &[Piece]) -> usize {
    let changes = |p: &Piece| {
        let sides: Vec<bool> = (p.from..p.to)
            .filter(|&c| present(pieces, p.strand, c).is_some())
            .map(|c| draft.is_over(p.strand, c))
            .collect();
        sides.windows(2).filter(|w| w[0] != w[1]).count()
    };
    pieces.iter().map(changes).min().unwrap_or(0)
}
