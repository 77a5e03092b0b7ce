//! Takes parts in mm; gives a PLY file (binary, little-endian, f64, polygons, the number of its part on each face), and
//! reads back what it wrote.
//!
//! Not promised: a reader of every PLY; it reads the header that is written here.

use std::io;

/// Corners in mm, and faces with the number of their part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ply {
    pub parts: Vec<String>,
    pub vertices: Vec<[f64; 3]>,
    pub faces: Vec<(Vec<u32>, u32)>,
}

pub fn write(ply: &Ply) -> Vec<u8> {
    let mut out = String::from("ply\nformat binary_little_endian 1.0\ncomment unit: mm\n");
    for (k, id) in ply.parts.iter().enumerate() {
        out += &format!("comment part {k}: {}\n", id.replace(['\n', '\r'], " "));
    }
    out += &format!(
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
        ply.vertices.len()
    );
    out +=
        &format!("element face {}\nproperty list {} uint vertex_indices\n", ply.faces.len(), count_type(ply));
    out += "property uint part\nend_header\n";
    let mut bytes = out.into_bytes();
    bytes.extend(ply.vertices.iter().flatten().flat_map(|x| x.to_le_bytes()));
    let wide = count_type(ply) == "uint";
    for (corners, part) in &ply.faces {
        match wide {
            true => bytes.extend((corners.len() as u32).to_le_bytes()),
            false => bytes.push(corners.len() as u8),
        }
        bytes.extend(corners.iter().chain([part]).flat_map(|c| c.to_le_bytes()));
    }
    bytes
}

/// Most readers expect one byte for the count of a face's corners; a face with more needs four.
fn count_type(ply: &Ply) -> &'static str {
    if ply.faces.iter().all(|(c, _)| c.len() <= usize::from(u8::MAX)) { "uchar" } else { "uint" }
}

/// Reads a file of [`write()`].
pub fn read(bytes: &[u8]) -> io::Result<Ply> {
    let wrong = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what.to_string());
    let end = b"end_header\n";
    let at = bytes.windows(end.len()).position(|w| w == end).ok_or_else(|| wrong("no end of the header"))?;
    let head = std::str::from_utf8(&bytes[..at]).map_err(|_| wrong("a header that is no text"))?;
    let count = |name: &str| {
        let line = head.lines().find_map(|l| l.strip_prefix(name));
        line.and_then(|n| n.trim().parse::<usize>().ok()).ok_or_else(|| wrong("an element without a count"))
    };
    let wide = head.contains("property list uint uint");
    let mut rest = &bytes[at + end.len()..];
    let mut take = |n: usize| {
        let (head, tail) = rest.split_at_checked(n).ok_or_else(|| wrong("the file is cut off"))?;
        rest = tail;
        Ok::<_, io::Error>(head)
    };
    let mut ply = Ply { parts: names(head), ..Ply::default() };
    for _ in 0..count("element vertex ")? {
        let mut v = [0.0; 3];
        for x in &mut v {
            *x = f64::from_le_bytes(take(8)?.try_into().map_err(|_| wrong("a short number"))?);
        }
        ply.vertices.push(v);
    }
    let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    for _ in 0..count("element face ")? {
        let corners = if wide { word(take(4)?) as usize } else { usize::from(take(1)?[0]) };
        let list: Vec<u32> = take(4 * corners)?.chunks_exact(4).map(word).collect();
        ply.faces.push((list, word(take(4)?)));
    }
    Ok(ply)
}

fn names(head: &str) -> Vec<String> {
    let line = |l: &str| l.strip_prefix("comment part ")?.split_once(": ").map(|(_, id)| id.to_string());
    head.lines().filter_map(line).collect()
}
