//! Four scenes in which little of the light that is sent out matters.

use std::path::Path;

use nephroid::scene::{Scene, load_str};

/// Names of the scenes.
pub(crate) const NAMES: [&str; 4] = ["stadium", "fifty lights", "strong lamp", "keyhole"];

/// The scene of a name; `None` if there is none.
pub(crate) fn named(name: &str) -> Option<Scene> {
    let text = match name {
        "stadium" => stadium(),
        "fifty lights" => fifty_lights(),
        "strong lamp" => strong_lamp(),
        "keyhole" => keyhole(),
        _ => return None,
    };
    Some(load_str(&text, name, Path::new("")).unwrap_or_else(|e| panic!("{e}")))
}

/// A scene's text. Walls go into the ground, so that nothing leaks where they
/// meet. Indirect light is left out: it is the same work for
/// everybody, and hides what is asked for here.
fn text(camera: &str, objects: &str, lights: &str) -> String {
    format!(
        "(camera: ({camera}), image: (width: 160, height: 120, filter: Box),
          materials: {{
            \"grey\": Diffuse(reflectance: 0.5),
            \"glass\": Dielectric(ior: 1.5),
          }},
          objects: [
            (name: \"ground\", shape: Quad(corner: (-100, -100, 0), u: (200, 0, 0), v: (0, 200, 0)), material: \"grey\"),
            {objects}
          ],
          lights: [{lights}],
          render: (indirect: false))"
    )
}

/// A ball of glass of 10 cm on the ground of a stadium, with the camera beside
/// it; floodlights on four masts, and behind each of the four stands a ball of
/// glass of 6 m, which takes nearly all the light that is aimed and is not seen.
fn stadium() -> String {
    let stands = [(40, 0), (-40, 0), (0, 40), (0, -40)].map(|(x, y)| {
        let [u, v] = [f64::from(x), f64::from(y)].map(|c| 0.75 * c);
        let [du, dv] = [-v, u];
        format!(
            "(shape: Quad(corner: ({}, {}, -1), u: ({}, {}, 0), v: (0, 0, 11)), material: \"grey\"),
             (shape: Sphere(center: ({x}, {y}, 3.5), radius: 3), material: \"glass\"),",
            u - du, v - dv, 2.0 * du, 2.0 * dv
        )
    });
    let masts = [(-50, -50), (-50, 50), (50, -50), (50, 50)]
        .map(|(x, y)| format!("Sphere(center: ({x}, {y}, 40), radius: 1, power: 50000),"));
    text(
        "eye: (0.3, -0.9, 0.6), look_at: (0, 0, 0.02), fov: 30",
        &format!(
            "(name: \"ball\", shape: Sphere(center: (0, 0, 0.07), radius: 0.05), material: \"glass\"), {}",
            stands.concat()
        ),
        &masts.concat(),
    )
}

/// Fifty rooms in a row, each with a lamp and a ball of glass. The camera sees
/// one room, into which the lamp of the next one shines, too.
fn fifty_lights() -> String {
    let rooms = (0..50).map(|i| {
        let x = 4.0 * f64::from(i) - 98.0;
        let ball =
            format!("(shape: Sphere(center: ({x}, 0, 1), radius: 0.5), material: \"glass\"),");
        let wall = format!(
            "(shape: Quad(corner: ({}, -5, -1), u: (0, 10, 0), v: (0, 0, 7)), material: \"grey\"),",
            x + 2.0
        );
        if i == 25 { ball } else { ball + &wall }
    });
    let lamps = (0..50).map(|i| {
        let x = 4.0 * f64::from(i) - 98.0;
        format!("Sphere(center: ({x}, 1, 4), radius: 0.1, power: 100),")
    });
    text(
        "eye: (2, -1.9, 1.8), look_at: (2, 0, 0.4), fov: 60",
        &rooms.collect::<String>(),
        &lamps.collect::<String>(),
    )
}

/// A weak lamp whose caustic is seen, and one a thousand times as strong behind
/// a wall, with a ball of its own.
fn strong_lamp() -> String {
    text(
        "eye: (0, -4, 2.5), look_at: (0, 0, 0.3), fov: 40",
        "(shape: Sphere(center: (0, 0, 0.8), radius: 0.5), material: \"glass\"),
         (shape: Quad(corner: (-100, 4, -1), u: (200, 0, 0), v: (0, 0, 9)), material: \"grey\"),
         (shape: Sphere(center: (0, 8, 1), radius: 0.8), material: \"glass\"),",
        "Sphere(center: (-1, 0.5, 4), radius: 0.1, power: 100),
         Sphere(center: (1, 8, 4), radius: 0.1, power: 100000),",
    )
}

/// The sun through a hole of 10 cm in a board, onto a ball of glass a metre
/// across; a lamp so that the rest is not black.
fn keyhole() -> String {
    let board = [
        "corner: (-3, -3, 3), u: (2.95, 0, 0), v: (0, 6, 0)",
        "corner: (0.05, -3, 3), u: (2.95, 0, 0), v: (0, 6, 0)",
        "corner: (-0.05, -3, 3), u: (0.1, 0, 0), v: (0, 2.95, 0)",
        "corner: (-0.05, 0.05, 3), u: (0.1, 0, 0), v: (0, 2.95, 0)",
    ]
    .map(|quad| format!("(shape: Quad({quad}), material: \"grey\"),"));
    text(
        "eye: (0.1, -1.5, 0.7), look_at: (0.1, 0, 0.02), fov: 30",
        &format!(
            "(shape: Sphere(center: (0, 0, 2), radius: 0.5), material: \"glass\"), {}",
            board.concat()
        ),
        "Directional(direction: (0.05, 0.02, -1), irradiance: 1000, angular_diameter: 2),
         Sphere(center: (2, -2, 2.5), radius: 0.2, power: 20)",
    )
}
