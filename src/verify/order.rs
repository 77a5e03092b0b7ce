//! Takes a graph; gives an order of its nodes in which neighbours stand near each other.
//!
//! Reverse Cuthill-McKee (1969): breadth first from a node far out. Not promised: the best such order; only the time
//! and memory of a factorization depend on it.

use std::collections::{BTreeSet, VecDeque};

/// For each node that is wanted its place, from 0; edges to others count for nothing.
pub fn order(wanted: &[bool], edges: impl Iterator<Item = (usize, usize)>) -> Vec<Option<usize>> {
    let mut beside = vec![BTreeSet::new(); wanted.len()];
    for (a, b) in edges.filter(|&(a, b)| wanted[a] && wanted[b] && a != b) {
        beside[a].insert(b);
        beside[b].insert(a);
    }
    let mut seen: Vec<bool> = wanted.iter().map(|w| !w).collect();
    let mut all = Vec::new();
    for start in 0..wanted.len() {
        if !seen[start] {
            // Twice: the last node reached lies far out, a better place to start.
            let far = breadth(&beside, start, &mut seen.clone()).last().copied().unwrap_or(start);
            all.extend(breadth(&beside, far, &mut seen));
        }
    }
    let mut place = vec![None; wanted.len()];
    all.iter().rev().enumerate().for_each(|(k, &node)| place[node] = Some(k));
    place
}

/// Nodes reached from one, level by level, those with few neighbours first.
fn breadth(beside: &[BTreeSet<usize>], start: usize, seen: &mut [bool]) -> Vec<usize> {
    let mut queue = VecDeque::from([start]);
    seen[start] = true;
    let mut reached = Vec::new();
    while let Some(node) = queue.pop_front() {
        reached.push(node);
        let mut next: Vec<usize> = beside[node].iter().copied().filter(|&n| !seen[n]).collect();
        next.sort_by_key(|&n| (beside[n].len(), n));
        for n in next {
            seen[n] = true;
            queue.push_back(n);
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_in_any_order_becomes_a_chain() {
        let edges = [(3, 0), (0, 4), (4, 1), (1, 2)];
        let place = order(&[true; 5], edges.into_iter());
        let mut seen: Vec<usize> = place.iter().map(|p| p.unwrap()).collect();
        assert!(edges.iter().all(|&(a, b)| seen[a].abs_diff(seen[b]) == 1), "{place:?}");
        seen.sort_unstable();
        assert_eq!(seen, [0, 1, 2, 3, 4]);
        assert_eq!(order(&[true, false, true], [(0, 1), (1, 2)].into_iter()).iter().flatten().count(), 2);
    }
}
