//! Defects, closedness, winding and normals of meshes.

use super::*;

/// The cube `[-1, 1]^3`, wound outward.
fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let positions = Aabb {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    }
    .corners();
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let split = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    (
        positions.to_vec(),
        faces.into_iter().flat_map(split).collect(),
    )
}

fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh::new(positions, None, triangles).unwrap()
}

#[test]
fn defects_are_named_with_their_place() {
    let (p, t) = cube();
    let error = |p: &[DVec3], n: Option<Vec<DVec3>>, t: &[[u32; 3]]| {
        TriangleMesh::new(p.to_vec(), n, t.to_vec()).unwrap_err()
    };
    assert_eq!(error(&[], None, &t), MeshError::Empty);
    assert_eq!(error(&p, None, &[]), MeshError::Empty);
    let mut bad = t.clone();
    bad[3][1] = 8;
    let expected = MeshError::IndexOutOfRange {
        triangle: 3,
        index: 8,
        vertices: 8,
    };
    assert_eq!(error(&p, None, &bad), expected);
    for x in [f64::NAN, f64::INFINITY] {
        let mut bad = p.clone();
        bad[5].y = x;
        assert_eq!(error(&bad, None, &t), MeshError::NonFinitePosition(5));
        let mut bad = p.clone();
        bad[2].z = x;
        assert_eq!(error(&p, Some(bad), &t), MeshError::NonFiniteNormal(2));
    }
    let expected = MeshError::NormalCount {
        normals: 7,
        vertices: 8,
    };
    assert_eq!(error(&p, Some(p[1..].to_vec()), &t), expected);
    assert_eq!(
        error(&p, None, &[[0, 0, 1], [2, 2, 2]]),
        MeshError::AllDegenerate(2)
    );
}

#[test]
fn degenerate_triangles_are_dropped_and_counted() {
    let (mut p, mut t) = cube();
    // Collinear, twice the same corner, and a sliver below rounding.
    p.extend([DVec3::splat(0.0), DVec3::splat(0.5), DVec3::splat(0.25)]);
    p.push(DVec3::new(0.25, 0.25, 0.25f64.next_up()));
    t.extend([[8, 9, 10], [0, 0, 1], [8, 9, 11]]);
    let m = mesh(p, t);
    assert_eq!((m.triangle_count(), m.dropped_triangles()), (12, 3));
    // Small and thin ones are sound.
    let thin = [DVec3::ZERO, DVec3::X * 1e-200, DVec3::Y * 1e-210];
    assert_eq!(mesh(thin.to_vec(), vec![[0, 1, 2]]).triangle_count(), 1);
    let large = [DVec3::ZERO, DVec3::X * 1e200, DVec3::Y * 1e190];
    assert_eq!(mesh(large.to_vec(), vec![[0, 1, 2]]).triangle_count(), 1);
}

#[test]
fn closed_or_open() {
    let (p, t) = cube();
    assert!(mesh(p.clone(), t.clone()).is_closed());
    assert!(!mesh(p.clone(), t[1..].to_vec()).is_closed(), "a hole");
    let mut flipped = t.clone();
    flipped[4].swap(0, 1);
    assert!(!mesh(p.clone(), flipped).is_closed(), "one triangle turned");
    // Every triangle with vertices of its own: welded by place, zeros of
    // either sign being one place.
    let shift = |v: DVec3| v + DVec3::ONE;
    let mut soup: Vec<_> = t.iter().flatten().map(|&i| shift(p[i as usize])).collect();
    let names: Vec<_> = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let zero = soup.iter_mut().find(|v| v.x == 0.0).unwrap();
    zero.x = -0.0;
    assert!(mesh(soup, names).is_closed(), "welded");
    let twice = [t.clone(), t.clone()].concat();
    assert!(!mesh(p, twice).is_closed(), "four triangles at each edge");
}

#[test]
fn volume_tells_the_winding() {
    let (p, mut t) = cube();
    let moved: Vec<_> = p.iter().map(|&v| v + DVec3::splat(1e3)).collect();
    assert!((mesh(moved, t.clone()).signed_volume() - 8.0).abs() < 1e-10);
    for triangle in &mut t {
        triangle.swap(0, 1);
    }
    assert!((mesh(p, t).signed_volume() + 8.0).abs() < 1e-14);
}

#[test]
fn shading_normals_stay_on_the_geometric_side() {
    let (p, t) = cube();
    let mut normals = p.clone();
    normals[0] = DVec3::ZERO;
    normals[7] = -normals[7];
    let m = TriangleMesh::new(p, Some(normals), t).unwrap();
    let wrong = [0usize, 7].map(|i| {
        cube()
            .1
            .iter()
            .flatten()
            .filter(|&&j| j as usize == i)
            .count()
    });
    assert_eq!(m.disagreeing_normals(), wrong[0] + wrong[1]);
    assert!(m.is_smooth());
    for part in 0..12 {
        let ng = triangle_normal(&m.triangle(part)).unwrap();
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.3], [0.5, 0.5]] {
            let point = m.surface(DVec3::ZERO, DVec3::X, &ShapeHit { t: 1.0, part, uv });
            assert_eq!(point.ng, ng);
            assert!(point.ns.dot(ng) > 0.0 && (point.ns.length() - 1.0).abs() < 1e-15);
        }
    }
}

#[test]
fn normals_are_interpolated() {
    let p = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let tilted = DVec3::new(3.0, 0.0, 4.0);
    let m = TriangleMesh::new(
        p,
        Some(vec![DVec3::Z, tilted, DVec3::Z * 7.0]),
        vec![[0, 1, 2]],
    );
    let m = m.unwrap();
    let down = m
        .intersect(DVec3::new(0.5, 0.25, 1.0), DVec3::NEG_Z, 2.0, None)
        .unwrap();
    let point = m.surface(DVec3::ZERO, DVec3::X, &down);
    let expected = (DVec3::Z * 0.5 + tilted / 5.0 * 0.5).normalize();
    assert!((point.ns - expected).length() < 1e-15, "{}", point.ns);
    assert_eq!((point.p, point.ng), (DVec3::new(0.5, 0.25, 0.0), DVec3::Z));
}
