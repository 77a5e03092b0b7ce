//! Takes the steps of a plan as written, gives the moves: who moves how from where, and who stays.
//!
//! Checked: ids, numbers, held parts, that sets split and end as the plan says. Not checked: that nothing overlaps.

use super::turn::Path;
use super::{Checked, Parts, Scene, near, refuse};
use crate::assembly::{Mobility, PartIx};
use crate::sequence::{Ends, Outcome, Plan, Rigid, Screw, Shift, Step};
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// A step with its ids looked up.
pub(super) struct Move {
    /// Those that move alike, and how; disjoint.
    pub movers: Vec<(Parts, Path)>,
    pub stays: Parts,
    pub ends: Ends,
    /// As the plan claims it.
    pub clear: f64,
    /// Where parts are that earlier steps left elsewhere in their set: a motion from their place in the assembly.
    pub from: BTreeMap<PartIx, DAffine3>,
}

impl Move {
    pub fn moved(&self) -> Parts {
        self.movers.iter().flat_map(|(parts, _)| parts.iter().copied()).collect()
    }
}

type Wrong = (Vec<String>, String);

impl Scene<'_> {
    /// Sets split as the steps say, nothing held moves, and in the end all is as the outcome claims.
    pub(super) fn book<C>(&self, plan: &Plan<C>) -> Result<Vec<Move>, Box<Checked>> {
        let mut sets: BTreeSet<Parts> = BTreeSet::from([self.ids.values().copied().collect()]);
        let mut from: BTreeMap<PartIx, DAffine3> = BTreeMap::new();
        let mut moves = Vec::new();
        for (k, step) in plan.steps.iter().enumerate() {
            let fault = |(parts, why): Wrong| Box::new(refuse(k, &parts, 0.0, 0.0, &why));
            let m = self.read(step, &from).map_err(fault)?;
            self.splits(&m, &mut sets).map_err(|why| fault((step.parts.clone(), why.to_owned())))?;
            if m.ends == Ends::Inside {
                for (parts, path) in &m.movers {
                    for &p in parts {
                        let at = from.entry(p).or_insert(DAffine3::IDENTITY);
                        *at = path.at(1.0) * *at;
                    }
                }
            }
            moves.push(m);
        }
        let end = plan.steps.len();
        self.ends(&sets, plan).map_err(|why| Box::new(refuse(end, &[], 0.0, 0.0, why)))?;
        Ok(moves)
    }

    fn splits(&self, m: &Move, sets: &mut BTreeSet<Parts>) -> Result<(), &'static str> {
        let moved = m.moved();
        if moved.iter().any(|&p| self.asm.part(p).mobility == Mobility::Held) {
            return Err("a held part moves");
        }
        if moved.is_empty() || m.stays.is_empty() || !moved.is_disjoint(&m.stays) {
            return Err("what moves and what stays must be two sets without a common part");
        }
        let whole: Parts = moved.union(&m.stays).copied().collect();
        if !sets.contains(&whole) {
            return Err("the parts named are not one of the sets that are still together");
        }
        if m.ends == Ends::Apart {
            sets.remove(&whole);
            sets.extend(m.movers.iter().map(|(parts, _)| parts.clone()));
            sets.insert(m.stays.clone());
        }
        Ok(())
    }

    fn read(&self, step: &Step, from: &BTreeMap<PartIx, DAffine3>) -> Result<Move, Wrong> {
        if !(step.clear >= 0.0 && step.clear.is_finite()) {
            return Err((step.parts.clone(), "the least distance kept is no such number".to_owned()));
        }
        let moved = self.find(&step.parts)?;
        let mut movers = Vec::new();
        for (ids, motion) in step.motion.movers(&step.parts) {
            let path = self.path(&motion).map_err(|why| (ids.to_vec(), why.to_owned()))?;
            movers.push((self.find(ids)?, path));
        }
        let named: usize = movers.iter().map(|(parts, _)| parts.len()).sum();
        let all: Parts = movers.iter().flat_map(|(parts, _)| parts.iter().copied()).collect();
        if named != moved.len() || all != moved || movers.iter().any(|(parts, _)| parts.is_empty()) {
            return Err((
                step.parts.clone(),
                "the motions are not of the parts that move, each once".to_owned(),
            ));
        }
        let stays = self.find(&step.stays)?;
        Ok(Move { movers, stays, ends: step.ends, clear: step.clear, from: from.clone() })
    }

    fn find(&self, ids: &[String]) -> Result<Parts, Wrong> {
        let one = |id: &String| self.ids.get(id.as_str()).copied();
        let set = ids.iter().map(|id| one(id).ok_or_else(|| (vec![id.clone()], "no such part".to_owned())));
        let set = set.collect::<Result<Parts, _>>()?;
        if set.len() == ids.len() { Ok(set) } else { Err((ids.to_vec(), "a part is named twice".to_owned())) }
    }

    fn path(&self, motion: &Rigid) -> Result<Path, &'static str> {
        match motion {
            Rigid::Translation(shift) => self.straight(shift),
            Rigid::Screw(screw) => self.screw(screw),
        }
    }

    fn straight(&self, shift: &Shift) -> Result<Path, &'static str> {
        if !near(DVec3::from_array(shift.direction).length(), 1.0) {
            return Err("the direction is not a unit vector");
        }
        if !(shift.distance > 0.0 && shift.distance.is_finite()) {
            return Err("the distance is not a positive number");
        }
        if !near(shift.distance_mm, shift.distance * self.asm.mm_per_unit) {
            return Err("the distance in mm is another one");
        }
        Ok(Path::straight(shift.way()))
    }

    fn screw(&self, screw: &Screw) -> Result<Path, &'static str> {
        let (centre, axis) = (DVec3::from_array(screw.point), DVec3::from_array(screw.axis));
        let numbers = [screw.angle, screw.advance];
        if !near(axis.length(), 1.0) {
            return Err("the axis is not a unit vector");
        }
        if !centre.is_finite() || numbers.iter().any(|x| !x.is_finite()) || numbers == [0.0; 2] {
            return Err("the point, the angle or the advance is no number, or nothing moves");
        }
        if !near(screw.advance_mm, screw.advance * self.asm.mm_per_unit) {
            return Err("the advance in mm is another one");
        }
        Ok(Path { centre, axis, angle: screw.angle, slide: axis * screw.advance })
    }

    fn ends<C>(&self, sets: &BTreeSet<Parts>, plan: &Plan<C>) -> Result<(), &'static str> {
        let held = |s: &Parts| s.iter().all(|&p| self.asm.part(p).mobility == Mobility::Held);
        let together: BTreeSet<Parts> = sets.iter().filter(|s| s.len() > 1 && !held(s)).cloned().collect();
        let named =
            |ids: &Vec<String>| ids.iter().filter_map(|id| self.ids.get(id.as_str()).copied()).collect();
        let grouped: BTreeSet<Parts> = plan.counted.iter().flat_map(|c| &c.together).map(named).collect();
        let stuck: BTreeSet<Parts> = plan.stuck.iter().map(|s| named(&s.parts)).collect();
        let apart = plan.outcome == Outcome::Assembled;
        let is_all = stuck.is_disjoint(&grouped) && stuck.union(&grouped).eq(&together);
        match (is_all, stuck.is_empty() == apart) {
            (false, _) => Err("the sets left together are not those that the plan names"),
            (_, false) => Err("the outcome does not fit the sets left together"),
            _ => Ok(()),
        }
    }
}
