//! Takes unit directions and how well each is known; gives them with those made one, or made to lie in one plane,
//! that cannot be told from it.
//!
//! Why: a slide needs the normals of all its contacts to be perpendicular to it, to the last bit; rounded
//! coordinates leave each normal a little off, which jams every oblique slide. What is done is an assumption: no
//! direction turns by more than twice what it is known to, but a lean finer than that is lost. Not promised: other
//! relations between directions (equal angles, a motion of several parts at once that needs them).

mod zone;

use glam::DVec3;
use std::collections::BTreeMap;

/// A direction up to its sign, and the angle (radians) by which the true one may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Direction {
    pub n: DVec3,
    pub known: f64,
}

/// What was assumed of an assembly's contact normals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Assumption {
    /// Distinct directions before and after.
    pub before: usize,
    pub after: usize,
    /// Sets of three directions or more that were put into one plane.
    pub planes: usize,
    /// The largest turn of a direction, in radians.
    pub turn: f64,
}

impl Assumption {
    /// In words, where anything was assumed.
    pub fn words(&self) -> Option<String> {
        (self.turn > 0.0).then(|| {
            format!(
                "{} directions of contact normals were taken as {}, {} sets of them as lying in a plane: none was \
                 turned by more than {:.1e} rad, which is what the files' digits leave open; a lean finer than \
                 that is not seen",
                self.before, self.after, self.planes, self.turn
            )
        })
    }
}

/// Directions of one plane put into it, after those that agree were made one.
pub(super) fn settled(directions: &[Direction]) -> (Vec<Direction>, Assumption) {
    let one = alike(directions, |_| &[], |_, _| true);
    let mut distinct: Vec<Direction> = Vec::new();
    let mut place: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let at: Vec<usize> = one
        .iter()
        .map(|d| {
            *place.entry(bits(upward(d.n))).or_insert_with(|| {
                distinct.push(Direction { n: upward(d.n), ..*d });
                distinct.len() - 1
            })
        })
        .collect();
    let (flat, planes) = zone::flattened(&distinct);
    let along = |k: usize| Direction { n: flat[at[k]].n * one[k].n.dot(flat[at[k]].n).signum(), ..one[k] };
    let out: Vec<Direction> = (0..one.len()).map(along).collect();
    let turn = out.iter().zip(directions).map(|(d, e)| d.n.angle_between(e.n)).fold(0.0, f64::max);
    let mut before: Vec<[u64; 3]> = directions.iter().map(|d| bits(upward(d.n))).collect();
    before.sort_unstable();
    before.dedup();
    (out, Assumption { before: before.len(), after: distinct.len(), planes, turn })
}

/// Each direction replaced by the best known one that it cannot be told from, with its own sign; `apart` lists for each
/// those that are known to be different ones, `fits` whether it may take another direction. Best known first, ties by
/// place.
pub(super) fn alike<'a>(
    directions: &[Direction],
    apart: impl Fn(usize) -> &'a [usize],
    fits: impl Fn(usize, Direction) -> bool,
) -> Vec<Direction> {
    let mut order: Vec<usize> = (0..directions.len()).collect();
    order.sort_by(|&i, &j| directions[i].known.total_cmp(&directions[j].known).then(i.cmp(&j)));
    let mut leader: Vec<usize> = (0..directions.len()).collect();
    let mut leaders: BTreeMap<(i64, usize), DVec3> = BTreeMap::new();
    for i in order {
        let Direction { n, known } = Direction { n: upward(directions[i].n), ..directions[i] };
        let near = near(&leaders, n, 2.0 * known).filter(|&(k, d)| d <= known + directions[k].known);
        let other = |k: usize| apart(i).iter().any(|&j| leader[j] == k);
        let near = near.filter(|&(k, _)| !other(k) && fits(i, directions[k]));
        let best = near.min_by(|x, y| x.1.total_cmp(&y.1).then(x.0.cmp(&y.0)));
        match best {
            Some((k, _)) => leader[i] = k,
            None => {
                leaders.insert((cell(n.x), i), n);
                // Near the equator of `upward` a direction stands on either side.
                leaders.insert((cell(-n.x), i), -n);
            }
        }
    }
    let with_sign = |i: usize| {
        let best = directions[leader[i]];
        Direction { n: best.n * best.n.dot(directions[i].n).signum(), known: best.known }
    };
    (0..directions.len()).map(with_sign).collect()
}

/// Leaders within `reach` of n, with their distances.
fn near(leaders: &BTreeMap<(i64, usize), DVec3>, n: DVec3, reach: f64) -> impl Iterator<Item = (usize, f64)> {
    let range = (cell(n.x - reach), 0)..=(cell(n.x + reach), usize::MAX);
    leaders.range(range).map(move |(&(_, k), &m)| (k, m.distance(n))).filter(move |&(_, d)| d <= reach)
}

/// A key that orders as the numbers do, fine enough for double precision about 1.
fn cell(x: f64) -> i64 {
    (x * 2f64.powi(53)).floor() as i64
}

/// The direction or its opposite, so that both give the same.
fn upward(n: DVec3) -> DVec3 {
    let first = [n.z, n.y, n.x].into_iter().find(|&c| c != 0.0).unwrap_or(1.0);
    // Adding zero turns -0 into +0: one direction, the same bits.
    n * first.signum() + DVec3::ZERO
}

fn bits(n: DVec3) -> [u64; 3] {
    n.to_array().map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(known: f64, all: &[DVec3]) -> Vec<Direction> {
        all.iter().map(|n| Direction { n: n.normalize(), known }).collect()
    }

    #[test]
    fn what_cannot_be_told_apart_becomes_one_and_keeps_its_sign() {
        let dirs = known(1e-6, &[DVec3::X, DVec3::new(-1.0, 1e-6, 0.0), DVec3::new(1.0, 1e-3, 0.0)]);
        let one = alike(&dirs, |_| &[], |_, _| true);
        assert_eq!((one[0].n, one[1].n, one[2].n), (DVec3::X, -DVec3::X, dirs[2].n));
        let two = alike(&dirs, |i| if i == 1 { &[0] } else { &[] }, |_, _| true);
        let none = alike(&dirs, |_| &[], |_, _| false);
        assert_eq!(none[1].n, dirs[1].n, "does not fit");
        assert_eq!(two[1].n, dirs[1].n, "known to be another one");
    }

    #[test]
    fn directions_about_an_axis_come_to_lie_exactly_across_it() {
        let axis = DVec3::new(1.0, 2.0, -0.5).normalize();
        let (u, v) = axis.any_orthonormal_pair();
        let spoke = |k: usize| {
            let (s, c) = (k as f64).sin_cos();
            u * c + v * s + axis * 1e-7 * (k as f64 * 7.0).sin()
        };
        let dirs = known(2e-7, &(0..9).map(spoke).chain([axis]).collect::<Vec<_>>());
        let (flat, said) = settled(&dirs);
        assert_eq!((said.before, said.after, said.planes), (10, 10, 1));
        let across = flat[0].n.cross(flat[2].n).normalize();
        assert!(flat[..9].iter().all(|d| d.n.dot(across).abs() < 1e-15));
        assert!(said.turn < 4e-7 && flat[9].n == axis);
    }
}
