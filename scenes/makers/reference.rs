//! Makes a reference picture of a long render, for `nephroid bench`: without
//! layers, every value rounded to eleven binary digits, so that the file's
//! compression makes it four times smaller. The rounding moves no value by
//! more than 0.025 %.
//!
//! ```sh
//! nephroid render scenes/cup.ron --seed 20011 --passes 2048 -o long.exr
//! cargo run --release --example reference long.exr scenes/references/cup.exr
//! ```

use std::{error::Error, path::PathBuf};

use nephroid::film::{Image, Window, read_exr, write_exr};

/// Digits that are kept of the 24 that the file has.
const DIGITS: u32 = 11;

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [from, to] = paths.as_slice() else {
        return Err("name a picture to read and one to write".into());
    };
    let long = read_exr(from, "")?;
    let (width, height) = (long.width(), long.height());
    let pixels = long.pixels().iter().map(|p| p.map(rounded)).collect();
    let image = Image::new(width, height, pixels);
    write_exr(to, &[("", &image)], Window::whole(width, height), &[])?;
    Ok(())
}

/// The nearest value with so few digits, up from the middle.
fn rounded(x: f64) -> f64 {
    let dropped = f32::MANTISSA_DIGITS - DIGITS;
    let bits = (x as f32).to_bits() + (1 << (dropped - 1));
    f64::from(f32::from_bits(bits >> dropped << dropped))
}
