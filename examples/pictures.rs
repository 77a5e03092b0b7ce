//! Takes nothing, draws the pictures of the README into `docs/` (or the folder named as first argument).

use std::error::Error;
use std::path::{Path, PathBuf};
use weavelock::assembly::{PartIx, woven};
use weavelock::locking::{Verdict, check};
use weavelock::report::draw::figures::{
    Figure, alone, exploded, forces, moving, plan_view, together, without,
};
use weavelock::report::draw::{Background, Colour, Image, Scene, Size, beside, render, write_png};
use weavelock::spec::{Bounds, Cut, HeldSpec, Layout, ProfileSpec, Shape, Spec, Subject, WovenSpec};
use weavelock::weave::Weave;
use weavelock::{contact, fault::Faults};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("docs"), PathBuf::from);
    let plain = swatch("plain", [1, 1, 1], 2, Cut::Window, 0)?;
    let twill = swatch("doubled twill", [2, 2, 1], 4, Cut::Tiles, 0)?;
    let satin = swatch("satin", [7, 1, 3], 8, Cut::Tiles, 0)?;
    let turning = swatch("twill, phase 1", [2, 2, 1], 4, Cut::Tiles, 1)?;

    let row = [together(&plain.assembly), without(&plain.assembly, PartIx(0)), exploded(&plain.assembly)];
    strip(&folder, "plain-2x2", &row, 420)?;
    for (name, a) in [("twill-221", &twill), ("satin-713", &satin)] {
        let last = PartIx(0);
        let row = [alone(&a.assembly, last), together(&a.assembly), without(&a.assembly, last)];
        strip(&folder, name, &row, 420)?;
    }
    one(&folder, "satin-713-above", &plan_view(&satin.assembly), 600, 600)?;
    let patches = contact::woven::patches(&plain);
    if let Verdict::Locked(stress) = check(&plain.assembly, &patches, None).rigid {
        one(&folder, "plain-2x2-forces", &forces(&plain.assembly, &stress), 600, 500)?;
    }
    let patches = contact::woven::patches(&turning);
    if let Verdict::Free(motion) = check(&turning.assembly, &patches, None).rigid {
        one(&folder, "twill-221-motion", &moving(&turning.assembly, &motion), 800, 560)?;
    }
    Ok(())
}

fn strip(folder: &Path, name: &str, figures: &[Figure], side: u32) -> Result<(), Box<dyn Error>> {
    let size = Size::new(side, side * 9 / 10)?;
    let row: Vec<Image> = figures.iter().map(|f| render(&on_paper(f), size)).collect();
    Ok(write_png(&beside(&row)?, &folder.join(format!("{name}.png")))?)
}

fn one(folder: &Path, name: &str, figure: &Figure, width: u32, height: u32) -> Result<(), Box<dyn Error>> {
    let image = render(&on_paper(figure), Size::new(width, height)?);
    Ok(write_png(&image, &folder.join(format!("{name}.png")))?)
}

/// White ground: a README is read on dark pages too, where dark lines would vanish.
fn on_paper(figure: &Figure) -> Scene {
    Scene { background: Background::Plain(Colour::srgb([255; 3])), ..figure.scene.clone() }
}

fn swatch(name: &str, [a, b, c]: [i32; 3], n: u32, cut: Cut, phase: i32) -> Result<woven::Woven, Faults> {
    let spec = WovenSpec {
        weave: Weave::abc(a as u32, b as u32, c)?,
        profile: ProfileSpec {
            shape: Shape::Rise(0.6),
            lift: 1.0,
            cover: 1.0,
            samples: 8,
            bounds: Bounds::Sandwich,
        },
        layout: Layout::Swatch { wefts: n, warps: n, cut, repeat: 1, phase },
        held: HeldSpec::None,
        pitch_mm: 20.0,
    };
    let whole = Spec {
        name: name.into(),
        subject: Subject::Woven(spec.clone()),
        fab: None,
        file: name.into(),
        places: Default::default(),
    };
    woven::build(&whole, &spec)
}
