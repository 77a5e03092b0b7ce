//! Takes a woven assembly; gives its contact patches, known by identity of sites, none searched.
//!
//! Complete and exact: a facet between sites of two parts is a patch, the same polygon for both. In the order of the
//! lower part and its facets.

use super::Patch;
use crate::assembly::woven::Woven;

pub fn patches(woven: &Woven) -> Vec<Patch> {
    let assembly = &woven.assembly;
    let mut patches = Vec::new();
    for a in assembly.ids() {
        let (solid, pose) = (assembly.solid(a), assembly.part(a).pose);
        for (facet, faced) in solid.facets.iter().zip(woven.faced(a)) {
            let Some(b) = faced.filter(|&b| a < b) else { continue };
            let corner = |&k: &u32| pose.transform_point3(solid.vertices[k as usize]);
            patches.push(Patch {
                a,
                b,
                normal: facet.normal,
                corners: facet.corners.iter().map(corner).collect(),
            });
        }
    }
    patches
}
