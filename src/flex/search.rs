//! Takes the question; holds candidates against cores and plans until bounds meet or the work is spent.
//!
//! Cores found are carried over by the symmetries and decided again there, so each has its own self-stress. A set is
//! called enough only with a plan for the rest; its images under symmetries are enough by the same plan, moved.

use super::cover::{self, Bits};
use super::symmetry::{Symmetry, symmetries};
use super::{Ask, Cut, Enough, Flex, Listing, NoFlex, Wanted};
use crate::assembly::{Assembly, PartIx};
use crate::contact::{Patch, Touching};
use crate::cores::{self, Contacts, Core, Firm, Guard, Set};
use crate::sequence::clearance::with_clearance;
use crate::sequence::{self, Motions, Plan, lattice};
use crate::watch::{All, Stage, Watch};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

/// Branches of an exact search for sets that meet all cores: some seconds.
const NODES: usize = 1 << 20;

/// Candidates of one round; with more the list would tell nobody anything.
const MOST_CANDIDATES: usize = 4096;

/// Positions that are looked at where straight moves fail and the parts lie on a lattice: a second or so.
const MOST_POSITIONS: usize = 100_000;

pub struct Search<'a> {
    contacts: Contacts<'a>,
    /// The parts that plans are about: as they touch, or as made.
    planned: Assembly,
    ask: &'a Ask,
    watch: &'a Watch,
    stage: Stage,
    symmetries: Vec<Symmetry>,
    cores: BTreeMap<Set, Core>,
    unproven: BTreeSet<Set>,
    enough: BTreeMap<Set, Enough>,
    /// Least locked sets whose lock is not shown within the files' digits.
    doubtful: BTreeSet<Set>,
}

/// What became of a candidate.
enum Judged {
    Enough(Box<Plan<()>>),
    /// Cores or stuck sets that it misses were found.
    Missed,
    Cut(Cut),
}

impl<'a> Search<'a> {
    pub fn new(touching: Touching<'a>, ask: &'a Ask, watch: &'a Watch) -> Result<Search<'a>, NoFlex> {
        let asm = touching.assembly;
        let planned = with_clearance(asm, touching.patches, ask.clearance)?;
        let planned = if ask.clearance > 0.0 { planned } else { asm.clone() };
        Ok(Search {
            contacts: Contacts::new(touching),
            planned,
            ask,
            watch,
            stage: watch.stage("locks and plans", "units of work", All::AtMost(ask.work)),
            symmetries: symmetries(asm, ask.within),
            cores: BTreeMap::new(),
            unproven: BTreeSet::new(),
            enough: BTreeMap::new(),
            doubtful: BTreeSet::new(),
        })
    }

    pub fn run(mut self) -> Result<Flex, NoFlex> {
        let (first, cut) = self.first()?;
        let list = match cut {
            Some(cut) => Listing::CutShort(cut),
            None => self.list(first)?,
        };
        let (count, cores) = (self.count(), self.bits(self.cores.keys()));
        let lower = cover::least(&cores, count, NODES).bound;
        let upper = self.enough.keys().map(Set::len).min().unwrap_or(count);
        Ok(Flex {
            lower,
            upper,
            enough: self.sorted(),
            cores: self.cores.into_values().collect(),
            unproven: self.unproven.into_iter().collect(),
            doubtful: self.doubtful.into_iter().collect(),
            symmetries: self.symmetries,
            list,
            work: self.contacts.work(),
        })
    }

    fn count(&self) -> usize {
        self.contacts.touching.assembly.parts.len()
    }

    fn sorted(&mut self) -> Vec<Enough> {
        let mut all: Vec<Enough> = std::mem::take(&mut self.enough).into_values().collect();
        all.sort_by(|a, b| a.set.len().cmp(&b.set.len()).then(a.set.cmp(&b.set)));
        all
    }

    fn bits<'s>(&self, sets: impl IntoIterator<Item = &'s Set>) -> Vec<Bits> {
        sets.into_iter().map(|s| Bits::of(self.count(), s.iter().map(|p| p.at()))).collect()
    }

    /// What a set must meet to be enough, as far as is known.
    fn to_meet(&self) -> Vec<Bits> {
        self.bits(self.cores.keys().chain(&self.unproven))
    }

    /// A smallest set that meets all that was found and is enough; where the work is spent, any that is enough.
    fn first(&mut self) -> Result<(usize, Option<Cut>), NoFlex> {
        loop {
            let least = cover::least(&self.to_meet(), self.count(), NODES);
            let exact = least.bound == least.set.len();
            let set: Set = set(&least.set);
            match self.judge(&set)? {
                Judged::Enough(plan) => {
                    self.keep(set, *plan);
                    return Ok((least.set.len(), (!exact).then_some(Cut::Work)));
                }
                Judged::Missed => {}
                Judged::Cut(cut) => return Ok((self.any(set)?, Some(cut))),
            }
        }
    }

    /// Adds parts to the set, from what stays together, until a plan takes the rest apart. Ends: a set of all is enough.
    fn any(&mut self, mut flexible: Set) -> Result<usize, NoFlex> {
        loop {
            let rest = self.rest(&flexible);
            let plan = self.taken_apart(&rest)?;
            if plan.stuck.is_empty() {
                let size = flexible.len();
                self.keep(flexible, plan);
                return Ok(size);
            }
            let stuck: Vec<Set> = plan.stuck.iter().map(|s| self.named(&s.parts)).collect();
            flexible.extend(stuck.iter().filter_map(|s| s.iter().max_by_key(|p| self.degree(**p)).copied()));
        }
    }

    /// Contacts of a part: one with many is a good one to bend.
    fn degree(&self, p: PartIx) -> usize {
        self.contacts.touching.patches.iter().filter(|q| q.a == p || q.b == p).count()
    }

    fn rest(&self, flexible: &Set) -> Vec<PartIx> {
        self.contacts.touching.assembly.ids().filter(|p| !flexible.contains(p)).collect()
    }

    /// First-order contacts count only where parts touch.
    fn patches(&self) -> &'a [Patch] {
        if self.ask.clearance > 0.0 { &[] } else { self.contacts.touching.patches }
    }

    fn named(&self, ids: &[String]) -> Set {
        let asm = self.contacts.touching.assembly;
        asm.ids().filter(|&p| ids.contains(&asm.part(p).id)).collect()
    }

    fn spent(&self) -> Option<Cut> {
        self.stage.reach(self.contacts.work() as usize);
        match self.ask.until {
            _ if self.watch.is_stopped() => Some(Cut::Stopped),
            _ if self.contacts.work() >= self.ask.work => Some(Cut::Work),
            Some(end) if Instant::now() >= end => Some(Cut::Time),
            _ => None,
        }
    }

    /// Looks for cores among the parts outside the set, then for a plan.
    fn judge(&mut self, flexible: &Set) -> Result<Judged, NoFlex> {
        if let Some(cut) = self.spent() {
            return Ok(Judged::Cut(cut));
        }
        let rest = self.rest(flexible);
        if self.learn_cores(rest.iter().copied().collect()) {
            return Ok(Judged::Missed);
        }
        let plan = self.plan(&rest)?;
        if plan.stuck.is_empty() {
            return Ok(Judged::Enough(Box::new(plan)));
        }
        // What stayed together when it was stopped says nothing.
        if plan.stopped {
            return Ok(Judged::Cut(Cut::Stopped));
        }
        for stuck in &plan.stuck {
            let stuck = self.least_stuck(self.named(&stuck.parts))?;
            let images: Vec<Set> = self.images(&stuck);
            self.unproven.extend(images);
        }
        Ok(Judged::Missed)
    }

    fn plan(&mut self, parts: &[PartIx]) -> Result<Plan<()>, NoFlex> {
        let set: Set = parts.iter().copied().collect();
        self.contacts.pay(set.len(), self.contacts.patches_among(&set));
        self.taken_apart(parts)
    }

    /// By straight moves, or else on the parts' lattice, if they have one.
    fn taken_apart(&self, parts: &[PartIx]) -> Result<Plan<()>, NoFlex> {
        let (asm, watch) = (&self.planned, self.watch.unseen());
        let straight =
            sequence::plan_watched(asm, parts, self.patches(), Motions::Straight, &watch, |_| None)?;
        if straight.stuck.is_empty() || straight.stopped {
            return Ok(straight);
        }
        // What comes apart as it touches does so with air between, too.
        let asked = lattice::answer::Asked {
            asm: self.contacts.touching.assembly,
            parts,
            step: None,
            weight: |_| 1,
            most: Some(MOST_POSITIONS),
            groups: None,
            watch: &watch,
        };
        let found = lattice::answer::plan(&asked, |_| None);
        let positions = found.as_ref().ok().and_then(|p| p.counted.as_ref()).map_or(0, |c| c.positions);
        self.contacts.pay(0, positions);
        let stopped = self.watch.is_stopped();
        let whole = found.ok().filter(|p| p.stuck.is_empty());
        Ok(whole.map_or(Plan { stopped, ..straight }, |p| Plan { counted: None, ..p }))
    }

    /// Disjoint minimal cores within a set, with their images; true where there is one. What is locked as written and not
    /// shown to be within the files' digits is no core: a plan may take it apart.
    fn learn_cores(&mut self, mut within: Set) -> bool {
        if self.ask.clearance > 0.0 {
            return false;
        }
        let mut found = false;
        loop {
            let largest = cores::largest(&self.contacts, &within, Guard::Without).largest;
            if largest.is_empty() || self.watch.is_stopped() {
                return found;
            }
            for large in largest {
                let least = cores::least(&self.contacts, large.clone());
                within.retain(|p| !least.parts.contains(p));
                for core in [least, large] {
                    if let Some(core) = self.holding(core) {
                        self.learn(core);
                        found = true;
                        break;
                    }
                }
            }
        }
    }

    /// The core, if its lock holds whatever the files' digits leave open.
    fn holding(&mut self, core: Core) -> Option<Core> {
        if self.doubtful.contains(&core.parts) {
            return None;
        }
        let parts = core.parts.clone();
        let core = cores::firm(&self.contacts, core).filter(|c| c.firm == Firm::Holds);
        if core.is_none() {
            self.doubtful.insert(parts);
        }
        core
    }

    /// Notes a core and what the symmetries make of it, each decided where it lies.
    fn learn(&mut self, core: Core) {
        for image in self.images(&core.parts) {
            if image != core.parts && !self.cores.contains_key(&image) {
                let there = cores::locked(&self.contacts, &image).and_then(|c| self.holding(c));
                self.cores.extend(there.map(|c| (image, c)));
            }
        }
        self.cores.entry(core.parts.clone()).or_insert(core);
    }

    /// Leaves parts out of a set that stayed together while it still does: a smaller one says more.
    fn least_stuck(&mut self, stuck: Set) -> Result<Set, NoFlex> {
        let mut stuck = stuck;
        for part in stuck.clone() {
            let less: Vec<PartIx> = stuck.iter().copied().filter(|&p| p != part).collect();
            if self.spent().is_none() && less.len() > 1 {
                let plan = self.plan(&less)?;
                if let Some(s) = plan.stuck.first().filter(|_| !plan.stopped) {
                    stuck = self.named(&s.parts);
                }
            }
        }
        Ok(stuck)
    }

    fn images(&self, set: &Set) -> Vec<Set> {
        let moved = |s: &Symmetry| -> Set { set.iter().map(|p| PartIx(s.to[p.at()] as u32)).collect() };
        self.symmetries.iter().map(moved).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// The first of a set's images: the one that stands for its orbit.
    fn first_image(&self, set: &Set) -> Set {
        self.images(set).into_iter().next().unwrap_or_default()
    }

    fn keep(&mut self, set: Set, plan: Plan<()>) {
        let orbit = self.images(&set);
        self.enough.insert(self.first_image(&set), Enough { set, orbit, plan });
    }

    /// Judges every minimal set that meets what was found, until all are enough.
    fn list(&mut self, least: usize) -> Result<Listing, NoFlex> {
        if let Some(cut) = self.all_up_to(least)? {
            return Ok(Listing::CutShort(cut));
        }
        if self.ask.wanted == Wanted::Smallest {
            return Ok(Listing::Complete);
        }
        let cut = self.all_up_to(self.count())?;
        Ok(if cut.is_some() { Listing::SmallestComplete } else { Listing::Complete })
    }

    fn all_up_to(&mut self, size: usize) -> Result<Option<Cut>, NoFlex> {
        loop {
            let all = cover::minimal(&self.to_meet(), self.count(), size, MOST_CANDIDATES, NODES);
            let Some(all) = all else { return Ok(Some(Cut::Many)) };
            let mut settled = true;
            for candidate in all {
                let candidate = self.first_image(&set(&candidate));
                if self.enough.contains_key(&candidate) {
                    continue;
                }
                match self.judge(&candidate)? {
                    Judged::Enough(plan) => self.keep(candidate, *plan),
                    // What was learnt changes the candidates.
                    Judged::Missed => {
                        settled = false;
                        break;
                    }
                    Judged::Cut(cut) => return Ok(Some(cut)),
                }
            }
            if settled {
                return Ok(None);
            }
        }
    }
}

fn set(bits: &Bits) -> Set {
    bits.iter().map(|k| PartIx(k as u32)).collect()
}
