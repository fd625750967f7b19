//! Pictures: a sheet of panels, written as PNG and SVG. The font is embedded, so a bare machine draws the same.

mod axes;
mod body;
mod canvas;
mod colours;
mod curves;
mod map;
mod notes;
mod shape;

pub use axes::Axis;
pub use body::BodyView;
pub use colours::{BLACK, BLUE, BROWN, Colour, GREEN, GREY, ORANGE, PURPLE, RED, SKY, sequential};
pub use curves::{Curves, Mark, Series};
pub use map::{Cell, Map};
pub use notes::Notes;
pub use shape::{Place, Shape};

use crate::failure::Failure;
use canvas::{Canvas, Frame};
use plotters::prelude::*;
use std::collections::HashMap;
use std::path::Path;

/// Pixels of the bitmap that are averaged to one, along each axis.
const SUPERSAMPLING: u32 = 3;
/// Coordinates are whole numbers in an SVG: finer than one unit of the sheet by this.
const SVG_FINENESS: u32 = 8;
/// Height of the title of a sheet.
const TITLE: f64 = 46.0;
/// Gap around and between panels.
const GAP: f64 = 14.0;

/// One picture of a sheet.
pub enum Panel {
    Curves(Curves),
    Map(Map),
    Body(BodyView),
    Notes(Notes),
}

/// Rows of panels under a title; sizes in units of the sheet, one unit being one pixel of the PNG.
pub struct Sheet {
    pub title: String,
    pub width: u32,
    pub height: u32,
    /// Rows with their share of the height.
    pub rows: Vec<(f64, Vec<Panel>)>,
}

impl Sheet {
    /// Writes `stem.png` and `stem.svg` into `folder`.
    pub fn save(&self, folder: &Path, stem: &str) -> Result<(), Failure> {
        self.save_png(&folder.join(format!("{stem}.png")))?;
        let path = folder.join(format!("{stem}.svg"));
        let failed = Failure::writing(&path);
        let text = self.svg().map_err(|why| failed(&why))?;
        std::fs::write(&path, text).map_err(|e| failed(&e))
    }

    fn save_png(&self, path: &Path) -> Result<(), Failure> {
        let failed = Failure::writing(path);
        let pixels = self.bitmap().map_err(|why| failed(&why))?;
        let (palette, indices) = indexed(&pixels);
        let file = std::fs::File::create(path).map_err(|e| failed(&e))?;
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), self.width, self.height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::NoFilter);
        let mut writer = encoder.write_header().map_err(|e| failed(&e))?;
        writer.write_image_data(&indices).map_err(|e| failed(&e))?;
        writer.finish().map_err(|e| failed(&e))
    }

    /// Pixels, red green blue and opacity, row by row.
    fn bitmap(&self) -> Result<Vec<u8>, String> {
        let fine = (self.width * SUPERSAMPLING, self.height * SUPERSAMPLING);
        let mut buffer = vec![255; 3 * (fine.0 * fine.1) as usize];
        {
            let area = BitMapBackend::with_buffer(&mut buffer, fine).into_drawing_area();
            self.draw(&area, f64::from(SUPERSAMPLING))?;
            area.present().map_err(|e| e.to_string())?;
        }
        let (n, row) = (SUPERSAMPLING as usize, 3 * fine.0 as usize);
        let mut pixels = Vec::with_capacity(4 * (self.width * self.height) as usize);
        for y in 0..self.height as usize {
            for x in 0..self.width as usize {
                for channel in 0..3 {
                    let sum: u32 = (0..n * n)
                        .map(|i| {
                            u32::from(buffer[(y * n + i / n) * row + 3 * (x * n + i % n) + channel])
                        })
                        .sum();
                    pixels.push((sum / (n * n) as u32) as u8);
                }
                pixels.push(u8::MAX);
            }
        }
        Ok(pixels)
    }

    fn svg(&self) -> Result<String, String> {
        let fine = (self.width * SVG_FINENESS, self.height * SVG_FINENESS);
        let mut text = String::new();
        {
            let area = SVGBackend::with_string(&mut text, fine).into_drawing_area();
            area.fill(&WHITE).map_err(|e| e.to_string())?;
            self.draw(&area, f64::from(SVG_FINENESS))?;
            area.present().map_err(|e| e.to_string())?;
        }
        let size = |(w, h): (u32, u32)| format!("width=\"{w}\" height=\"{h}\"");
        Ok(text.replacen(&size(fine), &size((self.width, self.height)), 1))
    }

    fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, plotters::coord::Shift>,
        scale: f64,
    ) -> Result<(), String> {
        let canvas = Canvas::new(area, scale)?;
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        canvas.title(&self.title, 0.5 * width, GAP + 0.5 * (TITLE - GAP))?;
        let shares: f64 = self.rows.iter().map(|(share, _)| share).sum();
        let free = height - TITLE - GAP * self.rows.len() as f64;
        let mut top = TITLE;
        for (share, panels) in &self.rows {
            let panel_height = free * share / shares;
            let panel_width = (width - GAP * (panels.len() + 1) as f64) / panels.len() as f64;
            for (i, panel) in panels.iter().enumerate() {
                let left = GAP + i as f64 * (panel_width + GAP);
                let frame = Frame {
                    left,
                    top,
                    right: left + panel_width,
                    bottom: top + panel_height,
                };
                match panel {
                    Panel::Curves(curves) => curves.draw(&canvas, frame)?,
                    Panel::Map(map) => map.draw(&canvas, frame)?,
                    Panel::Body(body) => body.draw(&canvas, frame)?,
                    Panel::Notes(notes) => notes.draw(&canvas, frame)?,
                }
            }
            top += panel_height + GAP;
        }
        Ok(())
    }
}

/// The 256 colours that serve a picture best, and the colour of every pixel: a third of the size of full colour.
fn indexed(pixels: &[u8]) -> (Vec<u8>, Vec<u8>) {
    const COLOURS: usize = 256;
    /// Brighter than this is meant to be white.
    const NEARLY_WHITE: u8 = 250;
    let quantizer = color_quant::NeuQuant::new(5, COLOURS, pixels);
    let mut palette = quantizer.color_map_rgb();
    for colour in palette.chunks_exact_mut(3) {
        if colour.iter().all(|channel| *channel >= NEARLY_WHITE) {
            colour.fill(u8::MAX);
        }
    }
    let mut known = HashMap::new();
    let indices = pixels
        .chunks_exact(4)
        .map(|pixel| {
            let key = [pixel[0], pixel[1], pixel[2]];
            *known
                .entry(key)
                .or_insert_with(|| quantizer.index_of(pixel) as u8)
        })
        .collect();
    (palette, indices)
}
