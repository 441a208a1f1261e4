//! Vertex normals made from the faces, up to a crease angle.

use glam::DVec3;
use rayon::prelude::*;

use super::weld::first_at_place;
use crate::{geometry::shape::triangle_normal, numeric::trig::acos};

/// A group that has no vertex yet.
const NONE: u32 = u32::MAX;

/// A mesh whose normals were made from its faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Creased {
    /// Positions; a place stands several times where creases meet.
    pub positions: Vec<DVec3>,
    /// One normal per position: of unit length, or zero where faces cancel.
    pub normals: Vec<DVec3>,
    /// The triangles, in their old order.
    pub triangles: Vec<[u32; 3]>,
}

/// Normals such that faces join smoothly across an edge if their normals
/// differ by no more than the angle with cosine `cos_crease`.
///
/// An edge that other than two triangles share, or whose triangles are wound
/// differently, is a crease. The faces around a vertex that hang together
/// across smooth edges have one normal there: the mean of theirs, weighted by
/// the angle they have at the vertex, so that it does not depend on how a
/// face is cut into triangles (G. Thürmer and C. Wüthrich, *Computing Vertex
/// Normals from Polygonal Facets*, Journal of Graphics Tools 3(1), 1998).
/// Vertices at the same place count as one. Every index must be valid.
pub fn creased(positions: &[DVec3], triangles: &[[u32; 3]], cos_crease: f64) -> Creased {
    let first = first_at_place(positions);
    let corners = |t: &[u32; 3]| t.map(|i| positions[i as usize]);
    let faces: Vec<Option<DVec3>> = triangles
        .par_iter()
        .map(|t| triangle_normal(&corners(t)))
        .collect();
    let groups = joined_corners(&first, triangles, &faces, cos_crease);
    let mut out = Creased {
        triangles: vec![[0; 3]; triangles.len()],
        ..Creased::default()
    };
    let mut names = vec![NONE; groups.len()];
    for (i, t) in triangles.iter().enumerate() {
        let weights = faces[i].map_or([0.0; 3], |_| corner_angles(&corners(t)));
        for k in 0..3 {
            let name = &mut names[groups[3 * i + k] as usize];
            if *name == NONE {
                *name = out.positions.len() as u32;
                out.positions.push(positions[t[k] as usize]);
                out.normals.push(DVec3::ZERO);
            }
            out.triangles[i][k] = *name;
            out.normals[*name as usize] += faces[i].unwrap_or(DVec3::ZERO) * weights[k];
        }
    }
    for n in &mut out.normals {
        *n = n.normalize_or_zero();
    }
    out
}

/// For each corner (three times the triangle, plus 0, 1 or 2) the first
/// corner of those it shares a normal with.
fn joined_corners(
    first: &[u32],
    triangles: &[[u32; 3]],
    faces: &[Option<DVec3>],
    cos_crease: f64,
) -> Vec<u32> {
    // An edge: its welded vertices, ordered; the corner at which it starts.
    let mut edges: Vec<(u32, u32, u32)> = triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(i, t)| {
            let w = t.map(|v| first[v as usize]);
            [0, 1, 2].map(|k| {
                let (a, b) = (w[k], w[(k + 1) % 3]);
                (a.min(b), a.max(b), (3 * i + k) as u32)
            })
        })
        .collect();
    edges.par_sort_unstable();
    let mut groups: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    for same in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let [(low, _, e), (_, _, f)] = *same else {
            continue;
        };
        let normal = |corner: u32| faces[corner as usize / 3];
        let start =
            |corner: u32| first[triangles[corner as usize / 3][corner as usize % 3] as usize];
        let opposed = (start(e) == low) != (start(f) == low);
        let is_smooth = match (normal(e), normal(f)) {
            (Some(n), Some(m)) => n.dot(m) >= cos_crease,
            _ => false,
        };
        if opposed && is_smooth {
            let next = |corner: u32| corner - corner % 3 + (corner % 3 + 1) % 3;
            // Where one runs from a to b, the other runs from b to a.
            join(&mut groups, e, next(f));
            join(&mut groups, next(e), f);
        }
    }
    for i in 0..groups.len() as u32 {
        groups[i as usize] = leader(&mut groups, i);
    }
    groups
}

/// The first corner of a group; the way there is halved for the next time.
fn leader(groups: &mut [u32], mut i: u32) -> u32 {
    while groups[i as usize] != i {
        let up = groups[groups[i as usize] as usize];
        groups[i as usize] = up;
        i = up;
    }
    i
}

fn join(groups: &mut [u32], a: u32, b: u32) {
    let (a, b) = (leader(groups, a), leader(groups, b));
    groups[a.max(b) as usize] = a.min(b);
}

/// The angles of a triangle of some area, in radians.
fn corner_angles([a, b, c]: &[DVec3; 3]) -> [f64; 3] {
    let largest = (*b - *a).abs().max((*c - *a).abs()).max_element();
    let [ab, bc, ca] = [
        (*b - *a) / largest,
        (*c - *b) / largest,
        (*a - *c) / largest,
    ]
    .map(DVec3::normalize_or_zero);
    let between = |u: DVec3, v: DVec3| acos((-u.dot(v)).clamp(-1.0, 1.0));
    [between(ca, ab), between(ab, bc), between(bc, ca)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cube `[-1, 1]^3`, its faces cut along some diagonal.
    fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let at = |i: u32, bit: u32| f64::from(i >> bit & 1) * 2.0 - 1.0;
        let positions = (0..8).map(|i| DVec3::new(at(i, 0), at(i, 1), at(i, 2)));
        let quads: [[u32; 4]; 6] = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let cut = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        (positions.collect(), cut.collect())
    }

    #[test]
    fn a_cube_is_faceted_or_round_by_the_angle() {
        let (p, t) = cube();
        let sharp = creased(&p, &t, acos(89.0f64.to_radians()).max(0.1));
        assert_eq!(sharp.positions.len(), 24);
        for t in &sharp.triangles {
            let corners = t.map(|i| sharp.positions[i as usize]);
            let face = triangle_normal(&corners).unwrap();
            assert!(t.iter().all(|&i| sharp.normals[i as usize] == face));
        }
        // Weights by angle: the cut of a face does not show.
        let round = creased(&p, &t, 0.0);
        assert_eq!(round.positions.len(), 8);
        for (p, n) in round.positions.iter().zip(&round.normals) {
            assert!((*n - p.normalize()).length() < 1e-15, "{n}");
        }
    }

    #[test]
    fn rims_and_turned_faces_are_creases() {
        let p = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.2)];
        let joined = creased(&p, &[[0, 1, 2], [2, 1, 3]], -1.0);
        assert_eq!(joined.positions.len(), 4);
        let turned = creased(&p, &[[0, 1, 2], [1, 2, 3]], -1.0);
        assert_eq!(turned.positions.len(), 6);
        assert_eq!(turned.normals[0], DVec3::Z);
    }

    /// A great fan around one vertex takes linear work.
    #[test]
    fn a_great_fan_is_quick() {
        let n = 200_000u32;
        let mut p = vec![DVec3::Z * 0.2];
        p.extend((0..n).map(|i| {
            let (s, c) =
                crate::numeric::trig::sin_cos(f64::from(i) / f64::from(n) * std::f64::consts::TAU);
            DVec3::new(c, s, 0.0)
        }));
        let t: Vec<_> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let fan = creased(&p, &t, 0.9);
        let apex = fan.triangles[7][0] as usize;
        assert!((fan.normals[apex] - DVec3::Z).length() < 1e-6);
        assert_eq!(fan.positions.len(), n as usize + 1);
    }
}
