//! Takes the bytes of a 3MF package, gives the triangles of all its build items as one soup, in model units.
//!
//! Read are meshes, components and transforms, also from several model parts (production extension). Not
//! promised: beam lattices, booleans, displacements and slices are passed over; objects that are support are
//! left out.

use super::digits::Digits;
use super::faults::{Found, Place, found};
use super::soup::{Soup, finite};
use glam::{DAffine3, DVec3};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};

/// No model part is unpacked beyond this many bytes: some ten million triangles, and no bomb.
const MOST_BYTES: u64 = 1 << 30;

/// Components nest no deeper; a package in which they go round in a circle is refused by it.
const DEEPEST: usize = 32;

/// Objects are used no more often in one package: components that double at each level grow without bound.
const MOST_USES: usize = 100_000;

/// More triangles than this, over all uses, are refused.
const MOST_TRIANGLES: usize = 20_000_000;

const HINT: &str = "export the package again";

/// An object is known by the model part that it stands in and its number there.
type Key = (String, String);

#[derive(Default)]
struct Model {
    mm: f64,
    objects: BTreeMap<Key, Object>,
    items: Vec<Use>,
    /// Of all coordinates, in the package's own unit.
    digits: Digits,
    faults: Vec<Found>,
}

#[derive(Default)]
struct Object {
    support: bool,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    components: Vec<Use>,
}

struct Use {
    key: Key,
    pose: DAffine3,
}

pub(super) fn read(bytes: &[u8], mm_per_unit: f64) -> Result<Soup, Vec<Found>> {
    let parts =
        model_parts(bytes).map_err(|e| vec![found(Place::File, format!("no 3MF package: {e}"), HINT)])?;
    let mut model = Model { mm: 1.0, ..Model::default() };
    for (name, xml) in &parts {
        parse(name, xml, &mut model);
    }
    let scale = model.mm / mm_per_unit;
    let mut unpacking = Unpacking { objects: &model.objects, soup: Soup::default(), scale, uses: 0 };
    let bad: Vec<Found> = model.items.iter().filter_map(|i| unpacking.push(i, i.pose, 0).err()).collect();
    let mut soup = unpacking.soup;
    soup.resolution = model.digits.resolution() * scale;
    model.faults.extend(bad);
    if model.faults.is_empty() { Ok(soup) } else { Err(model.faults) }
}

/// The package's model parts by path, in order of path.
fn model_parts(bytes: &[u8]) -> Result<BTreeMap<String, String>, Box<dyn std::error::Error>> {
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes))?;
    let mut parts = BTreeMap::new();
    for k in 0..zip.len() {
        let file = zip.by_index(k)?;
        let name = file.name()?.trim_start_matches('/').to_owned();
        if name.ends_with(".model") {
            let mut xml = Vec::new();
            file.take(MOST_BYTES + 1).read_to_end(&mut xml)?;
            if xml.len() as u64 > MOST_BYTES {
                return Err(format!("{name} unpacks to more than {MOST_BYTES} bytes").into());
            }
            parts.insert(name, String::from_utf8(xml)?);
        }
    }
    if parts.is_empty() { Err("it holds no model".into()) } else { Ok(parts) }
}

fn parse(part: &str, xml: &str, model: &mut Model) {
    let mut reader = Reader::from_str(xml);
    let mut current: Option<Key> = None;
    loop {
        let at = reader.buffer_position() as usize;
        match reader.read_event() {
            Ok(Event::Start(e) | Event::Empty(e)) => {
                element(part, &Tag { e: &e, place: Place::Byte(at) }, &mut current, model)
                    .unwrap_or_else(|f| model.faults.push(f));
            }
            Ok(Event::Eof) => return,
            Ok(_) => {}
            Err(e) => return model.faults.push(found(Place::Byte(at), format!("{part}: {e}"), HINT)),
        }
    }
}

struct Tag<'a> {
    e: &'a BytesStart<'a>,
    place: Place,
}

impl Tag<'_> {
    /// The value of the attribute with this local name.
    fn get(&self, name: &str) -> Option<String> {
        let mut all = self.e.attributes().flatten();
        let hit = all.find(|a| a.key.local_name().as_ref() == name)?;
        Some(hit.value.into_owned())
    }

    fn need<T: std::str::FromStr>(&self, name: &str) -> Result<T, Found> {
        let parsed = self.get(name).and_then(|v| v.trim().parse().ok());
        parsed.ok_or_else(|| found(self.place, format!("no usable `{name}` here"), HINT))
    }
}

fn element(part: &str, tag: &Tag, current: &mut Option<Key>, model: &mut Model) -> Result<(), Found> {
    let object = current.as_ref().and_then(|k| model.objects.get_mut(k));
    match (tag.e.local_name().as_ref(), object) {
        ("model", _) => model.mm = unit(tag)?.unwrap_or(model.mm),
        ("object", _) => {
            let key = (part.to_owned(), tag.need("id")?);
            let support = tag.get("type").is_some_and(|t| t == "support" || t == "solidsupport");
            model.objects.insert(key.clone(), Object { support, ..Object::default() });
            *current = Some(key);
        }
        ("vertex", Some(o)) => {
            let numerals = ["x", "y", "z"].map(|n| tag.get(n).unwrap_or_default());
            numerals.iter().for_each(|s| model.digits.note(s));
            o.vertices.push(finite([tag.need("x")?, tag.need("y")?, tag.need("z")?], tag.place)?);
        }
        ("triangle", Some(o)) => o.triangles.push([tag.need("v1")?, tag.need("v2")?, tag.need("v3")?]),
        ("component", Some(o)) => o.components.push(used(part, tag)?),
        ("item", _) => model.items.push(used(part, tag)?),
        _ => {}
    }
    Ok(())
}

fn unit(tag: &Tag) -> Result<Option<f64>, Found> {
    Ok(match tag.get("unit").as_deref() {
        None => None,
        Some("micron") => Some(1e-3),
        Some("millimeter") => Some(1.0),
        Some("centimeter") => Some(10.0),
        Some("inch") => Some(25.4),
        Some("foot") => Some(304.8),
        Some("meter") => Some(1000.0),
        Some(u) => return Err(found(tag.place, format!("unit `{u}` is not one of 3MF's"), "use millimeter")),
    })
}

fn used(part: &str, tag: &Tag) -> Result<Use, Found> {
    let path = tag.get("path").map_or(part.to_owned(), |p| p.trim_start_matches('/').to_owned());
    let pose = match tag.get("transform") {
        None => DAffine3::IDENTITY,
        Some(t) => transform(&t).ok_or_else(|| found(tag.place, "transform without twelve numbers", HINT))?,
    };
    Ok(Use { key: (path, tag.need("objectid")?), pose })
}

/// 3MF writes row vectors: three rows of the linear part, then the translation.
fn transform(text: &str) -> Option<DAffine3> {
    let v: Vec<f64> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
    let finite = v.len() == 12 && v.iter().all(|x| x.is_finite());
    finite.then(|| DAffine3::from_cols_slice(&v))
}

struct Unpacking<'a> {
    objects: &'a BTreeMap<Key, Object>,
    soup: Soup,
    scale: f64,
    uses: usize,
}

impl Unpacking<'_> {
    /// Adds the object and what it is made of.
    fn push(&mut self, one: &Use, pose: DAffine3, depth: usize) -> Result<(), Found> {
        let fault =
            |what: &str| found(Place::File, format!("object {} of {} {what}", one.key.1, one.key.0), HINT);
        let object = self.objects.get(&one.key).ok_or_else(|| fault("is not there"))?;
        self.uses += 1;
        if depth > DEEPEST || self.uses > MOST_USES || self.soup.faces.len() > MOST_TRIANGLES {
            return Err(fault("is used in itself, too deep, or too often for memory"));
        }
        if object.support {
            return Ok(());
        }
        for (k, t) in object.triangles.iter().enumerate() {
            self.push_triangle(object, *t, pose, k)?;
        }
        object.components.iter().try_for_each(|c| self.push(c, pose * c.pose, depth + 1))
    }

    fn push_triangle(&mut self, object: &Object, t: [u32; 3], pose: DAffine3, k: usize) -> Result<(), Found> {
        let corner = |i: u32| object.vertices.get(i as usize).map(|&p| pose.transform_point3(p) * self.scale);
        let [Some(a), Some(b), Some(c)] = t.map(corner) else {
            let what = format!("triangle {t:?} of {} vertices", object.vertices.len());
            return Err(found(Place::Face(k), what, HINT));
        };
        // A mirror turns every face over; turned back, the solid stays outward.
        let mirrored = pose.matrix3.determinant() < 0.0;
        self.soup.push(&if mirrored { [a, c, b] } else { [a, b, c] }, Place::Face(k));
        Ok(())
    }
}
