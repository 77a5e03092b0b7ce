//! Takes meshes in mm with names and places; gives a 3MF package by the core specification, and reads back what it wrote.
//!
//! Promised: unit millimetre, z up, items in the positive octant where the caller puts them there, no vertex twice in an
//! object, only metadata that the specification knows, the same bytes for the same model. Not promised: colours, units
//! or components of others; it reads only what is written here.

use crate::mesh::Mesh;
use glam::DVec3;
use quick_xml::Reader;
use quick_xml::escape::escape;
use quick_xml::events::{BytesStart, Event};
use std::fmt::Write as _;
use std::io::{self, Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// A mesh with its name; its vertices are to be f32 already, each once.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    pub name: String,
    pub mesh: Mesh,
}

/// What stands on the bed.
#[derive(Clone, Debug, PartialEq)]
pub enum Build {
    /// Separate things, each an object (by index), shifted, with the id of a part.
    Items(Vec<(usize, DVec3, String)>),
    /// One thing with all objects as components, shifted as a whole.
    Whole(DVec3),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    pub title: String,
    pub description: String,
    pub objects: Vec<Object>,
    pub build: Build,
}

const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

const MODEL: &str = "3D/3dmodel.model";

/// The package's bytes.
pub fn write(model: &Model) -> io::Result<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // The first date that a zip can hold: the same bytes today and tomorrow.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    for (name, text) in
        [("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONS), (MODEL, &xml(model))]
    {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

fn xml(model: &Model) -> String {
    let mut x = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" xmlns=\"{CORE}\">\n"
    );
    let application = format!("weavelock {}", env!("CARGO_PKG_VERSION"));
    for (name, value) in
        [("Title", &model.title), ("Description", &model.description), ("Application", &application)]
    {
        let _ = writeln!(x, "<metadata name=\"{name}\">{}</metadata>", clean(value));
    }
    x += "<resources>\n";
    for (k, object) in model.objects.iter().enumerate() {
        mesh(&mut x, k + 1, object);
    }
    build(&mut x, model);
    x += "</model>\n";
    x
}

/// Escaped, and without the control characters that XML can not hold.
fn clean(text: &str) -> String {
    let kept: String = text.chars().filter(|c| !c.is_control()).collect();
    escape(kept.as_str()).into_owned()
}

fn mesh(x: &mut String, id: usize, object: &Object) {
    let _ =
        writeln!(x, "<object id=\"{id}\" type=\"model\" name=\"{}\"><mesh><vertices>", clean(&object.name));
    for v in &object.mesh.vertices {
        let [a, b, c] = v.as_vec3().to_array();
        let _ = writeln!(x, "<vertex x=\"{a}\" y=\"{b}\" z=\"{c}\"/>");
    }
    *x += "</vertices><triangles>\n";
    for [a, b, c] in &object.mesh.triangles {
        let _ = writeln!(x, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    *x += "</triangles></mesh></object>\n";
}

fn build(x: &mut String, model: &Model) {
    let shift = |s: &DVec3| {
        let [a, b, c] = s.as_vec3().to_array();
        format!("1 0 0 0 1 0 0 0 1 {a} {b} {c}")
    };
    match &model.build {
        Build::Items(items) => {
            *x += "</resources>\n<build>\n";
            for (object, at, part) in items {
                let (id, at, part) = (object + 1, shift(at), clean(part));
                let _ = writeln!(x, "<item objectid=\"{id}\" transform=\"{at}\" partnumber=\"{part}\"/>");
            }
        }
        Build::Whole(at) => {
            let whole = model.objects.len() + 1;
            let _ = writeln!(
                x,
                "<object id=\"{whole}\" type=\"model\" name=\"{}\"><components>",
                clean(&model.title)
            );
            for k in 1..whole {
                let _ = writeln!(x, "<component objectid=\"{k}\"/>");
            }
            let _ = writeln!(
                x,
                "</components></object>\n</resources>\n<build>\n<item objectid=\"{whole}\" transform=\"{}\"/>",
                shift(at)
            );
        }
    }
    *x += "</build>\n";
}

/// The meshes of a package that was written above, in order; anything else is an error of kind `InvalidData`.
pub fn read(bytes: &[u8]) -> io::Result<Vec<Mesh>> {
    let mut text = String::new();
    ZipArchive::new(Cursor::new(bytes))?.by_name(MODEL)?.read_to_string(&mut text)?;
    let mut reader = Reader::from_str(&text);
    let mut meshes: Vec<Mesh> = Vec::new();
    loop {
        match reader.read_event().map_err(|e| bad(&e.to_string()))? {
            Event::Start(e) if e.local_name().as_ref() == "mesh" => meshes.push(Mesh::default()),
            Event::Empty(e) => element(&e, meshes.last_mut())?,
            Event::Eof => return Ok(meshes),
            _ => {}
        }
    }
}

fn element(e: &BytesStart, mesh: Option<&mut Mesh>) -> io::Result<()> {
    let Some(mesh) = mesh else { return Ok(()) };
    match e.local_name().as_ref() {
        "vertex" => mesh.vertices.push(DVec3::from_array(numbers::<f32>(e, ["x", "y", "z"])?.map(f64::from))),
        "triangle" => mesh.triangles.push(numbers(e, ["v1", "v2", "v3"])?),
        _ => {}
    }
    Ok(())
}

fn numbers<T: std::str::FromStr + Copy + Default>(e: &BytesStart, names: [&str; 3]) -> io::Result<[T; 3]> {
    let mut all = [T::default(); 3];
    for (slot, name) in all.iter_mut().zip(names) {
        let value = e.attributes().flatten().find(|a| a.key.local_name().as_ref() == name);
        let parsed = value.and_then(|a| a.value.parse().ok());
        *slot = parsed.ok_or_else(|| bad(&format!("{name} is missing or no number")))?;
    }
    Ok(all)
}

fn bad(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;

    #[test]
    fn what_is_written_is_read_back_and_is_the_same_bytes_again() {
        let object = |n: &str, a: f64| Object { name: n.into(), mesh: cuboid(DVec3::ZERO, DVec3::splat(a)) };
        let items = vec![(0, DVec3::ZERO, "a<b".to_string()), (1, DVec3::X * 9.0, "\u{7}b\"".into())];
        let model = Model {
            title: "two & two".into(),
            description: String::new(),
            objects: vec![object("a<b", 1.5), object("b\"", 0.1_f32.into())],
            build: Build::Items(items),
        };
        let bytes = write(&model).unwrap();
        assert_eq!(bytes, write(&model).unwrap());
        let meshes: Vec<Mesh> = model.objects.into_iter().map(|o| o.mesh).collect();
        assert_eq!(read(&bytes).unwrap(), meshes);
    }
}
