//! Takes one mesh with a class for each facet; gives an exhibit in which every class is a piece of its own, so that a map
//! over facets is coloured, named, chosen and listed like parts.
//!
//! Not promised: pieces that are closed; they are shares of one surface.

use super::colours::{Rgb, Scheme};
use super::exhibit::{self, Exhibit, ShownPlan, ShownSigns, Thing};
use super::{pack, signs};
use crate::report::draw::mesh::{Edge, EdgeKind};
use crate::report::draw::{Mesh, glyph, palette};
use crate::solid::Solid;
use glam::{DAffine3, DVec3};

/// A surface in classes, with what is said of it.
pub struct Classed {
    pub name: String,
    /// In a sentence, where other exhibits tell of their plan.
    pub says: String,
    /// mm.
    pub mesh: Mesh,
    /// For each facet of the mesh its class, an index into `ids`.
    pub class_of: Vec<usize>,
    /// What each class is called; none is without facets.
    pub ids: Vec<String>,
    /// Ways to colour the classes.
    pub schemes: Vec<Scheme>,
    /// Directions to be drawn as arrows from the middle outward, with what they are.
    pub ways: Vec<DVec3>,
    pub ways_say: String,
    /// What lies inside and is seen when the surface is faint.
    pub buried: Option<Buried>,
}

/// Solids inside the surface, with what is said of them; mm.
pub struct Buried {
    pub name: &'static str,
    pub says: String,
    pub colour: Rgb,
    pub meshes: Vec<Mesh>,
}

/// The exhibit of a surface in classes; lengths in mm.
pub fn of_classes(c: Classed) -> Exhibit {
    let meshes = shares(&c.mesh, &c.class_of, c.ids.len());
    let thing = |(k, id): (usize, String)| Thing { id, mesh: k, pose: DAffine3::IDENTITY };
    let things: Vec<Thing> = c.ids.into_iter().enumerate().map(thing).collect();
    let mut made = exhibit::placed(c.name, 1.0, &meshes, &things);
    made.schemes = c.schemes;
    made.plans = vec![ShownPlan { name: "None".into(), says: c.says, steps: vec![] }];
    made.signs = arrows(&c.ways, c.ways_say, made.radius).into_iter().collect();
    made.signs.extend(c.buried.iter().flat_map(|b| seen_inside(b, made.middle)));
    made
}

fn seen_inside(b: &Buried, middle: DVec3) -> impl Iterator<Item = ShownSigns> + '_ {
    b.meshes.iter().map(move |mesh| {
        let mut mesh = mesh.clone();
        mesh.vertices.iter_mut().for_each(|v| *v -= middle);
        let shape = pack::shape(&mesh);
        ShownSigns { name: b.name, says: b.says.clone(), colour: b.colour, shape, inside: true }
    })
}

/// For each class the mesh that keeps only its facets, with its outline as creases.
pub fn shares(mesh: &Mesh, class_of: &[usize], count: usize) -> Vec<Mesh> {
    let class = |facet: u32| class_of.get(facet as usize).copied();
    let edge = |e: &Edge, k: usize| {
        let here = e.facets.map(|f| class(f) == Some(k));
        let kind = if here == [true, true] { e.kind } else { EdgeKind::Crease };
        let inside = if here[0] { e.facets[0] } else { e.facets[1] };
        let facets = if here == [true, true] { e.facets } else { [inside; 2] };
        (here[0] || here[1]).then_some(Edge { facets, kind, ..*e })
    };
    let share = |k: usize| {
        let mut share = mesh.clone();
        share.triangles.retain(|t| class(t.facet) == Some(k));
        share.edges = mesh.edges.iter().filter_map(|e| edge(e, k)).collect();
        share
    };
    (0..count).map(share).collect()
}

/// Arrows that start where the ball about the surface ends, this share of its radius long and thick.
const ARROW: f64 = 0.5;
const SHAFT: f64 = 0.03;

fn arrows(ways: &[DVec3], says: String, radius: f64) -> Option<ShownSigns> {
    let of = |way: &DVec3| {
        let way = way.try_normalize()? * radius;
        glyph::arrow(way, way * (1.0 + ARROW), SHAFT * radius)
    };
    let solids: Vec<Solid> = ways.iter().filter_map(of).collect();
    (!solids.is_empty()).then(|| ShownSigns {
        name: "Pull directions",
        says,
        colour: palette::MOTION,
        shape: pack::shape(&signs::joined(&solids)),
        inside: false,
    })
}
