//! What keeps a mesh from being one closed, evenly wound surface.

use glam::DVec3;
use rayon::prelude::*;

use super::weld::first_at_place;

/// Edges of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edges {
    /// How many there are.
    pub count: usize,
    /// The ends of the first one, in the order of the vertices.
    pub first: Option<[DVec3; 2]>,
}

/// How the triangles of a mesh fail to join. Vertices at the same place count
/// as one; triangles with two corners at one place are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defects {
    /// Edges that only one triangle has: the rim of a hole or of a sheet.
    pub open: Edges,
    /// Edges that two triangles run through in the same direction: the two
    /// are wound differently.
    pub twisted: Edges,
    /// Edges that more than two triangles share.
    pub crowded: Edges,
    /// Triangles that have the same three corners as another one, in any
    /// order; the one that they repeat is not counted.
    pub doubled: usize,
}

impl Defects {
    /// Finds them. Every index must be valid, and vertices fewer than 2^31.
    pub(super) fn of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let first = first_at_place(positions);
        let welded = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| first[i as usize]);
            (a != b && b != c && c != a).then_some([a, b, c])
        };
        let edges = EdgeTable::new(positions.len(), || triangles.iter().filter_map(welded));
        let mut found = edges.defects(positions);
        drop(edges);
        found.doubled = doubled(triangles.par_iter().filter_map(welded));
        found
    }

    /// True if every edge belongs to exactly two triangles that run through
    /// it in opposite directions.
    pub fn is_closed(&self) -> bool {
        self.open.count + self.twisted.count + self.crowded.count == 0
    }
}

/// The edges of all triangles, by their smaller vertex.
struct EdgeTable {
    /// Where the edges of each vertex start, and the end of the last.
    starts: Vec<u32>,
    /// The larger vertex, and in the last bit whether the triangle runs
    /// towards it.
    others: Vec<u32>,
}

impl EdgeTable {
    fn new<I: Iterator<Item = [u32; 3]>>(vertices: usize, triangles: impl Fn() -> I) -> Self {
        let edges = || {
            triangles().flat_map(|[a, b, c]| {
                [(a, b), (b, c), (c, a)]
                    .map(|(i, j)| (i.min(j), (i.max(j) << 1) | u32::from(i < j)))
            })
        };
        let mut starts = vec![0u32; vertices + 1];
        for (low, _) in edges() {
            starts[low as usize + 1] += 1;
        }
        for i in 0..vertices {
            starts[i + 1] += starts[i];
        }
        let mut others = vec![0; starts[vertices] as usize];
        // `starts` counts on while the table is filled, and is then shifted
        // back by one place.
        for (low, other) in edges() {
            let slot = &mut starts[low as usize];
            others[*slot as usize] = other;
            *slot += 1;
        }
        starts.rotate_right(1);
        starts[0] = 0;
        Self { starts, others }
    }

    fn defects(&self, positions: &[DVec3]) -> Defects {
        let vertices = self.starts.len() - 1;
        let found = (0..vertices).into_par_iter().fold(
            || (Found::default(), Vec::new()),
            |(mut found, mut list), low| {
                list.clear();
                let range = self.starts[low] as usize..self.starts[low + 1] as usize;
                list.extend_from_slice(&self.others[range]);
                list.sort_unstable();
                for same in list.chunk_by(|a, b| a >> 1 == b >> 1) {
                    found.take([low as u32, same[0] >> 1], same);
                }
                (found, list)
            },
        );
        let found = found
            .map(|(found, _)| found)
            .reduce(Found::default, Found::joined);
        found.located(positions)
    }
}

/// Counts of edges, and the first of each kind as vertices.
#[derive(Clone, Copy, Default)]
struct Found {
    kinds: [(usize, Option<[u32; 2]>); 3],
}

impl Found {
    /// An edge and all its uses.
    fn take(&mut self, edge: [u32; 2], uses: &[u32]) {
        let kind = match uses {
            [_] => 0,
            [a, b] if a == b => 1,
            [_, _] => return,
            _ => 2,
        };
        let (count, first) = &mut self.kinds[kind];
        *count += 1;
        first.get_or_insert(edge);
    }

    /// `self` is of smaller vertices.
    fn joined(self, other: Self) -> Self {
        let kinds = [0, 1, 2].map(|k| {
            let ((n, first), (m, second)) = (self.kinds[k], other.kinds[k]);
            (n + m, first.or(second))
        });
        Self { kinds }
    }

    fn located(self, positions: &[DVec3]) -> Defects {
        let [open, twisted, crowded] = self.kinds.map(|(count, first)| Edges {
            count,
            first: first.map(|edge| edge.map(|i| positions[i as usize])),
        });
        Defects {
            open,
            twisted,
            crowded,
            doubled: 0,
        }
    }
}

fn doubled(triangles: impl ParallelIterator<Item = [u32; 3]>) -> usize {
    let mut sorted: Vec<[u32; 3]> = triangles
        .map(|mut t| {
            t.sort_unstable();
            t
        })
        .collect();
    sorted.par_sort_unstable();
    sorted.par_windows(2).filter(|w| w[0] == w[1]).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        (
            vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        )
    }

    fn counts(d: &Defects) -> [usize; 4] {
        [d.open.count, d.twisted.count, d.crowded.count, d.doubled]
    }

    #[test]
    fn a_tetrahedron_has_none_and_each_change_shows() {
        let (p, t) = tetrahedron();
        let whole = Defects::of(&p, &t);
        assert_eq!(whole, Defects::default());
        assert!(whole.is_closed());

        let hole = Defects::of(&p, &t[..3]);
        assert_eq!(counts(&hole), [3, 0, 0, 0]);
        assert_eq!(hole.open.first, Some([DVec3::X, DVec3::Y]));

        let mut turned = t.clone();
        turned[1].swap(0, 1);
        let turned = Defects::of(&p, &turned);
        assert_eq!(counts(&turned), [0, 3, 0, 0]);
        assert_eq!(turned.twisted.first, Some([DVec3::ZERO, DVec3::X]));

        let mut twice = t.clone();
        twice.push([3, 1, 2]);
        let twice = Defects::of(&p, &twice);
        assert_eq!(counts(&twice), [0, 0, 3, 1]);
        assert_eq!(twice.crowded.first, Some([DVec3::X, DVec3::Y]));
        assert!(![&hole, &turned, &twice].iter().any(|d| d.is_closed()));
    }

    #[test]
    fn corners_at_one_place_are_one_vertex() {
        let (p, t) = tetrahedron();
        let soup: Vec<DVec3> = t.iter().flatten().map(|&i| p[i as usize]).collect();
        let own: Vec<[u32; 3]> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert!(Defects::of(&soup, &own).is_closed());
        // A triangle with two corners at one place joins nothing.
        let mut more = own.clone();
        more.push([0, 4, 3]);
        assert!(p[t[0][0] as usize] == soup[0] && soup[0] == soup[3]);
        assert!(Defects::of(&soup, &more).is_closed());
    }

    /// Against counting in a map, edge by edge.
    #[test]
    fn random_triangles_as_by_a_map() {
        let mut state = 1u64;
        let mut below = |n: u64| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            ((state >> 33) % n) as u32
        };
        let p: Vec<DVec3> = (0..40).map(|i| DVec3::X * f64::from(i / 2)).collect();
        let t: Vec<[u32; 3]> = (0..300)
            .map(|_| [below(40), below(40), below(40)])
            .collect();
        let mut uses = std::collections::BTreeMap::<(u32, u32), Vec<bool>>::new();
        for t in &t {
            let [a, b, c] = t.map(|i| i / 2);
            if a != b && b != c && c != a {
                for (i, j) in [(a, b), (b, c), (c, a)] {
                    uses.entry((i.min(j), i.max(j))).or_default().push(i < j);
                }
            }
        }
        let of = |f: fn(&Vec<bool>) -> bool| uses.values().filter(|u| f(u)).count();
        let found = Defects::of(&p, &t);
        let expected = [
            of(|u| u.len() == 1),
            of(|u| u.len() == 2 && u[0] == u[1]),
            of(|u| u.len() > 2),
        ];
        assert_eq!(counts(&found)[..3], expected);
        assert!(expected.iter().all(|&n| n > 0), "{expected:?}");
    }
}
