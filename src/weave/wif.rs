//! Takes a Weaving Information File (version 1.1); gives the draft it weaves, or all that is wrong with it.
//!
//! Row j = 0 of the draft is the first pick, column i = 0 the first warp thread; where the shed raises the warp, the
//! weft passes under. A liftplan goes before treadling and tie-up, as the format says, unless `[CONTENTS]` denies it.
//! Threads and picks without an entry, and the entry 0, stand for none. Not promised: colors, spacing, thickness and
//! private sections are not read; where one thread runs through several shafts, any of them moves it.

use super::ini::{Entry, Ini, STRICT, Section};
use super::{Draft, MAX_DRAFT, Origin, Weave};
use crate::fault::{Fault, Faults, Place, quoted};
use std::path::Path;

/// Shafts, and treadles, that a file may use: as many as a draft of [`MAX_DRAFT`] different columns or rows needs.
const MAX_SHAFTS: usize = MAX_DRAFT;

/// Threads, and picks, in a whole cloth; what must be small is its period.
const MAX_THREADS: usize = 2048;

/// A set of shafts or treadles, a bit for each number counted from 1.
type Numbers = [u64; MAX_SHAFTS / 64];

/// The weave of a WIF's text.
pub fn parse_wif(text: &str, file: &Path) -> Result<Weave, Faults> {
    let mut reader = Reader { file: file.display().to_string(), faults: Vec::new() };
    let draft = reader.draft(text);
    match (draft, reader.faults) {
        (Some(draft), faults) if faults.is_empty() => Ok(Weave::of_draft(draft, Origin::Wif(file.into()))),
        (_, faults) => Err(Faults::sorted(faults)),
    }
}

struct Reader {
    file: String,
    faults: Vec<Fault>,
}

impl Reader {
    fn draft(&mut self, text: &str) -> Option<Draft> {
        let (ini, wrong) = Ini::parse(text);
        wrong.into_iter().for_each(|w| self.fault(Some(w.line), w.what, w.hint));
        if ini.section("wif").is_none() {
            self.fault(
                None,
                "no section [WIF]".into(),
                "a WIF names itself so in its first lines; is it one?",
            );
            return None;
        }
        self.contents(&ini);
        let rising = self.rising(&ini);
        let threads = self.count(&ini, "WARP", "Threads", MAX_THREADS);
        let picks = self.count(&ini, "WEFT", "Threads", MAX_THREADS);
        let shafts = self.count(&ini, "WEAVING", "Shafts", MAX_SHAFTS);
        let threading = self.table(&ini, "THREADING", threads, shafts);
        let lifts = match has_liftplan(&ini) {
            true => self.table(&ini, "LIFTPLAN", picks, shafts),
            false => self.treadled(&ini, picks, shafts),
        };
        let (threading, lifts) = (threading?, lifts?);
        if !self.faults.is_empty() {
            return None;
        }
        let up = |lift: &Numbers, thread: &Numbers| meet(lift, thread) == rising;
        let over: Vec<Vec<bool>> =
            lifts.iter().map(|lift| threading.iter().map(|thread| !up(lift, thread)).collect()).collect();
        let (wefts, warps) = (lifts.len() as u32, threading.len() as u32);
        self.small(Draft::from_fn(wefts, warps, |j, i| over[j as usize][i as usize]))
    }

    fn fault(&mut self, line: Option<usize>, what: String, hint: &str) {
        let place = line.map(|line| Place { line, column: 1 });
        self.faults.push(Fault {
            file: self.file.clone(),
            place,
            key: String::new(),
            what,
            hint: hint.into(),
        });
    }

    /// Sections that `[CONTENTS]` promises must stand in the file, as far as the draft needs them.
    fn contents(&mut self, ini: &Ini) {
        let Some(contents) = ini.section("contents") else { return };
        for entry in contents.entries.iter().filter(|entry| STRICT.contains(&entry.key.as_str())) {
            if yes_no(&entry.value) == Some(true) && ini.section(&entry.key).is_none() {
                let what = format!("[CONTENTS] promises [{}], but there is none", entry.key.to_uppercase());
                self.fault(Some(entry.line), what, "the file may be cut off");
            }
        }
    }

    fn rising(&mut self, ini: &Ini) -> bool {
        let Some(entry) = ini.section("weaving").and_then(|s| s.entry("rising shed")) else { return true };
        yes_no(&entry.value).unwrap_or_else(|| {
            let what = format!("Rising Shed is {}", quoted(&entry.value));
            self.fault(
                Some(entry.line),
                what,
                "yes: tie-up and liftplan name the shafts that rise; no: that sink",
            );
            true
        })
    }

    fn count(&mut self, ini: &Ini, section: &str, key: &str, most: usize) -> Option<usize> {
        let found = self.section(ini, section)?;
        let Some(entry) = found.entry(&key.to_lowercase()) else {
            self.fault(Some(found.line), format!("[{section}] does not say {key}"), "the number is needed");
            return None;
        };
        match entry.value.parse() {
            Ok(n) if (1..=most).contains(&n) => Some(n),
            _ => {
                let what =
                    format!("{key} in [{section}] is {}, but it must be 1 to {most}", quoted(&entry.value));
                self.fault(Some(entry.line), what, "a whole number; of a larger cloth export one repeat");
                None
            }
        }
    }

    fn section<'a>(&mut self, ini: &'a Ini, name: &str) -> Option<&'a Section> {
        let found = ini.section(&name.to_lowercase());
        if found.is_none() {
            self.fault(None, format!("no section [{name}]"), "without it the draft is not known");
        }
        found
    }

    /// The sets of numbers in a section with lines `1=1,3`, for the keys 1 to `rows`; without a line the empty set.
    fn table(
        &mut self,
        ini: &Ini,
        name: &str,
        rows: Option<usize>,
        most: Option<usize>,
    ) -> Option<Vec<Numbers>> {
        let section = self.section(ini, name)?;
        let mut sets = vec![[0; MAX_SHAFTS / 64]; rows?];
        for entry in &section.entries {
            let row = entry.key.parse().ok().filter(|row| (1..=sets.len()).contains(row));
            let Some(row) = row else {
                let what =
                    format!("[{name}] has a line for {}, but counts 1 to {}", quoted(&entry.key), sets.len());
                self.fault(
                    Some(entry.line),
                    what,
                    "numbers start at 1 and end at the counts in the file's head",
                );
                continue;
            };
            sets[row - 1] = self.numbers(name, entry, most?);
        }
        Some(sets)
    }

    fn numbers(&mut self, section: &str, entry: &Entry, most: usize) -> Numbers {
        let mut set = [0; MAX_SHAFTS / 64];
        for word in entry.value.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            match word.parse::<usize>() {
                Ok(0) => {}
                Ok(n) if n <= most => set[(n - 1) / 64] |= 1 << ((n - 1) % 64),
                _ => {
                    let what = format!(
                        "[{section}] line {}: {} is not a number up to {most}",
                        quoted(&entry.key),
                        quoted(word)
                    );
                    self.fault(
                        Some(entry.line),
                        what,
                        "[WEAVING] says how many shafts and treadles there are",
                    );
                }
            }
        }
        set
    }

    /// The shafts moved in each pick: those tied to any of its treadles.
    fn treadled(&mut self, ini: &Ini, picks: Option<usize>, shafts: Option<usize>) -> Option<Vec<Numbers>> {
        let treadles = self.count(ini, "WEAVING", "Treadles", MAX_SHAFTS);
        let tieup = self.table(ini, "TIEUP", treadles, shafts);
        let treadling = self.table(ini, "TREADLING", picks, treadles);
        let (tieup, treadling) = (tieup?, treadling?);
        Some(treadling.iter().map(|pressed| tied(pressed, &tieup)).collect())
    }

    fn small(&mut self, draft: Draft) -> Option<Draft> {
        let (wefts, warps) = (draft.wefts(), draft.warps());
        if wefts as usize <= MAX_DRAFT && warps as usize <= MAX_DRAFT {
            return Some(draft);
        }
        let what = format!("the draft repeats only after {wefts} wefts and {warps} warps");
        let hint = format!("at most {MAX_DRAFT} x {MAX_DRAFT} crossings are taken: export one repeat");
        self.fault(None, what, &hint);
        None
    }
}

/// Whether a liftplan stands in the file and `[CONTENTS]` does not deny it.
fn has_liftplan(ini: &Ini) -> bool {
    let said = ini.section("contents").and_then(|contents| contents.entry("liftplan"));
    let denied = said.and_then(|entry| yes_no(&entry.value)) == Some(false);
    ini.section("liftplan").is_some() && !denied
}

fn tied(pressed: &Numbers, tieup: &[Numbers]) -> Numbers {
    let mut shafts = [0; MAX_SHAFTS / 64];
    let down = |treadle: usize| pressed[treadle / 64] >> (treadle % 64) & 1 == 1;
    for set in tieup.iter().enumerate().filter(|(at, _)| down(*at)).map(|(_, set)| set) {
        shafts.iter_mut().zip(set).for_each(|(all, more)| *all |= more);
    }
    shafts
}

fn meet(a: &Numbers, b: &Numbers) -> bool {
    a.iter().zip(b).any(|(a, b)| a & b != 0)
}

fn yes_no(word: &str) -> Option<bool> {
    match word.to_lowercase().as_str() {
        "yes" | "true" | "on" | "1" => Some(true),
        "no" | "false" | "off" | "0" => Some(false),
        _ => None,
    }
}

/// The draft as a WIF that reads back as the same draft: equal columns share a shaft, equal rows a treadle.
///
/// `title` goes into its `[TEXT]` section; line breaks in it become spaces.
pub fn to_wif(draft: &Draft, title: &str) -> String {
    let rows = draft.rows();
    let column = |i: usize| rows.iter().map(|row| row.as_bytes()[i]).collect::<Vec<u8>>();
    let columns: Vec<Vec<u8>> = (0..draft.warps() as usize).map(column).collect();
    let (shafts, threading) = grouped(&columns);
    let (treadles, treadling) = grouped(&rows);
    let raised = |row: &String| {
        let up = shafts.iter().enumerate().filter(|(_, warp)| row.as_bytes()[**warp] == b'.');
        up.map(|(shaft, _)| (shaft + 1).to_string()).collect::<Vec<_>>().join(",")
    };
    let tieup = treadles.iter().map(|&first| raised(&rows[first]));
    let sections = [
        ("THREADING", numbered(threading.iter().map(|shaft| shaft.to_string()))),
        ("TIEUP", numbered(tieup)),
        ("TREADLING", numbered(treadling.iter().map(|treadle| treadle.to_string()))),
    ];
    let body: String = sections.iter().map(|(name, lines)| format!("\n[{name}]\n{lines}")).collect();
    head(title, shafts.len(), treadles.len(), threading.len(), treadling.len()) + &body
}

/// Indices of the first of each group of equal items, and for each item the number of its group, counted from 1.
fn grouped<T: PartialEq>(items: &[T]) -> (Vec<usize>, Vec<usize>) {
    let mut firsts: Vec<usize> = Vec::new();
    let number = |(at, item): (usize, &T)| {
        let group = firsts.iter().position(|&first| items[first] == *item);
        group.map_or_else(
            || {
                firsts.push(at);
                firsts.len()
            },
            |group| group + 1,
        )
    };
    let numbers = items.iter().enumerate().map(number).collect();
    (firsts, numbers)
}

fn numbered(values: impl Iterator<Item = String>) -> String {
    values.enumerate().map(|(at, value)| format!("{}={value}\n", at + 1)).collect()
}

fn head(title: &str, shafts: usize, treadles: usize, threads: usize, picks: usize) -> String {
    let title: String = title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let program = concat!("Source Program=weavelock\nSource Version=", env!("CARGO_PKG_VERSION"));
    format!(
        "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=wif@mhsoft.com\n{program}\n\n\
         [CONTENTS]\nTEXT=yes\nWEAVING=yes\nWARP=yes\nWEFT=yes\nTHREADING=yes\nTIEUP=yes\nTREADLING=yes\n\n\
         [TEXT]\nTitle={title}\n\n\
         [WEAVING]\nShafts={shafts}\nTreadles={treadles}\nRising Shed=yes\n\n\
         [WARP]\nThreads={threads}\n\n[WEFT]\nThreads={picks}\n"
    )
}
