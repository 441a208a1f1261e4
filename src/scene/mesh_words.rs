//! What is to be said about meshes, in words.

use glam::DVec3;

use crate::geometry::mesh::{Defects, Edges};

/// How a mesh fails to be closed, one sentence for each kind of edge; none if
/// it is closed.
pub(super) fn openings(defects: &Defects) -> Vec<String> {
    let kinds = [
        (
            defects.open,
            [
                "edge has a face on one side only",
                "edges have a face on one side only",
            ],
        ),
        (
            defects.twisted,
            [
                "edge joins faces of opposite winding",
                "edges join faces of opposite winding",
            ],
        ),
        (
            defects.crowded,
            [
                "edge belongs to more than two faces",
                "edges belong to more than two faces",
            ],
        ),
    ];
    kinds
        .iter()
        .filter_map(|(edges, words)| edges_in_words(edges, *words))
        .collect()
}

fn edges_in_words(edges: &Edges, [one, many]: [&str; 2]) -> Option<String> {
    let [from, to] = edges.first?.map(point);
    Some(match edges.count {
        1 => format!("1 {one}, from {from} to {to}"),
        n => format!("{n} {many}, the first from {from} to {to}"),
    })
}

/// A point as it would be written; six digits are enough to find it.
fn point(p: DVec3) -> String {
    let number = |x: f64| {
        let digits: f64 = format!("{x:.5e}").parse().unwrap_or(x);
        let is_handy = digits == 0.0 || (1e-4..1e7).contains(&digits.abs());
        if is_handy {
            format!("{}", digits + 0.0)
        } else {
            format!("{digits:e}")
        }
    };
    format!("({}, {}, {})", number(p.x), number(p.y), number(p.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_counted_and_placed() {
        let edges = |count| Edges {
            count,
            first: Some([
                DVec3::new(0.1 + 0.2, -0.0, 1e-9),
                DVec3::new(-1e9, 2.5, 1234567.8),
            ]),
        };
        let defects = Defects {
            open: edges(1),
            crowded: edges(3),
            ..Defects::default()
        };
        assert_eq!(
            openings(&defects),
            [
                "1 edge has a face on one side only, from (0.3, 0, 1e-9) to (-1e9, 2.5, 1234570)",
                "3 edges belong to more than two faces, \
                 the first from (0.3, 0, 1e-9) to (-1e9, 2.5, 1234570)",
            ]
        );
        assert!(openings(&Defects::default()).is_empty());
    }
}
