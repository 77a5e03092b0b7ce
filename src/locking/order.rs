//! Takes the graph of free parts that touch; gives an order of elimination and the blocks that the factor fills.
//!
//! Minimum degree, ties to the lowest index: deterministic. Not promised: the least fill.

use std::collections::BTreeSet;

/// The block pattern of a lower triangular factor, column by column in the order of elimination.
pub struct Pattern {
    /// Place of each node in the order.
    pub place: Vec<usize>,
    /// First block of each column; one more entry than columns.
    pub start: Vec<usize>,
    /// Row of each block (a place), rising in each column; the first is the column itself.
    pub row: Vec<usize>,
    /// For each row the blocks left of the diagonal: (column, block).
    pub left: Vec<Vec<(usize, usize)>>,
}

impl Pattern {
    /// `edges` name two different nodes below `nodes` each, in any order, repeated or not.
    pub fn new(nodes: usize, edges: &[(usize, usize)]) -> Pattern {
        let (order, columns) = eliminate(adjacency(nodes, edges));
        let mut place = vec![0; nodes];
        order.iter().enumerate().for_each(|(k, &v)| place[v] = k);
        let mut pattern = Pattern { place, start: vec![0], row: Vec::new(), left: vec![Vec::new(); nodes] };
        for (k, below) in columns.into_iter().enumerate() {
            let mut rows: Vec<usize> = below.into_iter().map(|v| pattern.place[v as usize]).collect();
            rows.sort_unstable();
            pattern.row.push(k);
            for r in rows {
                pattern.left[r].push((k, pattern.row.len()));
                pattern.row.push(r);
            }
            pattern.start.push(pattern.row.len());
        }
        pattern
    }

    /// The block of nodes `a` and `b`, and whether its rows are those of `a`; none where the pattern has none.
    pub fn block(&self, a: usize, b: usize) -> Option<(usize, bool)> {
        let (p, q) = (self.place[a], self.place[b]);
        let (column, row) = (p.min(q), p.max(q));
        let first = self.start[column];
        let at = self.row[first..self.start[column + 1]].binary_search(&row).ok()?;
        Some((first + at, p >= q))
    }

    /// The most scalar products that are added up in one entry of a factor whose blocks are `width` wide.
    pub fn most_terms(&self, width: usize) -> usize {
        (self.left.iter().map(Vec::len).max().unwrap_or(0) + 1) * width
    }

    /// The most entries in a row of the factor and its transpose together.
    pub fn most_entries(&self, width: usize) -> usize {
        let of = |k: usize| self.left[k].len() + self.start[k + 1] - self.start[k];
        (0..self.left.len()).map(of).max().unwrap_or(0) * width
    }
}

fn adjacency(nodes: usize, edges: &[(usize, usize)]) -> Vec<Vec<u32>> {
    let mut adjacent = vec![Vec::new(); nodes];
    for &(a, b) in edges {
        adjacent[a].push(b as u32);
        adjacent[b].push(a as u32);
    }
    for list in &mut adjacent {
        list.sort_unstable();
        list.dedup();
    }
    adjacent
}

/// The nodes in order, and the neighbours that each has when it goes.
fn eliminate(mut adjacent: Vec<Vec<u32>>) -> (Vec<usize>, Vec<Vec<u32>>) {
    let mut queue: BTreeSet<(usize, usize)> =
        adjacent.iter().enumerate().map(|(v, n)| (n.len(), v)).collect();
    let (mut order, mut columns) = (Vec::new(), Vec::new());
    while let Some((_, v)) = queue.pop_first() {
        let gone = std::mem::take(&mut adjacent[v]);
        for &u in &gone {
            let u = u as usize;
            queue.remove(&(adjacent[u].len(), u));
            adjacent[u] = union_without(&adjacent[u], &gone, u as u32, v as u32);
            queue.insert((adjacent[u].len(), u));
        }
        order.push(v);
        columns.push(gone);
    }
    (order, columns)
}

/// Both sorted lists merged, without two nodes.
fn union_without(a: &[u32], b: &[u32], u: u32, v: u32) -> Vec<u32> {
    let mut all = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let next = match (a.get(i), b.get(j)) {
            (Some(&x), Some(&y)) => x.min(y),
            (Some(&x), None) | (None, Some(&x)) => x,
            (None, None) => break,
        };
        i += usize::from(a.get(i) == Some(&next));
        j += usize::from(b.get(j) == Some(&next));
        if next != u && next != v {
            all.push(next);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_fills_nothing_and_a_star_goes_leaves_first() {
        let path = Pattern::new(4, &[(0, 1), (1, 2), (2, 3)]);
        assert_eq!(path.row.len(), 4 + 3);
        let star = Pattern::new(5, &[(4, 0), (4, 1), (2, 4), (3, 4)]);
        assert_eq!(star.row.len(), 5 + 4);
        assert!(star.place[4] >= 3);
    }

    #[test]
    fn a_ring_of_four_fills_one_diagonal() {
        let ring = Pattern::new(4, &[(0, 1), (1, 2), (2, 3), (3, 0)]);
        assert_eq!(ring.row.len(), 4 + 4 + 1);
        assert!(ring.block(0, 1).is_some());
    }
}
