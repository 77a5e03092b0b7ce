//! Takes sets of numbers; gives smallest and inclusion-minimal sets that meet every one of them, exactly or not at all.
//!
//! Exact: what is called least is least, proven by exhaustion under a packing bound. Where the stated number of nodes
//! does not suffice, a proven lower bound is given instead, never a guess.

/// A set of numbers below a fixed count, in words of 64.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bits(Vec<u64>);

impl Bits {
    pub fn none(count: usize) -> Bits {
        Bits(vec![0; count.div_ceil(64)])
    }

    pub fn of(count: usize, members: impl IntoIterator<Item = usize>) -> Bits {
        let mut bits = Bits::none(count);
        members.into_iter().for_each(|k| bits.insert(k));
        bits
    }

    pub fn insert(&mut self, k: usize) {
        self.0[k / 64] |= 1 << (k % 64);
    }

    pub fn remove(&mut self, k: usize) {
        self.0[k / 64] &= !(1 << (k % 64));
    }

    pub fn has(&self, k: usize) -> bool {
        self.0[k / 64] >> (k % 64) & 1 == 1
    }

    pub fn meets(&self, other: &Bits) -> bool {
        self.0.iter().zip(&other.0).any(|(a, b)| a & b != 0)
    }

    pub fn is_within(&self, other: &Bits) -> bool {
        self.0.iter().zip(&other.0).all(|(a, b)| a & !b == 0)
    }

    pub fn len(&self) -> usize {
        self.0.iter().map(|w| w.count_ones() as usize).sum()
    }

    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|&w| w == 0)
    }

    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        (0..64 * self.0.len()).filter(|&k| self.has(k))
    }

    fn shared(&self, other: &Bits) -> usize {
        self.0.iter().zip(&other.0).map(|(a, b)| (a & b).count_ones() as usize).sum()
    }

    fn join(&mut self, other: &Bits) {
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a |= b);
    }
}

/// A smallest set that meets all.
#[derive(Clone, Debug)]
pub struct Least {
    pub set: Bits,
    /// No set of fewer members meets all.
    pub bound: usize,
}

/// The first in order among the smallest sets. `nodes`: branches that may be looked at; where they run out, `set` is one
/// that meets all and `bound` is what was proven.
pub fn least(sets: &[Bits], count: usize, nodes: usize) -> Least {
    let sets = without_supersets(sets);
    let greedy = greedy(&sets, count);
    let mut left = nodes;
    for size in packing(&sets, &Bits::none(count))..greedy.len() {
        match within(&sets, &mut Bits::none(count), size, &mut left) {
            Some(Some(set)) => return Least { set, bound: size },
            Some(None) => {}
            None => return Least { set: greedy, bound: size },
        }
    }
    let bound = greedy.len();
    Least { set: greedy, bound }
}

/// Sets that are no supersets of others: the rest are met with them.
fn without_supersets(sets: &[Bits]) -> Vec<Bits> {
    let mut sorted = sets.to_vec();
    sorted.sort_by_key(|s| (s.len(), s.clone()));
    sorted.dedup();
    let mut kept: Vec<Bits> = Vec::new();
    for s in sorted {
        if !kept.iter().any(|k| k.is_within(&s)) {
            kept.push(s);
        }
    }
    kept
}

/// Takes the number that meets most of what is open, again and again.
fn greedy(sets: &[Bits], count: usize) -> Bits {
    let mut chosen = Bits::none(count);
    loop {
        let open: Vec<&Bits> = sets.iter().filter(|s| !s.meets(&chosen)).collect();
        let most = (0..count).rev().max_by_key(|&k| open.iter().filter(|s| s.has(k)).count());
        match most.filter(|_| !open.is_empty()) {
            Some(k) => chosen.insert(k),
            None => return chosen,
        }
    }
}

/// A lower bound on the members still needed: disjoint sets not yet met, those first that share least with the others.
fn packing(sets: &[Bits], chosen: &Bits) -> usize {
    let open: Vec<&Bits> = sets.iter().filter(|s| !s.meets(chosen)).collect();
    let mut order: Vec<(usize, &Bits)> =
        open.iter().map(|s| (open.iter().map(|t| s.shared(t)).sum(), *s)).collect();
    order.sort_by_key(|o| o.0);
    let mut taken = Bits(vec![0; chosen.0.len()]);
    let mut packed = 0;
    for (_, s) in order {
        if !s.meets(&taken) {
            taken.join(s);
            packed += 1;
        }
    }
    packed
}

/// A set of at most `size` members; none where there is none. Outer none: out of nodes.
fn within(sets: &[Bits], chosen: &mut Bits, size: usize, nodes: &mut usize) -> Option<Option<Bits>> {
    *nodes = nodes.checked_sub(1)?;
    let Some(open) = sets.iter().filter(|s| !s.meets(chosen)).min_by_key(|s| s.len()) else {
        return Some(Some(chosen.clone()));
    };
    if chosen.len() + packing(sets, chosen) > size {
        return Some(None);
    }
    for k in open.iter() {
        chosen.insert(k);
        let found = within(sets, chosen, size, nodes)?;
        chosen.remove(k);
        if found.is_some() {
            return Some(found);
        }
    }
    Some(None)
}

/// All inclusion-minimal sets of at most `size` members that meet all of `sets`, in order; none where there are more than
/// `most` or the nodes run out.
pub fn minimal(sets: &[Bits], count: usize, size: usize, most: usize, nodes: usize) -> Option<Vec<Bits>> {
    let sets = without_supersets(sets);
    let mut found = std::collections::BTreeSet::new();
    let mut left = nodes;
    let mut state = Branch { sets: &sets, size, most, left: &mut left, found: &mut found };
    state.go(&mut Bits::none(count), &mut Bits::none(count)).then(|| found.into_iter().collect())
}

struct Branch<'a> {
    sets: &'a [Bits],
    size: usize,
    most: usize,
    left: &'a mut usize,
    found: &'a mut std::collections::BTreeSet<Bits>,
}

impl Branch<'_> {
    /// `barred`: members that earlier branches took; without them here no set is found twice. False when cut short.
    fn go(&mut self, chosen: &mut Bits, barred: &mut Bits) -> bool {
        if *self.left == 0 {
            return false;
        }
        *self.left -= 1;
        if !chosen.iter().all(|k| self.needs(chosen, k)) {
            return true;
        }
        let Some(open) = self.sets.iter().filter(|s| !s.meets(chosen)).min_by_key(|s| s.len()) else {
            self.found.insert(chosen.clone());
            return self.found.len() <= self.most;
        };
        if chosen.len() + packing(self.sets, chosen) > self.size {
            return true;
        }
        let mut tried = Vec::new();
        let mut whole = true;
        for k in open.iter().filter(|&k| !barred.has(k)).collect::<Vec<_>>() {
            chosen.insert(k);
            whole = self.go(chosen, barred);
            chosen.remove(k);
            barred.insert(k);
            tried.push(k);
            if !whole {
                break;
            }
        }
        tried.into_iter().for_each(|k| barred.remove(k));
        whole
    }

    /// Whether some set is met by `k` alone.
    fn needs(&self, chosen: &Bits, k: usize) -> bool {
        self.sets.iter().any(|s| s.has(k) && s.shared(chosen) == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sets(count: usize, lists: &[&[usize]]) -> Vec<Bits> {
        lists.iter().map(|l| Bits::of(count, l.iter().copied())).collect()
    }

    /// Every subset tried.
    fn brute(sets: &[Bits], count: usize) -> Vec<Bits> {
        let all = (0..1_u32 << count).map(|m| Bits::of(count, (0..count).filter(|k| m >> k & 1 == 1)));
        let meets: Vec<Bits> = all.filter(|b| sets.iter().all(|s| s.meets(b))).collect();
        let least = |b: &&Bits| !meets.iter().any(|c| c != *b && c.is_within(b));
        let mut minimal: Vec<Bits> = meets.iter().filter(least).cloned().collect();
        minimal.sort();
        minimal
    }

    /// Pseudo-random families (a linear congruence), against trying every subset.
    #[test]
    fn smallest_and_minimal_sets_are_those_of_brute_force() {
        let mut seed = 1_u64;
        let mut dice = |n: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % n
        };
        for _ in 0..200 {
            let count = 3 + dice(7);
            let family: Vec<Bits> = (0..1 + dice(9))
                .map(|_| Bits::of(count, (0..1 + dice(4)).map(|_| dice(count)).collect::<Vec<_>>()))
                .collect();
            let minimal_sets = brute(&family, count);
            let size = minimal_sets.iter().map(Bits::len).min().unwrap_or(0);
            let found = least(&family, count, 1 << 20);
            assert_eq!((found.bound, found.set.len()), (size, size), "{family:?}");
            assert!(family.iter().all(|s| s.meets(&found.set)));
            assert_eq!(minimal(&family, count, count, 1 << 20, 1 << 20), Some(minimal_sets), "{family:?}");
        }
    }

    #[test]
    fn out_of_nodes_a_bound_stays_a_bound() {
        // A cycle of seven pairs needs four; three disjoint pairs are all that a packing sees.
        let cycle: Vec<Vec<usize>> = (0..7).map(|k| vec![k, (k + 1) % 7]).collect();
        let cycle = sets(7, &cycle.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let cut = least(&cycle, 7, 1);
        assert!(cut.bound <= 4 && cut.set.len() >= 4);
        assert_eq!(least(&cycle, 7, 1000).bound, 4);
        assert_eq!(minimal(&cycle, 7, 7, 1, 1000), None);
    }

    #[test]
    fn nothing_to_meet_needs_nothing() {
        assert_eq!(least(&[], 5, 10).set.len(), 0);
        assert_eq!(minimal(&[], 5, 5, 10, 10), Some(vec![Bits::none(5)]));
    }
}
