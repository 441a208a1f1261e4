//! Writes a gem in the single cut as binary STL: table, eight crown facets, a
//! girdle of eight, eight pavilion facets that meet in a point. Facets `k`
//! look to the azimuth 45 `k` degrees.
//!
//! `cargo run --example gem > scenes/meshes/gem.stl`
//!
//! The proportions are those of M. Tolkowsky (*Diamond Design*, 1919): crown
//! angle 34.5 degrees, pavilion angle 40.75 degrees, table 53 % of the width.
//! The girdle, 4 % of the half-width high, stands on z = 0; half the width is
//! the unit.

use std::{
    f64::consts::PI,
    io::{self, Write},
};

const CROWN: f64 = 34.5;
const PAVILION: f64 = 40.75;
const TABLE: f64 = 0.53;
const GIRDLE: f64 = 0.04;

type Point = [f32; 3];

/// The corner after facet `k` of an octagon around the circle of a radius.
fn corner(k: u32, radius: f64, z: f64) -> Point {
    let angle = PI / 8.0 * f64::from(2 * (k % 8) + 1);
    let r = radius / (PI / 8.0).cos();
    [r * angle.cos(), r * angle.sin(), z].map(|x| x as f32)
}

fn facets() -> Vec<[Point; 3]> {
    let top = GIRDLE + (1.0 - TABLE) * CROWN.to_radians().tan();
    let culet = [0.0, 0.0, -PAVILION.to_radians().tan() as f32];
    let mut list = Vec::new();
    for k in 0..8 {
        let edge = |radius, z| [corner(k, radius, z), corner(k + 1, radius, z)];
        let ([a, b], [c, d], [e, f]) = (edge(1.0, 0.0), edge(1.0, GIRDLE), edge(TABLE, top));
        list.extend([[culet, b, a], [a, b, d], [a, d, c], [c, d, f], [c, f, e]]);
        if (1..7).contains(&k) {
            list.push([corner(0, TABLE, top), e, f]);
        }
    }
    list
}

fn main() -> io::Result<()> {
    let facets = facets();
    let mut bytes = b"single cut, half-width 1".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((facets.len() as u32).to_le_bytes());
    for facet in &facets {
        // A normal of zero leaves it to the reader to work it out.
        bytes.extend([0; 12]);
        bytes.extend(facet.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    io::stdout().write_all(&bytes)
}
