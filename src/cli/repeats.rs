//! Takes what was asked of a weave's repetition; gives the answer, told, and its proofs as files where asked.
//!
//! Not promised: anything beyond what `repeats` promises.

use super::args::PuzzleArgs;
use super::args::length;
use super::load;
use super::questions::argument;
use super::told::{News, Told, Trouble};
use crate::assembly::layout::Swatch;
use crate::contact;
use crate::fault::{Fault, Faults};
use crate::locking;
use crate::repeats::grow::{self, Class, Sizes};
use crate::repeats::{AsMade, FILE, Search, Tried, repeats_watched, round, text};
use crate::report::answer::repeats::{Case, repeats as written};
use crate::report::answer::{self, RepeatsAnswer, Source};
use crate::report::file::write_whole;
use crate::spec::{self, Bounds, ProfileSpec, Shape, Subject, Syntax};
use crate::watch::{All, Watch};
use crate::weave::Weave;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Asked {
    /// `[a,b,c]`, or a woven spec, a WIF file or a drawn draft
    #[arg(allow_hyphen_values = true, value_name = "[a,b,c]|FILE")]
    pub weave: String,
    /// Largest repetition to try
    #[arg(long, alias = "max-repeat", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub most: u32,
    /// Phases of the cuts, or `all` of one period; all must lock
    #[arg(long, alias = "phases", default_value = "0", allow_hyphen_values = true)]
    pub phase: String,
    /// Swatches as WEFTSxWARPS, or multiples of one period: `--swatch n,2n,5x7`
    #[arg(long, value_delimiter = ',', value_name = "SIZES")]
    pub swatch: Vec<String>,
    /// Wefts and warps of the swatch (default: one period each way)
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub wefts: Option<u32>,
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub warps: Option<u32>,
    /// Profile, as in a spec's `[profile]` (default: the spec's, or 0.6, 1, 1 and 8)
    #[arg(long)]
    pub rise: Option<f64>,
    #[arg(long)]
    pub lift: Option<f64>,
    #[arg(long)]
    pub cover: Option<f64>,
    #[arg(long)]
    pub samples: Option<u32>,
    /// A table over several values of rise, lift, cover, samples, swatch or phase: `--vary rise=0.2,0.6,1`
    #[arg(long, value_name = "KEY=VALUES")]
    pub vary: Vec<String>,
    /// Air on each face of a contact, as "0.2 mm": asks what takes parts made so apart
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub clearance: Option<f64>,
    /// Length of one crossing, for the clearance (default: the spec's, or 20 mm)
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub pitch: Option<f64>,
    /// Prove the least k for swatches of every size: of whole periods, or of `all` numbers of strands
    #[arg(long, value_enum, value_name = "SIZES", num_args = 0..=1, default_missing_value = "periods")]
    pub every_size: Option<Every>,
    /// Write every row's proof into a folder, each as an answer of `check` that `verify` reads
    #[arg(long, value_name = "DIR")]
    pub proofs: Option<PathBuf>,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Every {
    Periods,
    All,
}

/// The search for one profile and swatch.
struct Query {
    profile: ProfileSpec,
    search: Search,
}

pub fn repeats(asked: &Asked, watch: &Watch) -> Result<Told, Trouble> {
    let (weave, base, pitch_mm) = subject(&asked.weave)?;
    let made =
        AsMade { clearance_mm: asked.clearance.unwrap_or(0.0), pitch_mm: asked.pitch.unwrap_or(pitch_mm) };
    let queries = queries(asked, &weave, &base)?;
    let found = searched(&weave, &queries, made, asked.most, watch)?;
    let cases: Vec<Case> =
        queries.iter().zip(&found).map(|(q, tried)| Case { profile: &q.profile, tried }).collect();
    let remarks = || load::falls_apart(&weave).into_iter().collect::<Vec<_>>();
    if watch.is_stopped() {
        return Ok(told(&stopped(written(&asked.weave, &cases, (&base, &[]), made, remarks()))));
    }
    let name = asked.weave.as_str();
    let mut answer = written(name, &cases, (&base, &[]), made, remarks());
    if let (Some(every), Some(k), Some(q)) = (asked.every_size, answer.minimal_repeat, queries.first()) {
        let _stage = watch.stage("every size", "", All::Open);
        let classes = classes(&weave, q, k, every)?;
        answer = written(name, &cases, (&q.profile, &classes), made, remarks());
    }
    if let Some(folder) = &asked.proofs {
        write_proofs(folder, &answer)?;
    }
    Ok(told(&answer))
}

/// The answer of a search that the user stopped: what was tried stands, a least k is not told.
fn stopped(mut answer: RepeatsAnswer) -> RepeatsAnswer {
    let tried = answer.table.len();
    answer.remarks.push(format!(
        "stopped by the user after {tried} swatches: a least k of all that was asked is not told"
    ));
    (answer.stopped, answer.minimal_repeat, answer.checksum) = (true, None, String::new());
    RepeatsAnswer { checksum: answer::checksum(&answer), ..answer }
}

/// The weave with the profile and pitch to start from.
fn subject(name: &str) -> Result<(Weave, ProfileSpec, f64), Trouble> {
    let path = Path::new(name);
    if load::is_spec(path) {
        return match load::spec(path, &PuzzleArgs::default(), &Watch::default())?.spec.subject {
            Subject::Woven(w) => Ok((w.weave, w.profile, w.pitch_mm)),
            Subject::Meshes(_) => Err(argument(
                "an assembly of meshes has no weave to repeat".into(),
                "give a woven spec, a WIF file, a drawn draft or [a,b,c]".into(),
            )
            .into()),
        };
    }
    let profile =
        ProfileSpec { shape: Shape::Rise(0.6), lift: 1.0, cover: 1.0, samples: 8, bounds: Bounds::Sandwich };
    Ok((load::weave(name)?, profile, AsMade::TOUCHING.pitch_mm))
}

/// Every case up to its own least k, then all at the largest of these.
fn searched(
    weave: &Weave,
    queries: &[Query],
    made: AsMade,
    most: u32,
    watch: &Watch,
) -> Result<Vec<Vec<Tried>>, Faults> {
    let stage = watch.stage(
        "profiles and sizes",
        if queries.len() > 1 { "cases" } else { "" },
        All::Just(queries.len() as u64),
    );
    let mut found = Vec::new();
    for q in queries {
        let search = Search { most, ..q.search.clone() };
        found.push(repeats_watched(weave, &q.profile, &search, made, watch)?);
        stage.add(1);
    }
    let all: Option<Vec<u32>> = found.iter().map(|f| f.least).collect();
    let k = all.and_then(|a| a.into_iter().max());
    for (q, f) in queries.iter().zip(&mut found) {
        for more in f.least.unwrap_or(most) + 1..=k.unwrap_or(0) {
            let row = round(weave, &q.profile, &q.search, (made, more), (watch, &stage))?;
            f.tried.extend(row.into_iter().flatten());
        }
    }
    Ok(found.into_iter().map(|f| f.tried).collect())
}

fn classes(weave: &Weave, q: &Query, k: u32, every: Every) -> Result<Vec<Class>, Faults> {
    let sizes = match every {
        Every::Periods => Sizes::Periods,
        Every::All => Sizes::All,
    };
    let each = q.search.phases.iter().map(|&phase| grow::grow(weave, &q.profile, k, phase, sizes));
    Ok(each.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// The answer for one weave, profile and swatch, as a run asks it.
pub fn repeated(
    weave: &Weave,
    name: &str,
    profile: &ProfileSpec,
    search: &Search,
    watch: &Watch,
) -> Result<RepeatsAnswer, Trouble> {
    let found = repeats_watched(weave, profile, search, AsMade::TOUCHING, watch)?;
    let cases = [Case { profile, tried: &found.tried }];
    let remarks = load::falls_apart(weave).into_iter().collect();
    Ok(written(name, &cases, (profile, &[]), AsMade::TOUCHING, remarks))
}

pub fn told(answer: &RepeatsAnswer) -> Told {
    let good = answer.minimal_repeat.is_some();
    let chapter = super::repeated::chapter(answer);
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(News::of(good), answer, &answer.weave, "Repetition", chapter)
    }
}

/// Values of the keys that may vary, read from the flags; all that is wrong with them at once.
fn queries(asked: &Asked, weave: &Weave, base: &ProfileSpec) -> Result<Vec<Query>, Trouble> {
    let mut faults = Vec::new();
    let mut values = Values {
        rise: asked.rise.into_iter().collect(),
        lift: asked.lift.into_iter().collect(),
        cover: asked.cover.into_iter().collect(),
        samples: asked.samples.into_iter().collect(),
        swatch: asked.swatch.clone(),
        phase: asked.phase.split(',').map(str::to_string).collect(),
    };
    asked.vary.iter().for_each(|v| values.vary(v, &mut faults));
    let swatches = values.swatches(asked, weave, &mut faults);
    let phases = values.phases(weave, &mut faults);
    let profiles = values.profiles(base);
    Faults(faults).or(())?;
    let mut queries = Vec::new();
    for profile in profiles {
        for &(wefts, warps) in &swatches {
            let search = Search { wefts, warps, phases: phases.clone(), most: asked.most };
            bounds(weave, &profile, &search)?;
            queries.push(Query { profile: profile.clone(), search });
        }
    }
    Ok(queries)
}

/// Holds profile and swatch to the bounds of a spec's.
fn bounds(weave: &Weave, profile: &ProfileSpec, search: &Search) -> Result<(), Faults> {
    let phase = search.phases.first().copied().unwrap_or(0);
    let swatch = Swatch { wefts: search.wefts, warps: search.warps, repeat: search.most, phase };
    let text = text(weave, profile, swatch, AsMade::TOUCHING.pitch_mm);
    spec::parse(&text, Path::new("(flags)"), Syntax::Toml).map(drop)
}

struct Values {
    rise: Vec<f64>,
    lift: Vec<f64>,
    cover: Vec<f64>,
    samples: Vec<u32>,
    swatch: Vec<String>,
    phase: Vec<String>,
}

impl Values {
    fn vary(&mut self, text: &str, faults: &mut Vec<Fault>) {
        let (key, list) = text.split_once('=').unwrap_or((text, ""));
        let words: Vec<&str> = list.split(',').map(str::trim).filter(|w| !w.is_empty()).collect();
        if words.is_empty() {
            faults
                .push(argument(format!("--vary {text} names no values"), "as in --vary rise=0.2,0.6".into()));
            return;
        }
        match key.trim() {
            "rise" => self.rise = numbers(&words, faults),
            "lift" => self.lift = numbers(&words, faults),
            "cover" => self.cover = numbers(&words, faults),
            "samples" => self.samples = numbers(&words, faults),
            "swatch" => self.swatch = words.into_iter().map(str::to_string).collect(),
            "phase" => self.phase = words.into_iter().map(str::to_string).collect(),
            key => faults.push(argument(
                format!("`{key}` can not be varied"),
                "one of rise, lift, cover, samples, swatch, phase".into(),
            )),
        }
    }

    fn swatches(&self, asked: &Asked, weave: &Weave, faults: &mut Vec<Fault>) -> Vec<(u32, u32)> {
        let (wefts, warps) = (weave.tile.1, weave.tile.0);
        if self.swatch.is_empty() {
            return vec![(asked.wefts.unwrap_or(wefts), asked.warps.unwrap_or(warps))];
        }
        let hint = "WEFTSxWARPS, each 1 to 256, or a multiple of one period; as in 4x6 or 2n";
        let mut sizes = Vec::new();
        for word in &self.swatch {
            match size(word, (wefts, warps)) {
                Some(size) => sizes.push(size),
                None => faults.push(argument(format!("`{word}` is no size of a swatch"), hint.into())),
            }
        }
        sizes
    }

    fn phases(&self, weave: &Weave, faults: &mut Vec<Fault>) -> Vec<i32> {
        if self.phase.iter().any(|w| w.trim() == "all") {
            return (0..weave.tile.0.max(weave.tile.1) as i32).collect();
        }
        let words: Vec<&str> = self.phase.iter().map(|w| w.trim()).collect();
        let mut phases: Vec<i32> = numbers(&words, faults);
        phases.sort_unstable();
        phases.dedup();
        phases
    }

    /// All that these values make together.
    fn profiles(&self, base: &ProfileSpec) -> Vec<ProfileSpec> {
        let shapes: Vec<Shape> = self.rise.iter().map(|&r| Shape::Rise(r)).collect();
        let mut all = with(vec![base.clone()], &shapes, |p, shape| p.shape = shape.clone());
        all = with(all, &self.lift, |p, &v| p.lift = v);
        all = with(all, &self.cover, |p, &v| p.cover = v);
        with(all, &self.samples, |p, &v| p.samples = v)
    }
}

/// Each of `all` with each of the values; as they are where there are none.
fn with<T>(all: Vec<ProfileSpec>, values: &[T], set: impl Fn(&mut ProfileSpec, &T)) -> Vec<ProfileSpec> {
    if values.is_empty() {
        return all;
    }
    let one = |p: &ProfileSpec, v: &T| {
        let mut p = p.clone();
        set(&mut p, v);
        p
    };
    all.iter().flat_map(|p| values.iter().map(|v| one(p, v)).collect::<Vec<_>>()).collect()
}

fn numbers<T: std::str::FromStr>(words: &[&str], faults: &mut Vec<Fault>) -> Vec<T> {
    let mut all = Vec::new();
    for word in words {
        match word.parse() {
            Ok(v) => all.push(v),
            Err(_) => faults
                .push(argument(format!("`{word}` is not a number that fits here"), "as in 0.6, or 2".into())),
        }
    }
    all
}

/// `4x6`, or `n`, `2n`: that many periods each way.
fn size(word: &str, (wefts, warps): (u32, u32)) -> Option<(u32, u32)> {
    let fits = |v: u32| (1..=256).contains(&v).then_some(v);
    let word = word.trim();
    if let Some(times) = word.strip_suffix('n') {
        let times: u32 = if times.is_empty() { 1 } else { times.parse().ok()? };
        return Some((fits(times.checked_mul(wefts)?)?, fits(times.checked_mul(warps)?)?));
    }
    let (a, b) = word.split_once('x')?;
    Some((fits(a.parse().ok()?)?, fits(b.parse().ok()?)?))
}

/// A `check` answer for each row: decided once more from its spec, the same bytes as the row's proof.
fn write_proofs(folder: &Path, answer: &RepeatsAnswer) -> Result<(), Trouble> {
    std::fs::create_dir_all(folder).map_err(|e| {
        argument(format!("cannot make {}: {e}", folder.display()), "choose a folder you may write to".into())
    })?;
    for (number, row) in answer.table.iter().enumerate() {
        let source = Source { file: FILE.into(), text: row.spec.clone() };
        let joined = contact::join(&spec::parse(&row.spec, Path::new(FILE), Syntax::Toml)?)?;
        let check = locking::check(&joined.assembly, &joined.patches, None);
        let json = serde_json::to_string(&answer::check(&joined, &check, source)).unwrap_or_default();
        let sizes = format!("{}x{}", row.swatch.wefts, row.swatch.warps);
        let name = format!("{number:03}-{sizes}-phase{}-k{}.json", row.phase, row.k);
        write_whole(&folder.join(name), format!("{json}\n").as_bytes())?;
    }
    Ok(())
}
