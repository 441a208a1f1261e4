//! Writes a glass of water by its interfaces as OBJ: one surface between each
//! pair of media, each with the normal to the medium that its name says it
//! goes to. No two share a place but the circle of the water line.
//!
//! `cargo run --example interfaces > scenes/meshes/interfaces.obj`

use std::{
    f64::consts::TAU,
    io::{self, Write},
};

/// Vertices of a ring.
const AROUND: usize = 96;
/// Outer and inner radius of the glass, in metres.
const OUTER: f64 = 0.4;
const INNER: f64 = 0.34;
/// Heights of its foot, of its inner floor, of the water and of the rim.
const FOOT: f64 = 0.02;
const FLOOR: f64 = 0.1;
const WATER: f64 = 0.5;
const RIM: f64 = 0.8;

/// A line of points (radius, height) that is turned about the axis; normals
/// point to its right, seen with the axis upright to the left.
type Profile<'a> = &'a [[f64; 2]];

const INTERFACES: [(&str, Profile); 3] = [
    (
        "glass to air",
        &[
            [0.0, FOOT],
            [OUTER, FOOT],
            [OUTER, RIM],
            [INNER, RIM],
            [INNER, WATER],
        ],
    ),
    (
        "glass to water",
        &[[INNER, WATER], [INNER, FLOOR], [0.0, FLOOR]],
    ),
    ("water to air", &[[INNER, WATER], [0.0, WATER]]),
];

fn main() -> io::Result<()> {
    let mut out = io::stdout().lock();
    let mut written = 0;
    for (name, profile) in INTERFACES {
        writeln!(out, "usemtl {name}")?;
        let mut below: Option<Vec<usize>> = None;
        for &[radius, height] in profile {
            let count = if radius == 0.0 { 1 } else { AROUND };
            for i in 0..count {
                let (s, c) = (TAU * i as f64 / AROUND as f64).sin_cos();
                writeln!(out, "v {} {} {height}", radius * c, radius * s)?;
            }
            // Numbers of a ring's vertices, all the same on the axis.
            let ring: Vec<usize> = (0..AROUND).map(|i| written + 1 + i % count).collect();
            written += count;
            if let Some(low) = &below {
                for i in 0..AROUND {
                    let j = (i + 1) % AROUND;
                    let quad = [low[i], low[j], ring[j], ring[i]];
                    write!(out, "f")?;
                    for (k, corner) in quad.iter().enumerate() {
                        if k == 0 || quad[k - 1] != *corner {
                            write!(out, " {corner}")?;
                        }
                    }
                    writeln!(out)?;
                }
            }
            below = Some(ring);
        }
    }
    Ok(())
}
