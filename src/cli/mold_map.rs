//! Takes a mold; gives the map of draft and undercut over the part's facets: an exhibit, a picture from both ends, a table.
//!
//! Shown in the mold's frame, z along the pull. Not promised: more than the mold's own maps say; a facet counts as undercut
//! whole where any of it is, the hidden area itself is a number beside.

use super::pictured;
use crate::report::content::{Column, Picture, Table};
use crate::report::draw::figures::Figure;
use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::{Background, Colour, Item, Mesh, Scene, Size, View, palette};
use crate::report::viewer::facets::{Classed, of_classes, shares};
use crate::report::viewer::{Exhibit, Rgb, Scheme};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;
use weavelock_fab::mesh::area;
use weavelock_fab::mold::{Kind, Mold};

/// How a facet stands to the way in which its half or core leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    Undercut,
    /// Less than the draft that the figures ask for.
    Low,
    /// From there to [`AMPLE`] times as much.
    Enough,
    Ample,
}

/// Draft of this many times the figure is no more a matter of care (as in the map that a package's mold comes with).
const AMPLE: f64 = 5.0;

impl Grade {
    const ALL: [Grade; 4] = [Grade::Undercut, Grade::Low, Grade::Enough, Grade::Ample];

    fn of(draft_deg: f64, undercut_mm2: f64, least: f64) -> Grade {
        match draft_deg {
            _ if undercut_mm2 > 0.0 => Grade::Undercut,
            d if d < least => Grade::Low,
            d if d < AMPLE * least => Grade::Enough,
            _ => Grade::Ample,
        }
    }

    fn words(self, least: f64) -> String {
        match self {
            Grade::Undercut => "undercut".into(),
            Grade::Low => format!("draft under {least}°"),
            Grade::Enough => format!("draft {least}° to {}°", AMPLE * least),
            Grade::Ample => format!("draft over {}°", AMPLE * least),
        }
    }

    /// From a strong warm colour to a pale cool one: lightness alone orders them too.
    pub fn colour(self) -> Rgb {
        match self {
            Grade::Undercut => [148, 20, 84],
            Grade::Low => [225, 104, 24],
            Grade::Enough => [244, 206, 90],
            Grade::Ample => [166, 210, 236],
        }
    }
}

/// The colours of halves and cores; more take turns.
const FORMED: [Rgb; 8] = palette::OTHER;

/// What a page shows of a mold's map.
pub struct Map {
    pub exhibit: Exhibit,
    pub picture: Picture,
    pub table: Table,
}

/// Facets of one grade that one half or core forms.
struct Class<'a> {
    grade: Grade,
    half: &'a str,
    facets: usize,
    mm2: f64,
}

/// Classes in order, and the class of each facet.
fn sorted(mold: &Mold) -> (Vec<Class<'_>>, Vec<usize>) {
    let least = mold.figures.draft.value;
    let maps = &mold.maps;
    let of = |t: usize| {
        let grade = Grade::of(maps.draft_deg[t], maps.undercut_mm2[t], least);
        (grade, maps.half[t].as_str())
    };
    let mut sums: BTreeMap<(Grade, &str), (usize, f64)> = BTreeMap::new();
    for t in 0..maps.draft_deg.len() {
        let sum = sums.entry(of(t)).or_default();
        *sum = (sum.0 + 1, sum.1 + area(mold.part.corners(t)));
    }
    let place: BTreeMap<(Grade, &str), usize> = sums.keys().copied().zip(0..).collect();
    let class_of = (0..maps.draft_deg.len()).map(|t| place[&of(t)]).collect();
    let class = |((grade, half), (facets, mm2))| Class { grade, half, facets, mm2 };
    (sums.into_iter().map(class).collect(), class_of)
}

/// The map; `Err`: the picture could not be made.
pub fn map(mold: &Mold, id: &str) -> Result<Map, String> {
    let (classes, class_of) = sorted(mold);
    let mesh = Mesh::of(&pictured::solid(&mold.part), CreaseAngle::default());
    Ok(Map {
        picture: picture(mold, id, &mesh, &classes, &class_of)?,
        table: table(mold, id, &classes),
        exhibit: exhibit(mold, id, mesh, &classes, class_of),
    })
}

fn halves<'a>(classes: &[Class<'a>]) -> Vec<&'a str> {
    let mut all: Vec<&str> = classes.iter().map(|c| c.half).collect();
    all.sort_unstable();
    all.dedup();
    all
}

fn exhibit(mold: &Mold, id: &str, mesh: Mesh, classes: &[Class], class_of: Vec<usize>) -> Exhibit {
    let least = mold.figures.draft.value;
    let (halves, total) = (halves(classes), classes.iter().map(|c| c.mm2).sum::<f64>());
    let sum = |keep: &dyn Fn(&Class) -> bool| {
        let mm2 = classes.iter().filter(|c| keep(c)).fold(0.0, |sum, c| sum + c.mm2);
        format!("{mm2:.1} mm² ({:.1} %)", 100.0 * mm2 / total)
    };
    let graded = |g: &Grade| (g.colour(), format!("{}: {}", g.words(least), sum(&|c: &Class| c.grade == *g)));
    let colour_of = |half: &str| FORMED[halves.iter().position(|h| *h == half).unwrap_or(0) % FORMED.len()];
    let formed = |h: &&str| (colour_of(h), format!("{h}: {}", sum(&|c: &Class| c.half == *h)));
    let cores = mold.pieces.iter().filter(|p| p.kind == Kind::Core).map(|p| p.pull);
    of_classes(Classed {
        name: format!("draft and undercut of {id}"),
        says: format!(
            "{id} in the mold's frame, the pull upright; {:.2} mm² are undercut: no straight half reaches them.",
            mold.pull.undercut_mm2
        ),
        mesh,
        class_of,
        ids: classes.iter().map(|c| format!("{}, {}", c.grade.words(least), c.half)).collect(),
        schemes: vec![
            Scheme {
                name: "draft and undercut",
                legend: Grade::ALL.iter().map(graded).collect(),
                colours: classes.iter().map(|c| c.grade.colour()).collect(),
            },
            Scheme {
                name: "half or core that forms it",
                legend: halves.iter().map(formed).collect(),
                colours: classes.iter().map(|c| colour_of(c.half)).collect(),
            },
        ],
        ways: [DVec3::Z, DVec3::NEG_Z].into_iter().chain(cores).collect(),
        ways_say: "The ways in which halves and cores leave.".into(),
        buried: None,
    })
}

/// Pixels, as other figures of a page that stand in a text.
const PICTURE: (u32, u32) = (1000, 520);
/// Room between the two views, in the part's width.
const BESIDE: f64 = 1.25;

/// From above and, turned over, from below.
fn picture(
    mold: &Mold,
    id: &str,
    mesh: &Mesh,
    classes: &[Class],
    class_of: &[usize],
) -> Result<Picture, String> {
    let (lo, hi) = mold.part.bounds();
    let middle = (lo + hi) / 2.0;
    // What is shifted along the view's right hand stands beside.
    let (sin, cos) = View::default().azimuth.to_radians().sin_cos();
    let right = DVec3::new(-sin, cos, 0.0);
    let over = DAffine3::from_translation(middle + right * (hi - lo).truncate().length() * BESIDE)
        * DAffine3::from_rotation_x(std::f64::consts::PI)
        * DAffine3::from_translation(-middle);
    let pieces = shares(mesh, class_of, classes.len());
    let item = |(share, class): (Mesh, &Class)| {
        let above = Item::new(Arc::new(share), Colour::srgb(class.grade.colour()));
        [above.clone(), Item { pose: over, ..above }]
    };
    let items = pieces.into_iter().zip(classes).flat_map(item).collect();
    let size = Size::new(PICTURE.0, PICTURE.1).map_err(|e| e.to_string())?;
    let least = mold.figures.draft.value;
    let legend: Vec<String> = classes
        .iter()
        .map(|c| c.grade)
        .collect::<std::collections::BTreeSet<_>>()
        .iter()
        .map(|g| g.words(least))
        .collect();
    Figure {
        name: "draft",
        scene: Scene { items, view: View::default(), background: Background::Transparent },
        alt: format!("{id} coloured by draft and undercut, from above and turned over: {}.", legend.join(", ")),
        caption: format!("{id}, the pull upright, and turned over. Dark red: undercut; orange: draft under {least}°; yellow: up to {}°; blue: more.", AMPLE * least),
    }
    .picture(size)
    .map_err(|e| e.to_string())
}

fn table(mold: &Mold, id: &str, classes: &[Class]) -> Table {
    let least = mold.figures.draft.value;
    let total: f64 = classes.iter().map(|c| c.mm2).sum();
    let row = |c: &Class| {
        vec![
            c.grade.words(least),
            c.half.to_string(),
            c.facets.to_string(),
            format!("{:.2}", c.mm2),
            format!("{:.2}", 100.0 * c.mm2 / total),
        ]
    };
    let head = vec![
        Column::words("facets with"),
        Column::words("formed by"),
        Column::numbers("facets"),
        Column::numbers("mm²"),
        Column::numbers("% of the surface"),
    ];
    Table { caption: format!("Draft and undercut of {id}"), head, rows: classes.iter().map(row).collect() }
}
