//! Takes a mesh; gives a tree of boxes over its triangles. The same mesh gives the same tree.

use crate::mesh::Mesh;
use glam::DVec3;

/// An axis-parallel box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    pub lo: DVec3,
    pub hi: DVec3,
}

impl Aabb {
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Aabb {
        let none = Aabb { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };
        points.into_iter().fold(none, |b, p| Aabb { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    pub fn union(self, o: Aabb) -> Aabb {
        Aabb { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Distance between the boxes squared; 0 where they touch or overlap.
    pub fn distance_squared(&self, o: &Aabb) -> f64 {
        (o.lo - self.hi).max(self.lo - o.hi).max(DVec3::ZERO).length_squared()
    }
}

#[derive(Clone, Copy, Debug)]
pub enum Node {
    Leaf { first: usize, count: usize },
    Branch { left: usize, right: usize },
}

/// Triangles in a leaf: below this the boxes cost more than the triangles.
const LEAF: usize = 4;

#[derive(Clone, Debug, Default)]
pub struct Bvh {
    pub boxes: Vec<Aabb>,
    pub nodes: Vec<Node>,
    /// Triangle indices; leaves name stretches of it.
    pub order: Vec<u32>,
}

impl Bvh {
    pub fn new(mesh: &Mesh) -> Bvh {
        let boxes: Vec<Aabb> = (0..mesh.triangles.len()).map(|t| Aabb::of(mesh.corners(t))).collect();
        let mut tree = Bvh { order: (0..boxes.len() as u32).collect(), ..Bvh::default() };
        if !boxes.is_empty() {
            tree.split(&boxes, 0, boxes.len());
        }
        tree
    }

    /// Builds the node over `order[first..end]` and gives its index; the root is 0.
    fn split(&mut self, boxes: &[Aabb], first: usize, end: usize) -> usize {
        let span = &self.order[first..end];
        let all = span.iter().map(|&t| boxes[t as usize]).reduce(Aabb::union).unwrap_or(boxes[0]);
        let me = self.nodes.len();
        self.boxes.push(all);
        self.nodes.push(Node::Leaf { first, count: end - first });
        if end - first > LEAF {
            let axis = (all.hi - all.lo).max_position();
            let middle = |t: u32| boxes[t as usize].lo[axis] + boxes[t as usize].hi[axis];
            self.order[first..end].sort_by(|&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
            let half = (first + end) / 2;
            let left = self.split(boxes, first, half);
            let right = self.split(boxes, half, end);
            self.nodes[me] = Node::Branch { left, right };
        }
        me
    }

    pub fn leaf(&self, first: usize, count: usize) -> &[u32] {
        &self.order[first..first + count]
    }

    /// One step of a walk over the unordered pairs of this tree's triangles, from (0, 0): the pairs of nodes below go to
    /// `todo`; two leaves give their triangles, the same twice where a leaf meets itself.
    pub fn open(&self, (i, j): (usize, usize), todo: &mut Vec<(usize, usize)>) -> Option<(&[u32], &[u32])> {
        match (self.nodes[i], self.nodes[j]) {
            (Node::Branch { left, right }, _) if i == j => {
                todo.extend([(left, left), (left, right), (right, right)]);
            }
            (Node::Branch { left, right }, _) => todo.extend([(left, j), (right, j)]),
            (_, Node::Branch { left, right }) => todo.extend([(i, left), (i, right)]),
            (Node::Leaf { first, count }, Node::Leaf { first: other, count: many }) => {
                return Some((self.leaf(first, count), self.leaf(other, many)));
            }
        }
        None
    }
}
