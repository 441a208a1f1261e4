//! Draws the picture of `scenes/freeform.ron`: the nephroid, the curve after
//! which caustics in a cup are formed, and a letter that shows which way up
//! and which way round it is.
//!
//! `cargo run --example freeform_picture -- scenes/lenses/nephroid.png`

use std::{error::Error, f64::consts::TAU};

use image::{GrayImage, Luma};

/// Pixels along each side.
const SIDE: u32 = 256;

/// The picture: white lines on black.
pub(crate) fn picture() -> GrayImage {
    GrayImage::from_fn(SIDE, SIDE, |i, j| {
        // Units of the curve; the picture is 9.6 wide, y up.
        let unit = 9.6 / f64::from(SIDE);
        let x = (f64::from(i) + 0.5) * unit - 4.8;
        let y = 4.8 - (f64::from(j) + 0.5) * unit;
        let depth = (0.17 - to_nephroid(x, y)).max(0.2 - to_letter(x, y));
        // Edges one pixel soft.
        Luma([((depth / unit + 0.5).clamp(0.0, 1.0) * 255.0).round() as u8])
    })
}

/// Distance to the nephroid (3 cos t - cos 3t, 3 sin t - sin 3t).
fn to_nephroid(x: f64, y: f64) -> f64 {
    const STEPS: u32 = 720;
    let distance = |k: u32| {
        let t = f64::from(k) / f64::from(STEPS) * TAU;
        let (p, q) = (
            3.0 * t.cos() - (3.0 * t).cos(),
            3.0 * t.sin() - (3.0 * t).sin(),
        );
        (x - p).hypot(y - q)
    };
    (0..STEPS).map(distance).fold(f64::INFINITY, f64::min)
}

/// Distance to the strokes of an N and to the line below it.
fn to_letter(x: f64, y: f64) -> f64 {
    let strokes = [
        [-0.8, -0.9, -0.8, 1.3],
        [-0.8, 1.3, 0.8, -0.9],
        [0.8, -0.9, 0.8, 1.3],
        [-0.8, -1.7, 0.2, -1.7],
    ];
    let distance = |[ax, ay, bx, by]: [f64; 4]| {
        let (dx, dy) = (bx - ax, by - ay);
        let t = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy);
        let t = t.clamp(0.0, 1.0);
        (x - ax - t * dx).hypot(y - ay - t * dy)
    };
    strokes
        .into_iter()
        .map(distance)
        .fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1);
    picture().save(path.ok_or("the file to write is missing")?)?;
    Ok(())
}
