//! Takes a plan's count of moves; says whether the sets that it leaves together may stay so.
//!
//! The puzzle's groups are read from the file again. Not checked: whether such a set could be parted.

use crate::assembly::Assembly;
use crate::sequence::lattice::answer::Counted;
use crate::spec::puzzle::groups::Groups;
use crate::spec::{Spec, Subject};

/// # Errors
/// Why not.
pub fn allowed(spec: &Spec, asm: &Assembly, claimed: &Counted) -> Result<(), String> {
    if claimed.together.is_empty() {
        return Ok(());
    }
    let puzzle = match &spec.subject {
        Subject::Meshes(meshes) => meshes.puzzle.as_deref(),
        Subject::Woven(_) => None,
    };
    let groups = puzzle.and_then(Groups::of).ok_or("sets stay together, and the file names no groups")?;
    let place = |id: &String| {
        asm.parts
            .iter()
            .position(|p| p.id == *id)
            .ok_or(format!("there is no part {}", crate::fault::quoted(id)))
    };
    let sets = claimed.together.iter().map(|set| set.iter().map(place).collect());
    let sets = sets.collect::<Result<Vec<Vec<usize>>, String>>()?;
    if groups.allow(&sets) {
        Ok(())
    } else {
        Err("the groups do not say that these may stay together".into())
    }
}
