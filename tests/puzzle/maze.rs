//! Cubes in the tunnel of a maze: puzzles whose level is known from the maze, as high as one likes.
//!
//! A cube alone must be moved once for each straight stretch of its way to the mouth; where several stand on one way, one
//! that is pushed out by those behind it needs no fewer.

use super::planned;
use crate::support::Dice;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt::Write as _;

type Cell = (usize, usize);

const WAYS: [(isize, isize); 4] = [(1, 0), (-1, 0), (0, 1), (0, -1)];

struct Maze {
    wide: usize,
    tunnel: BTreeSet<Cell>,
}

fn stepped((x, y): Cell, (dx, dy): (isize, isize)) -> Option<Cell> {
    Some((x.checked_add_signed(dx)?, y.checked_add_signed(dy)?))
}

impl Maze {
    /// A tree of corridors between n x n rooms, with a mouth beside the first.
    fn grown(n: usize, dice: &mut Dice) -> Maze {
        let wide = 2 * n + 1;
        let (mut tunnel, mut path) = (BTreeSet::from([(1, 1), (0, 1)]), vec![(1, 1)]);
        while let Some(&at) = path.last() {
            let next = |&way: &(isize, isize)| {
                let door = stepped(at, way)?;
                let room = stepped(door, way)?;
                (room.0 < wide && room.1 < wide && !tunnel.contains(&room)).then_some((door, room))
            };
            let all: Vec<(Cell, Cell)> = WAYS.iter().filter_map(next).collect();
            if all.is_empty() {
                path.pop();
                continue;
            }
            let (door, room) = all[dice.below(all.len())];
            tunnel.extend([door, room]);
            path.push(room);
        }
        Maze { wide, tunnel }
    }

    /// Straight moves, of any length, from each cell until a cube is outside.
    fn moves(&self) -> BTreeMap<Cell, usize> {
        let (mut moves, mut next) = (BTreeMap::from([((0, 1), 1)]), VecDeque::from([(0, 1)]));
        // Backwards from the mouth: the last move leaves from any cell straight before it.
        let mut at = (1, 1);
        while self.tunnel.contains(&at) {
            moves.insert(at, 1);
            next.push_back(at);
            at.0 += 1;
        }
        while let Some(from) = next.pop_front() {
            let so_far = moves[&from];
            for way in WAYS {
                let mut at = from;
                while let Some(to) = stepped(at, way).filter(|to| self.tunnel.contains(to)) {
                    moves.entry(to).or_insert_with(|| {
                        next.push_back(to);
                        so_far + 1
                    });
                    at = to;
                }
            }
        }
        moves
    }

    /// The block with its tunnel half way up and cubes in these cells.
    fn puzzle(&self, cubes: &[Cell]) -> String {
        let wide = self.wide;
        let block = |full: &[Cell]| -> String {
            let empty = |c: &Cell| self.tunnel.contains(c) && !full.contains(c);
            let at = |k: usize| (k % wide, k / wide % wide, k / wide / wide);
            let cell = |k| matches!(at(k), (x, y, 1) if empty(&(x, y)));
            (0..3 * wide * wide).map(|k| if cell(k) { '_' } else { '#' }).collect()
        };
        let mut placed = String::from("0 0 0 0");
        for (x, y) in cubes {
            let _ = write!(placed, " {x} {y} 1 0");
        }
        let side = format!("x=\"{wide}\" y=\"{wide}\" z=\"3\" type=\"0\"");
        format!(
            "<puzzle version=\"2\"><gridType type=\"0\"/><colors/><shapes><voxel {side}>{}</voxel>\
             <voxel x=\"1\" y=\"1\" z=\"1\" type=\"0\">#</voxel><voxel {side}>{}</voxel></shapes><problems><problem>\
             <shapes><shape id=\"0\" count=\"1\"/><shape id=\"1\" count=\"{}\"/></shapes><result id=\"2\"/><bitmap/>\
             <solutions><solution asmNum=\"0\"><assembly>{placed}</assembly></solution></solutions></problem></problems>\
             </puzzle>",
            block(&[]),
            block(cubes),
            cubes.len(),
        )
    }
}

#[test]
fn a_cube_leaves_a_maze_in_as_many_moves_as_its_way_has_stretches() {
    for (seed, n) in [(1, 3), (2, 8), (3, 10)] {
        let maze = Maze::grown(n, &mut Dice::new(seed));
        let moves = maze.moves();
        let (&far, &level) = moves.iter().max_by_key(|(_, m)| **m).expect("cells");
        let (code, plan) = planned(&maze.puzzle(&[far]), &format!("maze-{seed}"));
        println!("seed {seed}: level {level}, {} positions", plan["positions"]);
        assert_eq!(
            (code, plan["level"].as_str(), plan["fewest"].as_str()),
            (0, Some(&*level.to_string()), Some("proven"))
        );
        assert!(n < 10 || level > 30, "{level}: no high level was tried");
    }
}

#[test]
fn cubes_leave_a_maze_one_by_one() {
    let maze = Maze::grown(4, &mut Dice::new(4));
    let mut cells: Vec<(usize, Cell)> = maze.moves().into_iter().map(|(c, m)| (m, c)).collect();
    cells.sort_unstable();
    let cubes: Vec<Cell> = cells.iter().rev().take(3).map(|c| c.1).collect();
    let (_, plan) = planned(&maze.puzzle(&cubes), "maze-three");
    let level = plan["level"].as_str().expect("a level");
    let all: Vec<usize> = level.split('.').map(|m| m.parse().expect("digits")).collect();
    // The first to leave is the nearest; each is moved by itself, since no two lie side by side on all of their way.
    let first = cells[cells.len() - 3].0;
    assert_eq!((all.len(), all[0], plan["fewest"].as_str()), (3, first, Some("proven")), "{level}");
}
