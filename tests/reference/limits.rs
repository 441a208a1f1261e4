//! Memory, and the number of light paths.

use std::ops::ControlFlow;

use nephroid::{
    film::Layer,
    reference::{self, Method, Options, Reference, Refused},
    render::{Job, REPLICATES},
    scene::Scene,
};

use super::{
    ROOM, VIEW, by_method,
    common::{Estimate, scene_of},
    job,
};

const LAMP: &str = "Quad(corner: (-0.4, -0.4, 1.9), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 6)";

fn room(size: [u32; 2]) -> Scene {
    scene_of(VIEW, size, ROOM, LAMP, "")
}

/// A picture that states no error could never reach one.
#[test]
fn an_error_cannot_be_asked_for() {
    let scene = room([8, 8]);
    let asking = Job {
        error: Some(0.5),
        ..job(&scene, 1)
    };
    for method in Method::ALL {
        let outcome = reference::render(&scene, &asking, method, Options::default(), &mut |_| {
            ControlFlow::Continue(())
        });
        let method = method.name();
        assert_eq!(outcome.err(), Some(Refused::StatesNoError { method }));
    }
}

/// Every method says what it needs, and refuses what it has no room for,
/// before it takes it.
#[test]
fn memory_is_asked_for_first() {
    let scene = room([256, 256]);
    let check = |job: &Job, method| reference::check(&scene, job, method, Options::default());
    for method in Method::ALL {
        let mut job = job(&scene, 1);
        assert_eq!(check(&job, method), Ok(()), "{method:?}");
        job.settings.memory = 40 << 20;
        let refused = check(&job, method).expect_err("the film alone is larger");
        let words = refused.to_string();
        assert!(
            words.contains(method.name()) && words.contains("render.memory"),
            "{words}"
        );
        let outcome = reference::render(&scene, &job, method, Options::default(), &mut |_| {
            ControlFlow::Continue(())
        });
        assert_eq!(outcome.err(), Some(refused));
        // More pictures than there are atoms.
        job.resolution = [u32::MAX; 2];
        job.settings.memory = u64::MAX;
        if let Err(refused) = check(&job, method) {
            assert!(matches!(refused, Refused::TooLarge { .. }));
        }
    }
    // The film and a pass take 76.5 MiB; splats and statistics are more than nothing.
    let mut job = job(&scene, 1);
    job.settings.memory = 77 << 20;
    assert_eq!(check(&job, Method::Path), Ok(()));
    for method in [Method::Light, Method::Bdpt, Method::Sppm, Method::Radiosity] {
        assert!(check(&job, method).is_err(), "{method:?}");
    }
    // Where light paths are kept, there are as many as fit in.
    job.settings.memory = 115 << 20;
    for method in [Method::Sppm, Method::PhotonMap] {
        let paths = |job: &Job| {
            let reference = Reference::new(&scene, job, method, Options::default());
            reference.expect("fits").light_paths(1)
        };
        let fit = paths(&job);
        assert!((4096..65536).contains(&fit), "{method:?}: {fit}");
        let mut asked = job.clone();
        asked.settings.photons = Some(1 << 40);
        let words = check(&asked, method).expect_err("too many").to_string();
        assert!(words.contains("--photons"), "{words}");
        asked.settings.memory = 1 << 40;
        asked.settings.photons = None;
        assert_eq!(paths(&asked), 65536, "{method:?}");
    }
    // Finer elements need more.
    let options = Options {
        patches: 4096.try_into().expect("not zero"),
        ..Options::default()
    };
    assert!(reference::check(&scene, &job, Method::Radiosity, options).is_err());
}

/// What cannot be divided into elements is named.
#[test]
fn endless_surfaces_have_no_elements() {
    let scene = scene_of(
        VIEW,
        [8, 8],
        "(name: \"meadow\", shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\")",
        LAMP,
        "",
    );
    let refused = reference::check(
        &scene,
        &job(&scene, 1),
        Method::Radiosity,
        Options::default(),
    );
    let words = refused.expect_err("no bounds").to_string();
    assert!(
        words.contains("meadow") && words.contains("quads"),
        "{words}"
    );
}

/// The settings' light paths are those of a pass: more of them are less noise
/// and the same picture.
#[test]
fn light_paths_are_those_asked_for() {
    let scene = room([8, 8]);
    let layer = |method| match method {
        Method::Light | Method::LightNaive => Layer::Direct,
        _ => Layer::Indirect,
    };
    for method in Method::ALL {
        let with = |photons| {
            let mut job = job(&scene, 2);
            job.settings.photons = Some(photons);
            let reference = Reference::new(&scene, &job, method, Options::default());
            let paths = reference.expect("fits").light_paths(2 * REPLICATES);
            let chosen = method.has_light_paths();
            let expected = if chosen {
                photons * u64::from(2 * REPLICATES)
            } else {
                0
            };
            assert_eq!(paths, expected, "{method:?}");
            let film = by_method(&scene, &job, method, Options::default());
            let picture = film.layer_image(layer(method));
            let spread: Vec<f64> = (0..REPLICATES as usize)
                .map(|r| film.replicate_image(r).mean()[1])
                .collect();
            (picture, Estimate::of(&spread))
        };
        let ((few_picture, few), (many_picture, many)) = (with(64), with(4096));
        if method.has_light_paths() {
            let error = (few.error * few.error + many.error * many.error).sqrt();
            // The nearest of few photons are far away.
            let blur = match method {
                Method::PhotonMap => 0.3,
                Method::Sppm => 0.05,
                _ => 0.0,
            };
            assert!(
                (few.mean - many.mean).abs() < 7.0 * error + blur * many.mean,
                "{method:?}: {few:?} {many:?}"
            );
            if method == Method::Light {
                assert!(many.error < 0.4 * few.error, "{few:?} {many:?}");
            }
        } else {
            assert_eq!(few_picture, many_picture, "{method:?}");
        }
    }
}
