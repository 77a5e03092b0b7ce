//! Takes the solids around a part (the other cells of a tiling); gives the hollow that they leave, as an alternative
//! cavity: the direct mold by Voronoi complement (paper, 4.3).
//!
//! The hollow is cut off at the part's bounding box, where sandwiching planes have no cell behind them. Not promised:
//! that the solids close around the part; how far the hollow is off the part is measured, and too far is refused.

use crate::mesh::Mesh;
use crate::mold::frame;
use crate::mold::prepare::unfit;
use crate::mold::{Measured, MoldError};
use crate::solid::{Solid, cuboid};

/// A hollow that is off the part by more than this share of it is open somewhere, or of another part: clearances take
/// about a tenth.
const OPEN_SHARE: f64 = 0.25;

/// Solids that touch are given with round-off of their places; coordinates this near are one, mm, so that no crack of the
/// hollow runs between them. A hundredth of what any process makes.
const SAME: f64 = 1e-4;

/// What cells that fill space with a cavity share with it, against round-off of their places. Such cells leave just the
/// cavity, so that it need not be cut out of them; they only have to stand where they should.
pub fn shared(cavity: &Mesh, cells: &[Mesh]) -> Result<Measured, MoldError> {
    let around = cells.iter().map(Solid::of).collect::<Result<Vec<_>, _>>()?;
    let inside = Solid::all(around).common(&Solid::of(cavity)?).volume();
    Ok(Measured::at_most(
        "what the cells around the cavity share with it",
        inside,
        SAME * cavity.area(),
        "mm3",
        "round-off of their places: surface times 0.0001 mm",
    ))
}

pub fn hollow(part: &Mesh, surroundings: &[Mesh]) -> Result<(Mesh, Measured), MoldError> {
    let solid = Solid::of(part)?;
    let mut surroundings = surroundings.to_vec();
    frame::aligned(&mut surroundings, SAME);
    let around = surroundings.iter().map(Solid::of).collect::<Result<Vec<_>, _>>()?;
    let (lo, hi) = part.bounds();
    let left = Solid::of(&cuboid(lo, hi))?.minus(&Solid::all(around));
    let shared = |b: &Solid| b.common(&solid).volume();
    let bodies = left.bodies();
    let best = bodies.iter().max_by(|a, b| shared(a).total_cmp(&shared(b)));
    let Some(hollow) = best.filter(|b| shared(b) > 0.0) else {
        return Err(unfit(
            "the surroundings leave no hollow where the part is",
            "leave the part itself out of them",
        ));
    };
    let apart = hollow.minus(&solid).volume() + solid.minus(hollow).volume();
    let measure = Measured::at_most(
        "cavity of the surroundings against the part, by what only one of them has",
        apart / solid.volume() * 100.0,
        OPEN_SHARE * 100.0,
        "%",
        "clearances make up for about a tenth; more is an opening",
    );
    if !measure.kept {
        let what = format!(
            "the surroundings do not close around the part: their hollow is off it by {:.1} %",
            measure.value
        );
        return Err(unfit(what, "give all solids that touch the part"));
    }
    let settled = crate::files::stl::settled(hollow).map(|s| s.0);
    Ok((settled.unwrap_or_else(|| hollow.mesh()), measure))
}
