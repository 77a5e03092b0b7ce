//! Takes what `check` says of keys and cores; says whether each claim holds against the contacts.
//!
//! Checked: the verdict with the held set ignored, every key's motion and directions, every core's certificate. Not
//! checked, since no witness can carry it: that no other key or core is there, and that none is smaller.

use super::certificate::{self, About};
use super::{digits, locked_alone, parts, same};
use crate::assembly::PartIx;
use crate::contact::Joined;
use crate::report::answer::{
    self, CheckAnswer, DirectionsAnswer, InterlockAnswer, InterlockWord, KeyAnswer, LockedCore, Proof, Word,
};
use glam::DVec3;
use std::collections::BTreeSet;

/// A unit direction may break a contact's plane by no more than this, from the round-off of the numbers behind it.
const SIGN_ROUND_OFF: f64 = 1e-9;

type Checked = Result<(), String>;

/// Holds the claims of an answer, if it makes any.
pub fn claims(joined: &Joined, a: &CheckAnswer) -> Checked {
    let Some(i) = &a.interlock else {
        return if a.interlocked.is_none() {
            Ok(())
        } else {
            Err("`interlocked` comes without its proof".into())
        };
    };
    if a.interlocked != Some(i.word) {
        return Err("`interlocked` is said in two ways".into());
    }
    word(joined, a, i)?;
    for k in &i.keys {
        key(joined, a, k).map_err(|why| format!("key {}: {why}", k.parts.join(", ")))?;
    }
    // The whole as one core quotes the certificate that was held already.
    let whole = |c: &LockedCore| {
        c.parts.len() == a.parts && a.rigid.certificate.as_ref().is_some_and(|own| *own == c.certificate)
    };
    for c in i.cores.iter().filter(|c| !whole(c)) {
        locked_alone(joined, &c.parts, &c.certificate)
            .and_then(|_| digits::firm(joined, &parts(joined, &c.parts)?, &c.certificate))
            .and_then(|firm| same("within the digits", &c.within_digits, &answer::firm(firm)))
            .map_err(|why| format!("core {}: {why}", c.parts.join(", ")))?;
    }
    Ok(())
}

fn word(joined: &Joined, a: &CheckAnswer, i: &InterlockAnswer) -> Checked {
    let asm = &joined.assembly;
    let verdict = match &i.proof {
        None if i.word == InterlockWord::NotRun => return Ok(()),
        None if a.held.len() > 1 => return Err("the verdict without the held set has no proof".into()),
        None => a.rigid.verdict,
        Some(proof) => {
            let first: Vec<String> = asm.parts.iter().take(1).map(|p| p.id.clone()).collect();
            certificate::proof(asm, &joined.patches, proof, &first, About::RigidMotions)
                .map_err(|why| format!("with the held set ignored: {why}"))?;
            proof.verdict
        }
    };
    if InterlockWord::from(verdict) == i.word {
        Ok(())
    } else {
        Err("`interlocked` does not follow from its proof".into())
    }
}

/// The group moves while all other parts stand still, every part of it, and along every direction named.
fn key(joined: &Joined, a: &CheckAnswer, k: &KeyAnswer) -> Checked {
    let asm = &joined.assembly;
    let group: BTreeSet<PartIx> = parts(joined, &k.parts)?.into_iter().collect();
    if group.len() == asm.parts.len() {
        return Err("some part must stand still".into());
    }
    if a.held.len() > 1 && k.parts.iter().any(|id| a.held.contains(id)) {
        return Err("a held part moves".into());
    }
    let told: BTreeSet<&String> = k.motion.twists.iter().map(|t| &t.part).collect();
    if told != k.parts.iter().collect() {
        return Err("its motion is not one of all its parts and of no other".into());
    }
    let still: Vec<String> =
        asm.ids().filter(|p| !group.contains(p)).map(|p| asm.part(p).id.clone()).collect();
    let proof = Proof { verdict: Word::Free, certificate: None, motion: Some(k.motion.clone()), gap: None };
    certificate::proof(asm, &joined.patches, &proof, &still, About::RigidMotions)?;
    k.directions.as_ref().map_or(Ok(()), |d| directions(joined, &group, d))
}

fn directions(joined: &Joined, group: &BTreeSet<PartIx>, d: &DirectionsAnswer) -> Checked {
    let both = d.lines.iter().flat_map(|&l| [DVec3::from_array(l), -DVec3::from_array(l)]);
    for d in both.chain(d.rays.iter().map(|&r| DVec3::from_array(r))) {
        if (d.length() - 1.0).abs() > SIGN_ROUND_OFF {
            return Err(format!("the direction {d} is no unit vector"));
        }
        for p in &joined.patches {
            let push = f64::from(i8::from(group.contains(&p.a)) - i8::from(group.contains(&p.b)));
            if p.normal.dot(d) * push > SIGN_ROUND_OFF {
                let ids = [p.a, p.b].map(|p| &joined.assembly.part(p).id);
                return Err(format!("along {d}, `{}` and `{}` approach each other", ids[0], ids[1]));
            }
        }
    }
    Ok(())
}
