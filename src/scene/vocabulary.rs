//! What each field of the language wants, in words, for messages.

/// What a field expects.
pub(super) fn expectation(field: &str) -> Option<&'static str> {
    Some(match field {
        "camera" => "a camera `(eye: .., look_at: .., fov: ..)`",
        "image" => "an image `(width: .., height: ..)`",
        "materials" => "materials by name: `{\"name\": Diffuse(reflectance: 0.5)}`",
        "meshes" => "meshes by name: `{\"name\": File(\"lens.ply\")}`",
        "objects" => "a list of objects: `[(shape: .., material: ..)]`",
        "lights" => "a list of lights: `[Point(position: .., power: ..)]`",
        "render" => "settings `(passes: .., seed: ..)`",
        "shape" => "a shape such as `Sphere(center: .., radius: ..)`",
        "material" => "a material's name, or a material such as `Diffuse(reflectance: 0.5)`",
        "at" => "`(scale: .., rotate: .., translate: ..)`, or a list of such steps",
        "eye" | "look_at" | "point" | "corner" | "center" | "facing" | "base" | "end" | "apex"
        | "position" | "a" | "b" | "c" | "min" | "max" => "a point `(x, y, z)` in metres",
        "up" | "normal" | "direction" | "axis" => "a direction `(x, y, z)`",
        "u" | "v" => "an edge `(x, y, z)` in metres",
        "size" => "`(width, height)` in metres, of a Box `(x, y, z)`, all above 0",
        "semi_axes" => "half the widths `(x, y, z)` in metres, all above 0",
        "coefficients" => "ten numbers: of x^2, y^2, z^2, xy, yz, xz, x, y, z and 1",
        "of" => "a list of solids: `[(shape: .., at: ..), ..]`",
        "r1" | "r2" => "a radius of curvature in metres, not 0",
        "translate" => "a shift `(x, y, z)` in metres",
        "scale" => "a factor, or one per axis as `(x, y, z)`",
        "rotate" => "`(axis: (x, y, z), degrees: ..)`, or a list of rotations",
        "degrees" => "an angle in degrees",
        "fov" => "the vertical field of view in degrees, between 0 and 180",
        "radius" | "tube" | "height" | "width" | "depth" | "top_radius" | "end_radius"
        | "waist" | "major" | "minor" | "thickness" | "aperture" => "a number above 0",
        "inner" | "outer" => "a half-angle in degrees, from 0 to 180",
        "angular_diameter" => "an angle in degrees, from 0 to below 180",
        "reflectance" => "a colour from 0 to 1: a number, `(r, g, b)` or \"#rrggbb\"",
        "power" | "intensity" | "radiance" | "irradiance" => {
            "a colour: a number, `(r, g, b)` or \"#rrggbb\""
        }
        "ior" | "outside" => "an index of refraction, at least 1",
        "medium" => "the name of a closed object of a clear medium, as a text",
        "priority" => "a whole number from -128 to 127",
        "thin" | "open" | "capped" | "indirect" => "`true` or `false`",
        "file" => "the path of a mesh file, as a text",
        "channel" => "the name of a channel, as a text",
        "heights" => "the path of a 16-bit grey PNG or an EXR image, as a text",
        "range" => "the heights `(z0, z1)` in metres of the values 0 and 1",
        "name" | "named" => "a name, as a text",
        "vertices" => "a list of points `[(x, y, z), ..]`",
        "normals" => "a list of directions `[(x, y, z), ..]`, one per vertex",
        "triangles" => "a list of vertex indices `[(0, 1, 2), ..]`",
        "waves" => "a list of waves `[(amplitude: .., k: (kx, ky), phase: ..)]`",
        "f" => "a formula in x, y and z, as a text: \"x^2 + y^2 + z^2 - 1\"",
        "bounds" => "the lowest and the highest corner `((x, y, z), (x, y, z))`",
        "method" => "`Interval`, `SphereTracing` or `March(step: ..)`",
        "step" => "a length in metres",
        "smooth" => "`true`, `false` or an angle in degrees",
        "cells" => "a whole number, or two as `(nx, ny)`",
        "x" | "y" => "a range `(from, to)` in metres",
        "k" => "a wave vector `(kx, ky)` in radians per metre",
        "exposure" => "a number of stops",
        "filter" => "`Box`, `Gaussian` or `BlackmanHarris`",
        "beam" => "a cross-section `(center: .., radius: ..)`",
        "passes" | "max_depth" | "photons" | "segments" | "sides" | "p" | "q" => {
            "a whole number, at least 1"
        }
        "seed" => "a whole number",
        "effects" => "effects by name, each `Auto`, `Off` or `On`: `(caustics: Off)`",
        "memory" => "a number of bytes, or a text such as \"512 MiB\"",
        _ => return None,
    })
}
