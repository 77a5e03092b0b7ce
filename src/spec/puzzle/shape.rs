//! Takes a `voxel` element; gives the shape that it draws.
//!
//! Voxels stand in rows along x, then y, then z: `#` fixed, `+` variable, `_` empty, a colour's number behind it.
//! Not promised: that a shape hangs together.

use super::Reading;
use super::xml::Node;
use crate::fault::quoted;

/// Longest side of a shape, in voxels.
const MOST_SIDE: i64 = 500;

/// Most voxels of a shape, full or empty.
const MOST_VOXELS: usize = 1 << 22;

/// Largest number of a colour; BurrTools refuses more.
const MOST_COLOUR: u32 = 63;

/// Largest weight, either way: BurrTools keeps them in this range.
const MOST_WEIGHT: i64 = 100_000;

/// Farthest that a hot spot lies from its shape's corner, in voxels.
const FARTHEST: i64 = 10_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fill {
    Fixed,
    /// Of a result: may stay empty.
    Variable,
}

/// A voxel that is not empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Voxel {
    pub at: [i32; 3],
    pub fill: Fill,
    /// 0: none.
    pub colour: u32,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape {
    pub size: [i32; 3],
    /// In the order of the file: along x, then y, then z.
    pub voxels: Vec<Voxel>,
    /// The voxel that placements set down.
    pub hot: [i32; 3],
    pub name: String,
    pub weight: i32,
}

pub fn shape(reading: &mut Reading, node: &Node) -> Option<Shape> {
    let sides = ["x", "y", "z"].map(|k| reading.number(node, k, None, (0, MOST_SIDE)));
    let hot = ["hx", "hy", "hz"].map(|k| reading.number(node, k, Some(0), (-FARTHEST, FARTHEST)));
    let weight = reading.number(node, "weight", Some(1), (-MOST_WEIGHT, MOST_WEIGHT));
    let is_bricks = node.attribute("type").is_none_or(|t| t.trim() == "0");
    if !is_bricks {
        let kind = quoted(node.attribute("type").unwrap_or_default());
        reading.fault(
            node,
            "type",
            format!("is {kind}: not drawn with bricks"),
            "only bricks, type 0, are read",
        );
    }
    let [Some(x), Some(y), Some(z)] = sides else { return None };
    let size = [x as i32, y as i32, z as i32];
    let count = size.iter().map(|&s| s as usize).product::<usize>();
    if count > MOST_VOXELS {
        reading.fault(node, "x", format!("{x} x {y} x {z} voxels are too many"), "at most four million");
        return None;
    }
    let voxels =
        voxels(&node.text, size, count).map_err(|(what, hint)| reading.fault(node, "", what, hint)).ok();
    let [Some(hx), Some(hy), Some(hz)] = hot else { return None };
    is_bricks.then_some(())?;
    Some(Shape {
        size,
        voxels: voxels?,
        hot: [hx as i32, hy as i32, hz as i32],
        name: node.attribute("name").unwrap_or_default().trim().to_string(),
        weight: weight? as i32,
    })
}

fn voxels(text: &str, size: [i32; 3], count: usize) -> Result<Vec<Voxel>, (String, &'static str)> {
    let (mut voxels, mut seen): (Vec<Voxel>, usize) = (Vec::new(), 0);
    let mut coloured = false;
    for sign in text.chars().filter(|c| !c.is_ascii_whitespace()) {
        let fill = match sign {
            '#' => Some(Fill::Fixed),
            '+' => Some(Fill::Variable),
            '_' => None,
            '0'..='9' => {
                let digit = sign as u32 - '0' as u32;
                if let Some(last) = voxels.last_mut().filter(|_| coloured) {
                    last.colour = last.colour * 10 + digit;
                    if last.colour > MOST_COLOUR {
                        return Err((format!("colour {} is too large", last.colour), "colours go up to 63"));
                    }
                }
                continue;
            }
            _ => {
                return Err((
                    format!("{} is no voxel", quoted(&sign.to_string())),
                    "# + _ and colours' numbers",
                ));
            }
        };
        if seen == count {
            return Err((format!("more than {count} voxels are drawn"), "as many as x times y times z"));
        }
        let at = [seen as i32 % size[0], seen as i32 / size[0] % size[1], seen as i32 / size[0] / size[1]];
        coloured = fill.is_some();
        voxels.extend(fill.map(|fill| Voxel { at, fill, colour: 0 }));
        seen += 1;
    }
    if seen < count {
        return Err((format!("{seen} of {count} voxels are drawn"), "as many as x times y times z"));
    }
    Ok(voxels)
}
