//! Takes made assemblies, writes them as a user's files: a spec and a mesh for each part, in any format, turned and
//! moved, with as many digits as asked.

use super::poly::Poly;
use glam::{DAffine3, DVec3};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

pub struct MadePart {
    pub id: String,
    pub poly: Poly,
    pub held: bool,
}

/// An assembly whose verdict follows from how it is made.
pub struct Made {
    pub name: String,
    pub parts: Vec<MadePart>,
    /// Words for translations and for rigid motions.
    pub want: [&'static str; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Format {
    /// Single precision.
    StlBinary,
    /// Single precision, as few digits as tell it.
    StlText,
    /// All digits of double precision.
    ObjFull,
    /// So many decimals.
    Obj(usize),
    /// So many significant digits, as C's `%g` and C++ streams write.
    ObjSignificant(usize),
    /// Six decimals.
    ThreeMf,
}

impl Format {
    fn end(self) -> &'static str {
        match self {
            Format::StlBinary | Format::StlText => "stl",
            Format::ObjFull | Format::Obj(_) | Format::ObjSignificant(_) => "obj",
            Format::ThreeMf => "3mf",
        }
    }

    fn bytes(self, poly: &Poly) -> Vec<u8> {
        match self {
            Format::StlBinary => stl_binary(poly),
            Format::StlText => stl_text(poly).into_bytes(),
            Format::ObjFull => obj(poly, |x| format!("{x}")),
            Format::Obj(d) => obj(poly, |x| format!("{x:.d$}")),
            Format::ObjSignificant(s) => obj(poly, |x| significant(x, s)),
            Format::ThreeMf => three_mf(poly),
        }
    }
}

/// The number with `digits` significant ones, without trailing zeros.
fn significant(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits - 1).parse().expect("a number");
    format!("{rounded}")
}

fn obj(poly: &Poly, number: impl Fn(f64) -> String) -> Vec<u8> {
    let mut s = String::new();
    for p in &poly.points {
        writeln!(s, "v {} {} {}", number(p.x), number(p.y), number(p.z)).expect("text");
    }
    for f in &poly.faces {
        let corners: Vec<String> = f.iter().map(|k| (k + 1).to_string()).collect();
        writeln!(s, "f {}", corners.join(" ")).expect("text");
    }
    s.into_bytes()
}

fn single(poly: &Poly) -> impl Iterator<Item = [[f32; 3]; 3]> + '_ {
    let at = |k: usize| poly.points[k].to_array().map(|x| x as f32);
    poly.triangles().into_iter().map(move |t| t.map(at))
}

fn stl_binary(poly: &Poly) -> Vec<u8> {
    let all: Vec<_> = single(poly).collect();
    let mut out = vec![0u8; 80];
    out.extend((all.len() as u32).to_le_bytes());
    for t in all {
        out.extend([0u8; 12]);
        t.iter().flatten().for_each(|x| out.extend(x.to_le_bytes()));
        out.extend([0u8; 2]);
    }
    out
}

fn stl_text(poly: &Poly) -> String {
    let mut s = String::from("solid part\n");
    for t in single(poly) {
        s += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in t {
            writeln!(s, "vertex {x:e} {y:e} {z:e}").expect("text");
        }
        s += "endloop\nendfacet\n";
    }
    s + "endsolid part\n"
}

fn three_mf(poly: &Poly) -> Vec<u8> {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?><model unit=\"millimeter\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" \
         type=\"model\"><mesh><vertices>",
    );
    for p in &poly.points {
        write!(xml, "<vertex x=\"{:.6}\" y=\"{:.6}\" z=\"{:.6}\"/>", p.x, p.y, p.z).expect("text");
    }
    xml += "</vertices><triangles>";
    for [a, b, c] in poly.triangles() {
        write!(xml, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>").expect("text");
    }
    xml += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let plain = zip::write::SimpleFileOptions::default();
    zip.start_file("3D/3dmodel.model", plain).expect("a file in the package");
    zip.write_all(xml.as_bytes()).expect("bytes");
    zip.finish().expect("a package").into_inner()
}

/// Where an assembly is put before it is written.
#[derive(Clone, Copy)]
pub struct Put {
    pub pose: DAffine3,
    pub format: Format,
    /// Decimals of the pose where it stands in the spec instead of in the meshes.
    pub in_spec: Option<usize>,
}

impl Put {
    pub fn turned(axis: [f64; 3], angle: f64, format: Format) -> Put {
        let pose = DAffine3::from_axis_angle(DVec3::from_array(axis).normalize(), angle);
        Put { pose, format, in_spec: None }
    }
}

fn rows(pose: &DAffine3, decimals: usize) -> String {
    let m = pose.matrix3.transpose();
    let row = |r: DVec3, t: f64| format!("{:.d$}, {:.d$}, {:.d$}, {:.d$}", r.x, r.y, r.z, t, d = decimals);
    [row(m.x_axis, pose.translation.x), row(m.y_axis, pose.translation.y), row(m.z_axis, pose.translation.z)]
        .join(", ")
}

/// Writes the assembly into the folder; gives the path of its spec.
pub fn write(made: &Made, put: Put, tolerance: &str, folder: &Path) -> PathBuf {
    std::fs::create_dir_all(folder).expect("a folder");
    let mut spec = format!("name = \"{}\"\n", made.name);
    for p in &made.parts {
        let file = format!("{}-{}.{}", made.name, p.id, put.format.end());
        let own = if put.in_spec.is_some() { DAffine3::IDENTITY } else { put.pose };
        let bytes = put.format.bytes(&p.poly.clone().moved(own));
        std::fs::write(folder.join(&file), bytes).expect("a mesh file");
        writeln!(spec, "[[part]]\nid = \"{}\"\nmesh = \"{file}\"\nheld = {}", p.id, p.held).expect("text");
        if let Some(decimals) = put.in_spec {
            writeln!(spec, "at = [{}]", rows(&put.pose, decimals)).expect("text");
        }
    }
    write!(spec, "[contact]\ntolerance = \"{tolerance}\"\n[size]\nunit = \"mm\"\n").expect("text");
    let path = folder.join(format!("{}.toml", made.name));
    std::fs::write(&path, spec).expect("a spec");
    path
}
