//! Takes a puzzle as it was read; gives the text of a puzzle file that holds no more than it: its shapes, one problem, at
//! most one solution, and how large a voxel is.
//!
//! Promised: read again it is the same puzzle. Not promised: comments, names of colours, and solutions that were not
//! chosen; they are not there any more.

use super::{Fill, Pieces, Puzzle, Shape};
use std::fmt::Write;

/// The text; `unit_mm`: edge of a voxel in mm.
pub fn text(puzzle: &Puzzle, unit_mm: f64) -> String {
    let mut out =
        format!("<?xml version=\"1.0\"?>\n<?weavelock unit=\"{unit_mm} mm\"?>\n<puzzle version=\"2\">\n");
    let _ = writeln!(out, " <gridType type=\"0\"/>\n <colors>");
    (0..puzzle.colours).for_each(|_| out += "  <color/>\n");
    out += " </colors>\n <shapes>\n";
    puzzle.shapes.iter().for_each(|s| shape(&mut out, s));
    out += " </shapes>\n <problems>\n";
    problem(&mut out, puzzle);
    out += " </problems>\n</puzzle>\n";
    out
}

fn shape(out: &mut String, s: &Shape) {
    let _ = write!(out, "  <voxel x=\"{}\" y=\"{}\" z=\"{}\"", s.size[0], s.size[1], s.size[2]);
    for (key, value) in ["hx", "hy", "hz"].into_iter().zip(s.hot).filter(|(_, value)| *value != 0) {
        let _ = write!(out, " {key}=\"{value}\"");
    }
    let _ = write!(out, " weight=\"{}\" name=\"{}\" type=\"0\">", s.weight, escaped(&s.name));
    let mut full = s.voxels.iter().peekable();
    for k in 0..s.size.iter().product() {
        let at = [k % s.size[0], k / s.size[0] % s.size[1], k / s.size[0] / s.size[1]];
        match full.next_if(|v| v.at == at) {
            Some(v) => {
                out.push(if v.fill == Fill::Fixed { '#' } else { '+' });
                let _ = if v.colour > 0 { write!(out, "{}", v.colour) } else { Ok(()) };
            }
            None => out.push('_'),
        }
    }
    *out += "</voxel>\n";
}

fn problem(out: &mut String, puzzle: &Puzzle) {
    let p = &puzzle.problem;
    let _ = write!(out, "  <problem name=\"{}\"", escaped(&p.name));
    let _ = p.most_holes.map_or(Ok(()), |n| write!(out, " maxHoles=\"{n}\""));
    *out += ">\n   <shapes>\n";
    for Pieces { shape, least, most, groups } in &p.pieces {
        let _ = writeln!(out, "    <shape id=\"{shape}\" min=\"{least}\" max=\"{most}\">");
        for (group, count) in groups {
            let _ = writeln!(out, "     <group group=\"{group}\" count=\"{count}\"/>");
        }
        *out += "    </shape>\n";
    }
    let _ = writeln!(out, "   </shapes>\n   <result id=\"{}\"/>\n   <bitmap>", p.result);
    for (piece, result) in &p.allowed {
        let _ = writeln!(out, "    <pair piece=\"{}\" result=\"{}\"/>", piece - 1, result - 1);
    }
    *out += "   </bitmap>\n";
    if let Some(solution) = &puzzle.solution {
        let word = |p: &Option<super::Placement>| match p {
            Some(p) => format!("{} {} {} {}", p.at[0], p.at[1], p.at[2], p.turn),
            None => "x".to_string(),
        };
        let words: Vec<String> = solution.placements.iter().map(word).collect();
        let _ =
            writeln!(out, "   <solutions>\n    <solution>\n     <assembly>{}</assembly>", words.join(" "));
        *out += "    </solution>\n   </solutions>\n";
    }
    *out += "  </problem>\n";
}

fn escaped(text: &str) -> String {
    let clean: String = text.chars().filter(|c| !c.is_control()).collect();
    quick_xml::escape::escape(clean).into_owned()
}
