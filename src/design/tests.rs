//! Lenses whose form or effect is known otherwise.

use super::*;

fn task(resolution: [usize; 2]) -> Task {
    Task {
        lens: [0.1, 0.1 * resolution[1] as f64 / resolution[0] as f64],
        magnification: 1.0,
        distance: 0.3,
        ior: 1.5,
        resolution,
        darkest: 0.05,
    }
}

fn picture(size: [usize; 2], f: impl Fn(f64, f64) -> f64) -> Picture {
    let values = (0..size[0] * size[1])
        .map(|k| {
            let x = ((k % size[0]) as f64 + 0.5) / size[0] as f64;
            let y = ((k / size[0]) as f64 + 0.5) / size[1] as f64;
            f(x, y)
        })
        .collect();
    Picture { size, values }
}

/// A ring and a bar: bright and dark parts with sharp edges, and no symmetry.
fn ring_and_bar(x: f64, y: f64) -> f64 {
    let r = ((x - 0.45).powi(2) + (y - 0.55).powi(2)).sqrt();
    let ring = r > 0.25 && r < 0.32;
    let bar = x > 0.7 && x < 0.9 && y > 0.1 && y < 0.2;
    f64::from(u8::from(ring || bar))
}

#[test]
fn even_light_needs_no_lens() {
    let even = picture([5, 5], |_, _| 0.7);
    let lens = design(&task([32, 32]), &even).unwrap();
    let highest = lens.heights.iter().copied().fold(0.0, f64::max);
    assert!(highest < 1e-14, "{highest}");
    assert!(lens.quality.rms < 1e-12 && lens.quality.outside == 0.0);
    assert!((lens.quality.reflected - 0.04).abs() < 1e-12);
}

/// Even light in a vanishing picture: all ways to the focus take the same
/// time (Fermat), `n h + sqrt(r^2 + (d - h)^2) = const`. That face is a
/// hyperboloid.
#[test]
fn a_vanishing_picture_is_a_focus() {
    let task = Task {
        magnification: 1e-12,
        ..task([64, 32])
    };
    let lens = design(&task, &picture([4, 4], |_, _| 1.0)).unwrap();
    let time = |k: usize| {
        let [hx, hy] = task.spacing();
        let x = (k % 64) as f64 * hx - 0.5 * task.lens[0];
        let y = (k / 64) as f64 * hy - 0.5 * task.lens[1];
        let h = lens.heights[k];
        task.ior * h + (x * x + y * y + (task.distance - h).powi(2)).sqrt()
    };
    let first = time(0);
    assert!(lens.heights.iter().copied().fold(0.0, f64::max) > 8e-3);
    for k in 0..lens.heights.len() {
        // Simpson's rule over steps of 1.6 mm: h^4 times a fourth derivative.
        let off = (time(k) - first).abs();
        assert!(off < 2e-11, "{off} m off at {k}");
    }
}

/// Where density depends on x alone, the light left of a place stays left of
/// its image: both hold the same part of the whole.
#[test]
fn the_transport_along_one_axis_is_that_of_the_sums() {
    // g = 1 + a (2 y - 1), whose integral is y + a (y^2 - y).
    let a = 0.8;
    let errors = [32, 64].map(|n| {
        let h = 1.0 / n as f64;
        let density: Vec<f64> = (0..n * 16)
            .map(|k| 1.0 + a * (2.0 * ((k % n) as f64 + 0.5) * h - 1.0))
            .collect();
        let transport = Transport::new([n, 16], [h, 0.0625], &density, 1e-10);
        assert!(transport.residual < 1e-9, "{}", transport.residual);
        let off = (0..=40).map(|k| {
            let x = f64::from(k) / 40.0;
            let known = ((1.0 - a).powi(2) + 4.0 * a * x).sqrt();
            let known = (known - (1.0 - a)) / (2.0 * a);
            let found = transport.target([x, 0.3], [x, 0.5]);
            assert!((found[1] - 0.3).abs() < 1e-9);
            (found[0] - known).abs()
        });
        off.fold(0.0, f64::max)
    });
    // Second order; the last cell, of a density that does not mirror, counts
    // most.
    assert!(
        errors[1] < 2e-3 && errors[1] < errors[0] / 1.9,
        "{errors:?}"
    );
}

#[test]
fn light_traced_through_the_lens_makes_the_picture() {
    let shape = picture([96, 96], ring_and_bar);
    for (magnification, distance) in [(1.0, 0.3), (0.6, 0.25), (1.5, 0.4)] {
        let task = Task {
            magnification,
            distance,
            ..task([64, 64])
        };
        let quality = design(&task, &shape).unwrap().quality;
        assert!(quality.correlation > 0.99, "{magnification}: {quality:?}");
        assert!(quality.outside < 2e-3, "{magnification}: {quality:?}");
        assert!((0.04..0.045).contains(&quality.reflected), "{quality:?}");
    }
}

/// A lens for one picture does not make another: the comparison can fail.
#[test]
fn the_wrong_picture_is_told_apart() {
    let task = task([64, 64]);
    let lens = design(&task, &picture([96, 96], ring_and_bar)).unwrap();
    let mirrored = picture([96, 96], |x, y| ring_and_bar(1.0 - x, y));
    let density = mirrored.density([32, 32], task.darkest).unwrap();
    let quality = quality::measure(&task, &lens.heights, [32, 32], &density);
    assert!(quality.correlation < 0.8, "{quality:?}");
}

#[test]
fn what_no_lens_can_do_is_refused() {
    let black = picture([8, 8], |_, _| 0.0);
    assert_eq!(
        design(&task([16, 16]), &black).unwrap_err(),
        DesignError::Black
    );
    let near = Task {
        magnification: 5.0,
        distance: 0.1,
        ..task([16, 16])
    };
    let even = picture([8, 8], |_, _| 1.0);
    assert_eq!(design(&near, &even).unwrap_err(), DesignError::TooSteep);
}

#[test]
fn threads_do_not_change_a_bit() {
    let shape = picture([48, 48], ring_and_bar);
    let by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| design(&task([32, 32]), &shape).unwrap().heights)
    };
    assert_eq!(by(1), by(3));
}
