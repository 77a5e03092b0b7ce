//! Takes a `solution` element; gives the moves that it states: until the first parting, then of what stays, then of what
//! leaves, without sets that need no more than one move at a time.
//!
//! Not promised: that the states in the file are legal; only their number counts here.

use super::xml::Node;

/// Moves of a set, and what becomes of the two sets that it parts into.
struct Parting {
    moves: usize,
    stays: Option<Box<Parting>>,
    leaves: Option<Box<Parting>>,
}

/// None where nothing is stated, or what is stated has no end.
pub fn stated(solution: &Node) -> Option<Vec<usize>> {
    let parting = match (solution.first("separation"), solution.first("separationInfo")) {
        (Some(node), _) => tree(node),
        (None, Some(node)) => {
            let mut numbers = node.text.split_ascii_whitespace().map_while(|w| w.parse().ok());
            info(&mut numbers, 0)?
        }
        (None, None) => None,
    };
    parting.map(|p| counts(&p))
}

/// As many moves as states less one.
fn tree(node: &Node) -> Option<Parting> {
    let below = |kind: &str| {
        let mut all = node.all("separation");
        all.find(|c| c.attribute("type") == Some(kind)).and_then(tree).map(Box::new)
    };
    let moves = node.all("state").count().checked_sub(1)?;
    Some(Parting { moves, stays: below("left"), leaves: below("removed") })
}

/// Sets nest no deeper.
const DEEPEST: usize = 256;

/// Numbers of states in the order of the tree, 0 where a set is not parted. The outer None: the numbers have no end.
fn info(numbers: &mut impl Iterator<Item = usize>, depth: usize) -> Option<Option<Parting>> {
    if depth > DEEPEST {
        return None;
    }
    let Some(moves) = numbers.next()?.checked_sub(1) else { return Some(None) };
    let stays = info(numbers, depth + 1)?.map(Box::new);
    let leaves = info(numbers, depth + 1)?.map(Box::new);
    Some(Some(Parting { moves, stays, leaves }))
}

fn counts(parting: &Parting) -> Vec<usize> {
    let below = [&parting.stays, &parting.leaves].into_iter().flatten().filter(|p| has_several(p));
    std::iter::once(parting.moves).chain(below.flat_map(|p| counts(p))).collect()
}

fn has_several(parting: &Parting) -> bool {
    let below = [&parting.stays, &parting.leaves];
    parting.moves > 1 || below.into_iter().flatten().any(|p| has_several(p))
}
