//! Takes solids with colours and a view, gives a picture: shaded, with outlines and creases, the same bytes every time.
//!
//! Not promised: exact hidden lines (visibility is decided per sample, nine to a pixel), the right order of ghosts that
//! pass through each other, or anything about meshes that are not closed: faces seen from behind are not drawn.
//!
//! ```text
//! solid -> mesh -> scene -> camera -> layers (which facet does each sample see) -> light -> ink -> image
//! ```

pub mod arcs;
pub mod camera;
pub mod figures;
pub mod glyph;
mod hidden;
pub mod image;
mod ink;
mod layer;
mod light;
pub mod mesh;
mod paint;
pub mod palette;
pub mod scene;
pub mod sheet;
pub mod sphere;
pub mod steps;
mod strokes;
pub mod vector;

pub use camera::{Projection, View};
pub use image::{Image, Size, beside, write_png};
pub use mesh::Mesh;
pub use paint::{Pen, render, render_with};
pub use palette::Colour;
pub use scene::{Background, Item, Opacity, Scene, Shadow};
