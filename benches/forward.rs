//! The first algorithm of a ray tracing course beside the second: rays from
//! the lamp that find the eye by chance, and rays from the eye.
//!
//! A lamp, a disc of 31 cm that it lights, a camera with a hole in front of
//! the disc. What share of the lamp's rays falls through the hole is known in
//! closed form, and with it the error of the picture's mean after so many
//! rays; the bench sends them and looks, from a kind geometry to one where
//! next to no ray arrives. Then the course's own geometry: its two chances
//! counted one by one, and what they come to at the measured speed.
//!
//! `cargo bench --bench forward -- 1e8` sends 1e8 rays each; two million if
//! nothing is said.

#[allow(dead_code, reason = "a part of what benches share")]
#[path = "common/clock.rs"]
mod clock;

use std::{f64::consts::PI, io::Write as _, path::Path};

use clock::Clock;
use glam::DVec3;
use nephroid::{
    geometry::{Surface, shape::Disc},
    reference::{Forward, Method, Options, Pinhole, Reference},
    render::Job,
    sampling::{Purpose, Sequence, warp},
    scene::{self, Scene},
};
use rayon::prelude::*;

/// Radius of the object and distance of the hole from it, in metres.
const OBJECT: f64 = 0.155;
const EYE: f64 = 1.0;
/// Power of the lamp in watts and half the width of what the camera sees of
/// the object's plane, in metres: the disc blurred by the widest hole.
const POWER: f64 = 100.0;
const HALF_WIDTH: f64 = 0.4;

/// Distance of the lamp and radius of the hole in metres, the kindest first.
const GEOMETRIES: [[f64; 2]; 4] = [[1.0, 0.1], [1.0, 0.03], [4.0, 0.03], [20.0, 0.03]];

/// Pixels along the picture.
const PIXELS: u32 = 64;

/// Independent runs: an error is the spread of that many.
const RUNS: u64 = 32;

/// The course's numbers: diameter and distance of the object, then of the
/// opening.
const COURSE: Forward = Forward {
    object: [0.31, 20.0],
    pixel: [0.285e-3, 0.1],
};

/// What a ray cost in the course, in seconds.
const COURSE_SECONDS: f64 = 1e-4;

fn main() {
    let rays = std::env::args()
        .skip(1)
        .find_map(|a| a.parse::<f64>().ok())
        .unwrap_or(2e6);
    say("The mean of the picture, by rays from the lamp");
    say(
        "  lamp     hole      rays   arrive   mean/exact   error: predicted  measured   rays for 1 %   Mrays/cpu s",
    );
    let mut speed = 0.0;
    for [lamp, hole] in GEOMETRIES {
        speed = forward(lamp, hole, rays);
    }
    say("\nThe same from the eye, one path a pixel");
    say("  lamp   paths   mean/exact   error   paths for 1 %   Mpaths/cpu s");
    let backward = GEOMETRIES.map(|[lamp, _]| backward(lamp))[0];
    say("\nThe course's geometry: an object of 31 cm in 20 m, an opening of 0.285 mm in 10 cm");
    course(rays as u64, speed, backward);
}

/// A lamp over a disc, seen from the axis.
fn lit_disc(lamp: f64) -> Scene {
    let fov = 2.0 * libm::atan(HALF_WIDTH / EYE).to_degrees();
    let text = format!(
        "(camera: (eye: (0, 0, {EYE}), look_at: (0, 0, 0), up: (0, 1, 0), fov: {fov}),
          image: (width: {PIXELS}, height: {PIXELS}, filter: Box),
          objects: [(
              shape: Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: {OBJECT}),
              material: Diffuse(reflectance: 1),
          )],
          lights: [Point(position: (0, 0, {lamp}), power: {POWER})])"
    );
    scene::load_str(&text, "lit disc", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// Part of all directions in which the lamp sees the disc.
fn chance_of_object(lamp: f64) -> f64 {
    let object = [2.0 * OBJECT, lamp];
    Forward { object, ..COURSE }.chance_of_object()
}

/// Mean radiance of the picture: the disc sends on what it gets. A hole of
/// any size in a plane parallel to the disc shifts its picture and keeps its
/// size and light.
fn exact_mean(lamp: f64) -> f64 {
    chance_of_object(lamp) * POWER / PI / (2.0 * HALF_WIDTH).powi(2)
}

/// Mean of the pictures of independent runs over the exact one, its standard
/// error relative to the same, and paths per second of processor time.
struct Measured {
    ratio: f64,
    error: f64,
    paths: f64,
    speed: f64,
}

fn measure(lamp: f64, method: Method, hole: f64, paths: f64) -> Measured {
    let scene = lit_disc(lamp);
    let per_pass = f64::from(PIXELS * PIXELS);
    let passes = (paths / per_pass / RUNS as f64).ceil().max(1.0) as u32;
    let mut job = Job::of(&scene);
    job.settings.passes = passes;
    let clock = Clock::start();
    let means: Vec<f64> = (0..RUNS)
        .map(|seed| {
            job.settings.seed = seed;
            let reference = Reference::new(&scene, &job, method, Options::default())
                .unwrap_or_else(|e| panic!("{e}"))
                .with_pinhole(Pinhole {
                    radius: hole,
                    depth: EYE,
                });
            let sums: f64 = reference
                .passes()
                .take(passes as usize)
                .flatten()
                .map(|sample| sample.total().mean())
                .sum();
            sums / (per_pass * f64::from(passes)) / exact_mean(lamp)
        })
        .collect();
    let seconds = clock.seconds();
    let n = RUNS as f64;
    let ratio = means.iter().sum::<f64>() / n;
    let squares: f64 = means.iter().map(|m| (m - ratio) * (m - ratio)).sum();
    let paths = per_pass * f64::from(passes) * n;
    Measured {
        ratio,
        error: (squares / (n - 1.0) / n).sqrt(),
        paths,
        speed: paths / seconds,
    }
}

/// Sends rays from the lamp; their number per second.
fn forward(lamp: f64, hole: f64, rays: f64) -> f64 {
    let found = measure(lamp, Method::LightNaive, hole, rays);
    // The form factor of the disc to a small area on its axis, times the
    // part of the light that meets the disc: it spreads nearly evenly.
    let share = chance_of_object(lamp) * hole * hole / (OBJECT * OBJECT + EYE * EYE);
    say(&format!(
        "{lamp:>4} m {hole:>6} m {:>9.1e} {:>8.0} {:>12.4} {:>16.2} % {:>7.2} % {:>14.1e} {:>13.2}",
        found.paths,
        share * found.paths,
        found.ratio,
        100.0 / (share * found.paths).sqrt(),
        100.0 * found.error,
        1e4 / share,
        found.speed * 1e-6,
    ));
    found.speed
}

/// Looks from the eye; paths per second.
fn backward(lamp: f64) -> f64 {
    let found = measure(lamp, Method::Path, 0.0, 0.0);
    say(&format!(
        "{lamp:>4} m {:>7.1e} {:>11.4} {:>7.3} % {:>12.1e} {:>14.2}",
        found.paths,
        found.ratio,
        100.0 * found.error,
        found.paths * (found.error / 0.01).powi(2),
        found.speed * 1e-6,
    ));
    found.speed
}

/// Counts the two chances of the course's geometry one by one.
fn course(rays: u64, forward: f64, backward: f64) {
    let counts = [
        ("object", COURSE.object, COURSE.chance_of_object()),
        ("opening", COURSE.pixel, COURSE.chance_of_pixel()),
    ];
    let mut product = 1.0;
    for (item, (name, [diameter, distance], chance)) in (0..).zip(counts) {
        let disc = Disc::new(DVec3::new(0.0, 0.0, distance), DVec3::Z, 0.5 * diameter);
        // Independent directions: points of different sequences.
        let met = (0..rays)
            .into_par_iter()
            .filter(|&i| {
                let key = item * rays + i;
                let mut random = Sequence::new(0, Purpose::Reference, 0, key).at(0);
                let dir = warp::sphere(random.next_2d());
                disc.occludes(DVec3::ZERO, dir, f64::INFINITY, None)
            })
            .count() as f64;
        let part = met / rays as f64;
        product *= part;
        say(&format!(
            "  {name:<8} predicted {:.4e} %, counted {:.4e} % ({met} of {:.0e}, +- {:.1} %)",
            100.0 * chance,
            100.0 * part,
            rays as f64,
            100.0 / met.max(1.0).sqrt(),
        ));
    }
    let days = |rays: f64, seconds: f64| rays * seconds / 86_400.0;
    say(&format!(
        "  rays for one that arrives: predicted {:.2e}, from the counts {:.2e}",
        COURSE.rays(),
        1.0 / product,
    ));
    say(&format!(
        "  predicted, at 0.1 ms a ray: {:.0} days; at {:.2} million a second of processor time: {:.1} hours",
        days(COURSE.rays(), COURSE_SECONDS),
        forward * 1e-6,
        24.0 * days(COURSE.rays(), 1.0 / forward),
    ));
    say(&format!(
        "  from the eye, two million rays: {:.1} minutes at 0.1 ms a ray; {:.2} s of processor time for a million paths of two rays",
        2e6 * COURSE_SECONDS / 60.0,
        1e6 / backward,
    ));
    say(&format!(
        "  a million pixels, each within 1 %, from the lamp: {:.1e} rays, {:.1e} years of processor time",
        1e4 * 1e6 * COURSE.rays(),
        days(1e10 * COURSE.rays(), 1.0 / forward) / 365.25,
    ));
}

fn say(line: &str) {
    // Nobody may be listening.
    let _ = writeln!(std::io::stdout(), "{line}");
}
