//! Takes a file of figures (TOML); gives the numbers of molds and castings, each with range, source and grade, or every
//! fault of the file.
//!
//! Not promised: that a figure is right for the material at hand; the maker's sheet rules.

use crate::process::{Figure, Kind, ProcessError, figure};
use crate::toml_faults::Cursor;
use serde::Serialize;

macro_rules! figures {
    ($($(#[$doc:meta])* $name:ident: $unit:literal, $least:literal, $most:literal;)*) => {
        /// The numbers of molds and castings.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        pub struct Figures { $($(#[$doc])* pub $name: Figure,)* }

        const NAMES: &[&str] = &[$(stringify!($name)),*];

        fn read(top: &mut Cursor) -> Figures {
            let all = Figures { $($name: figure(top, stringify!($name), Kind { unit: $unit, least: $least, most: $most }),)* };
            top.refuse_others(&format!("figures of molds: {}", NAMES.join(", ")));
            all
        }
    };
}

figures! {
    /// Between the cavity and the outside of a printed mold.
    wall: "mm", 1.0, 100.0;
    /// Thinnest rib or fin that the printer of the mold makes.
    least_wall: "mm", 0.01, 20.0;
    /// Silicone around the master.
    silicone_wall: "mm", 3.0, 100.0;
    /// Least draft of a wall of a rigid mold.
    draft: "deg", 0.0, 30.0;
    /// Undercut that still snaps out of a rigid mold.
    snap: "mm", 0.0, 2.0;
    key_diameter: "mm", 2.0, 50.0;
    key_height: "mm", 1.0, 30.0;
    /// Between a key and its socket.
    key_clearance: "mm", 0.0, 2.0;
    /// At the outside of the mold, for resin and silicone.
    sprue: "mm", 1.0, 60.0;
    vent: "mm", 0.3, 10.0;
    /// How far a high point stands above the saddle to a higher one before it gets a vent.
    vent_prominence: "mm", 0.01, 20.0;
    /// One vent serves high points nearer than this.
    vent_spacing: "mm", 0.0, 100.0;
    /// Clearance hole of the screws.
    bolt: "mm", 1.0, 20.0;
    /// Of wax and metal.
    runner: "mm", 3.0, 100.0;
    /// Section of the gate, of the section where it attaches.
    feed_area: "%", 20.0, 300.0;
    /// By how much the modulus V/A must grow from pattern to gate to runner.
    modulus_step: "1", 1.0, 3.0;
    /// Investment between pattern and flask.
    flask_wall: "mm", 5.0, 100.0;
    /// Of the flask that the oven takes: patterns beyond it go on further trees.
    flask_height: "mm", 50.0, 2000.0;
    /// On 100 g of investment powder.
    water: "g", 20.0, 80.0;
    investment_density: "g/cm3", 1.0, 4.0;
    metal_density: "g/cm3", 0.5, 22.6;
    /// Melted beyond part and tree.
    metal_extra: "%", 0.0, 100.0;
    wax_density: "g/cm3", 0.5, 2.0;
    silicone_density: "g/cm3", 0.8, 3.0;
    /// Wax melts out.
    dewax: "C", 60.0, 400.0;
    dewax_time: "h", 0.1, 48.0;
    /// Residue burns off.
    burnout: "C", 300.0, 1100.0;
    burnout_time: "h", 0.1, 72.0;
    /// Of the flask when metal is poured.
    flask_heat: "C", 20.0, 900.0;
    metal_heat: "C", 200.0, 1800.0;
}

const EMBEDDED: &str = include_str!("../../processes/mold.toml");

impl Figures {
    /// The figures that come with the program.
    pub fn embedded() -> Result<Figures, ProcessError> {
        Figures::parse("mold.toml", EMBEDDED)
    }

    /// From the text of a file; `place` names it in faults.
    pub fn parse(place: &str, text: &str) -> Result<Figures, ProcessError> {
        let mut faults = Vec::new();
        let figures = Cursor::parse(text, &mut faults).map(|mut top| read(&mut top));
        faults.sort_by_key(|f| f.line);
        match figures {
            Some(figures) if faults.is_empty() => Ok(figures),
            _ => Err(ProcessError::Faulty { place: place.to_string(), faults }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_figures_are_sound() {
        let f = Figures::embedded().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((f.wall.value, f.snap.value), (6.0, 0.4));
    }

    #[test]
    fn all_faults_of_a_file_are_named_with_their_lines() {
        let bad = EMBEDDED.replace("value = 6.0", "value = -6.0").replace("[snap]", "[snip]");
        let said = Figures::parse("own.toml", &bad).unwrap_err().to_string();
        assert!(
            said.contains("-6") && said.contains("snip") && said.contains("\"snap\" is missing"),
            "{said}"
        );
    }
}
