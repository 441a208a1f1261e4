//! Queries one after the other, and what they ask besides.

use super::*;

/// Queries that follow each other closely, over edges and with kernels of
/// changing bounds, give the very numbers that each of them gives alone.
#[test]
fn vicinity_changes_no_answer() {
    let mut photons = floor_photons(20_000, 1.0, |s| {
        let kind = s.next_1d();
        let major = 0.003 * 30f64.powf(s.next_1d());
        let minor = major * 30f64.powf(-s.next_1d());
        let footprint = turned(2.0 * PI * s.next_1d(), major, minor);
        let z = 0.002 * s.next_1d();
        (z, (kind < 0.9).then_some(footprint))
    });
    for (i, p) in photons.iter_mut().enumerate() {
        p.bounced = i % 7 == 0;
        if i % 11 == 0 {
            p.normal = DVec3::new(0.3, -0.2, 1.0).normalize();
        }
    }
    let map = PhotonMap::new(&photons, 1000, 0.5);
    let at = numbers(8);
    let mut vicinity = Vicinity::new(&map);
    let (mut searched, mut alone) = (0, 0);
    let mut p = DVec3::ZERO;
    for i in 0..4000 {
        let mut s = at(i);
        let [a, b] = s.next_2d();
        if i % 500 == 0 {
            p = DVec3::new(1.6 * a - 0.8, 1.6 * b - 0.8, 0.001);
        }
        let spacing = 0.004;
        p += DVec3::new(2.0 * a - 1.0, 2.0 * b - 1.0, 0.02 * (a - b)) * spacing;
        let q = Query {
            kernels: Kernels {
                least: 0.002 * (1.0 + 0.3 * s.next_1d()),
                most: 0.05 * (1.0 + 0.3 * s.next_1d()),
                most_bounced: 0.03,
                blind: 0.01 * (1.0 + 0.1 * s.next_1d()),
                caustics: i % 5 != 0,
                spacing,
            },
            ..query(p, DVec3::new(0.02 * a, 0.0, 1.0).normalize(), 0.0)
        };
        let near = vicinity.irradiance(&q, || 0.0, |o, e| [1.0 - 0.1 * (o.length() / e.major); 3]);
        let single = map.irradiance(&q, |o, e| [1.0 - 0.1 * (o.length() / e.major); 3]);
        assert_eq!(near.irradiance, single.irradiance, "query {i}");
        assert_eq!(near.bounced, single.bounced, "query {i}");
        assert_eq!(near.accepted, single.accepted, "query {i}");
        assert_eq!(near.narrower, [[0.0; 2]; 2], "query {i}: nobody asked");
        searched += near.visited;
        alone += single.visited;
    }
    assert!(
        4 * searched < alone,
        "{searched} candidates, not far below {alone}"
    );
}

/// Queries so far apart that their region has no square in single precision
/// search for themselves, and lose no light.
#[test]
fn vast_regions_lose_no_light() {
    let map = PhotonMap::new(&floor_photons(1000, 1.0, |_| (0.0, None)), 1000, 1.0);
    let mut vicinity = Vicinity::new(&map);
    let q = query(DVec3::ZERO, DVec3::Z, 0.2);
    for spacing in [1e17, 1e19, 1e40, f64::INFINITY] {
        let q = Query {
            kernels: Kernels {
                spacing,
                ..q.kernels
            },
            ..q
        };
        for _ in 0..3 {
            let found = vicinity.irradiance(&q, || 0.0, |_, _| [1.0; 3]);
            assert!(found.accepted > 0, "spacing {spacing}");
            assert_eq!(found.irradiance, ask(&map, &q).irradiance, "{spacing}");
        }
    }
}

/// A region in which too many photons lie is not kept.
#[test]
fn crowded_regions_search_for_every_query() {
    let photons = floor_photons(20_000, 1.0, |_| (0.0, None));
    let map = PhotonMap::new(&photons, 1000, 1.0);
    let mut vicinity = Vicinity::new(&map);
    for i in 0..20 {
        let p = DVec3::new(0.001 * f64::from(i), 0.0, 0.0);
        let q = Query {
            kernels: Kernels {
                blind: 0.2,
                spacing: 0.5,
                ..KERNELS
            },
            ..query(p, DVec3::Z, 0.0)
        };
        let near = vicinity.irradiance(&q, || 0.0, |_, _| [1.0; 3]);
        let single = ask(&map, &q);
        assert_eq!(near.irradiance, single.irradiance, "query {i}");
        // The second query finds out.
        assert_eq!(near.visited > single.visited, i == 1, "query {i}");
    }
}

/// What narrower kernels find of the same photons is what a map finds whose
/// kernels are all that narrow; finding it out changes nothing else.
#[test]
fn kernels_are_drawn_in_as_later_rounds_have_them() {
    let photons = floor_photons(3000, 1.0, |s| {
        let minor = 0.05 + 0.1 * s.next_1d();
        let footprint = turned(0.3, 0.2, minor);
        (0.0, Some(footprint))
    });
    let map = PhotonMap::new(&photons, 1000, 1.0);
    let smaller = [0.5f64.sqrt(), 0.5].map(|shrink| PhotonMap::new(&photons, 1000, shrink));
    let at = numbers(9);
    let mut vicinity = Vicinity::drawing_in(&map);
    for i in 0..50 {
        let [a, b] = at(i).next_2d();
        let q = query(DVec3::new(a - 0.5, b - 0.5, 0.0), DVec3::Z, 0.0);
        let found = vicinity.irradiance(&q, || f64::INFINITY, |_, _| [1.0; 3]);
        let whole = ask(&map, &q);
        assert_eq!(found.irradiance, whole.irradiance, "query {i}");
        for (less, map) in found.narrower[0].into_iter().zip(&smaller) {
            let expected = ask(map, &q).irradiance.mean() / whole.irradiance.mean();
            // Kernels and their distances are in single precision.
            assert!(
                (less - expected).abs() < 1e-5,
                "query {i}: {less}, {expected}"
            );
        }
        assert_eq!(found.narrower[1], [1.0; 2], "nothing bounced");
    }
}
