//! All methods that own them show the same caustics.

use super::{
    BDPT, LIGHT, METROPOLIS, PATH, PHOTON_MAP, Photons, ROOM, SPPM, VIEW, common::scene_of,
    judgement::assert_agree,
};

/// A ball of glass, a mirror and a large lamp: caustics that a path from the
/// eye can find, and bidirectional paths in glass.
#[test]
fn caustics_of_a_large_lamp() {
    let scene = scene_of(
        VIEW,
        [24, 24],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"glass\"),
             (shape: Sphere(center: (-0.4, 0.4, 0.4), radius: 0.35), material: \"mirror\"),"
        ),
        "Quad(corner: (-0.7, -0.7, 1.9), u: (0, 1.4, 0), v: (1.4, 0, 0), radiance: 3)",
        "",
    );
    let all = [
        (BDPT, 6),
        (PATH, 8),
        (METROPOLIS, 12),
        (Photons, 1),
        (PHOTON_MAP, 3),
        (SPPM, 4),
    ];
    assert_agree(&scene, &all, 0.045, "caustics");
}

/// Water in glass, one body in the other, and the camera in a third: indices
/// of both sides, whichever way the path goes.
#[test]
fn bodies_in_each_other() {
    let scene = scene_of(
        "eye: (0, -0.9, 1), look_at: (0, 0, 0.9), fov: 70",
        [16, 16],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.3, 0, 0.6), radius: 0.4), material: Dielectric(ior: 1.5, priority: 1)),
             (shape: Sphere(center: (0.3, 0, 0.6), radius: 0.3), material: Dielectric(ior: 1.33, priority: 2)),
             (shape: Sphere(center: (0, -0.9, 1), radius: 0.2), material: Dielectric(ior: 1.4, priority: 3)),"
        ),
        "Quad(corner: (-0.7, -0.7, 1.9), u: (0, 1.4, 0), v: (1.4, 0, 0), radiance: 3)",
        "",
    );
    let all = [
        (BDPT, 6),
        (PATH, 8),
        (METROPOLIS, 12),
        (Photons, 1),
        (PHOTON_MAP, 3),
        (SPPM, 4),
    ];
    assert_agree(&scene, &all, 0.08, "bodies");
}

/// A slab of glass over a floor that the camera sees beside it, and a lamp: the
/// camera's view of the floor is free, so light tracing sees all of it.
#[test]
fn slab_over_a_floor() {
    let scene = scene_of(
        "eye: (0, 0, 0.6), look_at: (0, 0, 0), up: (0, 1, 0), fov: 60",
        [16, 16],
        "(shape: Quad(center: (0, 0, 0), size: (3, 3), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Quad(center: (0.4, 0, 0.9), size: (1.2, 1.2), normal: (0, 0, -1)), material: \"glass\", open: true),
         (shape: Quad(center: (0.4, 0, 1.0), size: (1.2, 1.2), normal: (0, 0, 1)), material: \"glass\", open: true),",
        "Disc(center: (0.3, 0, 2), normal: (0, 0, -1), radius: 0.5, radiance: 5)",
        "",
    );
    let all = [
        (METROPOLIS, 12),
        (LIGHT, 3),
        (PATH, 24),
        (BDPT, 16),
        (Photons, 1),
        (PHOTON_MAP, 3),
        (SPPM, 4),
    ];
    assert_agree(&scene, &all, 0.09, "slab");
}

/// A point light over a ball of glass, seen past it: no path from the eye meets
/// the light, those from the light do.
#[test]
fn caustic_of_a_point() {
    let scene = scene_of(
        "eye: (0, 0, 0.45), look_at: (0, 0, 0), up: (0, 1, 0), height: 1.6",
        [24, 24],
        "(shape: Quad(center: (0, 0, 0), size: (4, 4), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"),",
        "Point(position: (0.15, 0.1, 1.9), power: 50)",
        "",
    );
    let all = [
        (LIGHT, 3),
        (BDPT, 16),
        (Photons, 3),
        (PHOTON_MAP, 4),
        (SPPM, 6),
    ];
    assert_agree(&scene, &all, 0.12, "point");
}

/// A ring of mirror around the place that is seen, and a round lamp: light
/// that is reflected once and more often.
#[test]
fn caustic_in_a_ring() {
    let scene = scene_of(
        "eye: (0, 0, 2), look_at: (0, 0, 0), up: (0, 1, 0), height: 0.9",
        [24, 24],
        "(shape: Quad(center: (0, 0, 0), size: (4, 4), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Cylinder(base: (0, 0, -0.1), end: (0, 0, 0.4), radius: 0.5), material: \"mirror\"),",
        "Disc(center: (1.5, 0.2, 1.6), normal: (-1.5, -0.2, -1.6), radius: 0.4, radiance: 20)",
        "",
    );
    let all = [
        (METROPOLIS, 12),
        (BDPT, 8),
        (PATH, 12),
        (LIGHT, 3),
        (Photons, 1),
        (PHOTON_MAP, 8),
        (SPPM, 6),
    ];
    assert_agree(&scene, &all, 0.08, "ring");
}

/// A knot of glass with smooth normals: light is bent about normals that are
/// not the surface's, and counts the same from both ends.
#[test]
fn caustic_of_a_smooth_mesh() {
    let scene = scene_of(
        "eye: (0, 0, 0.12), look_at: (0, 0, 0), up: (0, 1, 0), height: 2",
        [24, 24],
        "(shape: Quad(center: (0, 0, 0), size: (4, 4), normal: (0, 0, 1)), material: \"grey\"),
         (shape: TorusKnot(p: 2, q: 3, center: (0, 0, 0.6), scale: 0.27, tube: 0.15, segments: 96, sides: 12), material: \"glass\"),",
        "Disc(center: (0.3, 0.2, 3), normal: (0, 0, -1), radius: 0.7, radiance: 6)",
        "",
    );
    let all = [
        (LIGHT, 3),
        (PATH, 16),
        (BDPT, 10),
        (Photons, 1),
        (PHOTON_MAP, 4),
        (SPPM, 6),
    ];
    assert_agree(&scene, &all, 0.12, "knot");
}

/// The sun through a ball of glass on a floor that ends.
#[test]
fn caustic_of_the_sun() {
    let scene = scene_of(
        "eye: (0.5, 0, 0.45), look_at: (0.5, 0, 0), up: (0, 1, 0), height: 1.6",
        [24, 24],
        "(shape: Quad(center: (0, 0, 0), size: (4, 4), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"),",
        "Directional(direction: (0.4, 0, -1), irradiance: 3, angular_diameter: 12)",
        "",
    );
    let all = [
        (LIGHT, 3),
        (PATH, 24),
        (BDPT, 10),
        (Photons, 1),
        (PHOTON_MAP, 4),
        (SPPM, 6),
    ];
    assert_agree(&scene, &all, 0.06, "sun");
}
