//! Takes a size or samples, gives an image and its PNG file.
//!
//! Promised: the same pixels give the same bytes. Not promised: the smallest file.

use crate::report::file::{WriteError, write_whole};
use std::io;
use std::path::Path;

/// Width and height in pixels, both in `1..=Size::LONGEST`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    width: u32,
    height: u32,
}

#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {width} x {height} pixels cannot be drawn: each side must be 1 to {}", Size::LONGEST)]
pub struct BadSize {
    pub width: u32,
    pub height: u32,
}

impl Size {
    /// A poster at 300 dots per inch; 8192 x 8192 pixels of 4 bytes are 256 MiB, which still fits in memory.
    pub const LONGEST: u32 = 8192;

    pub fn new(width: u32, height: u32) -> Result<Size, BadSize> {
        let fits = |s| (1..=Size::LONGEST).contains(&s);
        if fits(width) && fits(height) { Ok(Size { width, height }) } else { Err(BadSize { width, height }) }
    }

    pub fn width(self) -> u32 {
        self.width
    }

    pub fn height(self) -> u32 {
        self.height
    }
}

/// Rows from the top, four bytes to a pixel: sRGB and alpha, not premultiplied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    pub(super) size: Size,
    pub(super) rgba: Vec<u8>,
}

impl Image {
    pub fn size(&self) -> Size {
        self.size
    }

    /// Red, green, blue, alpha; `None` outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        let at = (y as usize * self.size.width as usize + x as usize) * 4;
        let inside = x < self.size.width && y < self.size.height;
        inside.then(|| [0, 1, 2, 3].map(|k| self.rgba[at + k]))
    }

    /// The PNG file's bytes; without an alpha channel where no pixel needs one.
    pub fn png(&self) -> Result<Vec<u8>, io::Error> {
        let opaque = self.rgba.chunks_exact(4).all(|p| p[3] == u8::MAX);
        let rgb = || self.rgba.chunks_exact(4).flat_map(|p| &p[..3]).copied().collect();
        let (color, data) =
            if opaque { (png::ColorType::Rgb, rgb()) } else { (png::ColorType::Rgba, self.rgba.clone()) };
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size.width, self.size.height);
        encoder.set_color(color);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&data)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// Pictures in a row, from left to right, on transparent ground where one is less high.
pub fn beside(pictures: &[Image]) -> Result<Image, BadSize> {
    let sizes = || pictures.iter().map(|p| p.size);
    let width = sizes().map(|s| s.width).fold(0, u32::saturating_add);
    let size = Size::new(width, sizes().map(|s| s.height).max().unwrap_or(0))?;
    let row = |p: &Image, y: usize| {
        let bytes = p.size.width as usize * 4;
        p.rgba.get(y * bytes..(y + 1) * bytes).map_or_else(|| vec![0; bytes], <[u8]>::to_vec)
    };
    let rgba = (0..size.height as usize).flat_map(|y| pictures.iter().flat_map(move |p| row(p, y))).collect();
    Ok(Image { size, rgba })
}

/// Writes the picture whole or not at all.
pub fn write_png(image: &Image, path: &Path) -> Result<(), WriteError> {
    let bytes = image.png().map_err(|source| WriteError { path: path.to_path_buf(), source })?;
    write_whole(path, &bytes)
}
