//! Takes a mesh in mm; gives Wavefront OBJ with shared vertices, and reads back what it wrote (`v` and `f` only).

use crate::mesh::Mesh;
use glam::DVec3;
use std::io::{self, Write};

pub fn write(mesh: &Mesh, name: &str, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "# unit: mm\no {name}")?;
    for v in &mesh.vertices {
        writeln!(out, "v {} {} {}", v.x, v.y, v.z)?;
    }
    for t in &mesh.triangles {
        writeln!(out, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1)?;
    }
    Ok(())
}

/// Reads triangles as written above; anything else is an error of kind `InvalidData`.
pub fn read(text: &str) -> io::Result<Mesh> {
    let mut mesh = Mesh::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z] => mesh.vertices.push(DVec3::from_array(numbers([x, y, z])?)),
            ["f", a, b, c] => mesh.triangles.push(numbers::<u32>([a, b, c])?.map(|v| v.saturating_sub(1))),
            ["f", ..] => {
                let what = "a face that is no triangle: it is read as triangles only";
                return Err(io::Error::new(io::ErrorKind::InvalidData, what));
            }
            _ => {}
        }
    }
    let known = mesh.vertices.len() as u32;
    if mesh.triangles.iter().flatten().any(|&v| v >= known) {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a face names a vertex that is not there"));
    }
    Ok(mesh)
}

fn numbers<T: std::str::FromStr + Copy + Default>(words: [&str; 3]) -> io::Result<[T; 3]> {
    let mut all = [T::default(); 3];
    for (slot, word) in all.iter_mut().zip(words) {
        let bad = |_| io::Error::new(io::ErrorKind::InvalidData, format!("\"{word}\" is not a number"));
        *slot = word.parse().map_err(bad)?;
    }
    Ok(all)
}
