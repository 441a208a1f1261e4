use super::*;

fn quantum() -> Quantum {
    Quantum::for_typical(1.0)
}

fn grey(v: f64) -> PixelSample {
    let mut s = PixelSample::default();
    s[Layer::Direct] = Rgb::grey(v);
    s
}

#[test]
fn bytes_are_what_the_text_says() {
    assert_eq!(Film::BYTES_PER_PIXEL, 904);
    assert_eq!(Film::new(5, 3, quantum()).bytes(), 15 * 904);
}

#[test]
fn means_are_over_the_right_passes() {
    let mut film = Film::new(1, 1, quantum());
    assert_eq!(film.image().pixel(0, 0), Rgb::BLACK);
    film.add_pass(0, &[grey(1.0)]);
    film.add_pass(8, &[grey(3.0)]);
    film.add_pass(3, &[grey(8.0)]);
    assert_eq!(film.passes(), 3);
    assert_eq!(film.replicate_passes(), [2, 0, 0, 1, 0, 0, 0, 0]);
    assert_eq!(film.image().pixel(0, 0), Rgb::grey(4.0));
    assert_eq!(film.layer_image(Layer::Direct).pixel(0, 0), Rgb::grey(4.0));
    assert_eq!(film.layer_image(Layer::Caustic).pixel(0, 0), Rgb::BLACK);
    assert_eq!(film.replicate_image(0).pixel(0, 0), Rgb::grey(2.0));
    assert_eq!(film.replicate_image(1).pixel(0, 0), Rgb::BLACK);
    assert_eq!(film.replicate_image(3).pixel(0, 0), Rgb::grey(8.0));
}

#[test]
fn noise_is_the_standard_error_of_the_replicates() {
    let mut film = Film::new(1, 1, quantum());
    assert!(film.noise().is_none());
    film.add_pass(0, &[grey(1.0)]);
    film.add_pass(8, &[grey(1.0)]);
    assert!(film.noise().is_none(), "one replicate has no spread");
    // Replicate means 1, 2, .., 8: sample variance 6, over eight of them.
    let mut film = Film::new(1, 1, quantum());
    for i in 0..8u32 {
        film.add_pass(i, &[grey(f64::from(i))]);
        film.add_pass(i + 8, &[grey(f64::from(i) + 2.0)]);
    }
    let noise = film.noise().unwrap().pixel(0, 0);
    assert!((noise.0[1] - (6.0f64 / 8.0).sqrt()).abs() < 1e-14);
    // Unequal: means 1 (two passes) and 4 (one), mean 2:
    // (2 * 1 + 1 * 4) / 1 / 3 = 2.
    let mut film = Film::new(1, 1, quantum());
    for (pass, v) in [(0, 1.0), (8, 1.0), (1, 4.0)] {
        film.add_pass(pass, &[grey(v)]);
    }
    let noise = film.noise().unwrap().pixel(0, 0);
    assert!((noise.0[0] - 2.0f64.sqrt()).abs() < 1e-14);
}

#[test]
fn blur_is_summed_by_groups_of_replicates() {
    let mut film = Film::new(1, 1, quantum());
    assert_eq!(film.blur(), Vec::<Vec<[f64; 2]>>::new());
    for (pass, blur) in [
        (0, [1.0, 0.5]),
        (1, [3.0, 0.25]),
        (8, [2.0, 0.0]),
        (7, [-1.0, 8.0]),
    ] {
        let sample = PixelSample { blur, ..grey(1.0) };
        let mut one = Film::new(1, 1, quantum());
        one.add_pass(pass, &[sample]);
        film.merge(&one).expect("films of one picture");
    }
    // Groups without a pass have none.
    assert_eq!(film.blur(), [[[2.0, 0.25]], [[-1.0, 8.0]]]);
}

#[test]
fn samples_out_of_range_add_nothing_and_are_counted() {
    let mut bad = grey(1.0);
    bad[Layer::Emission] = Rgb::new(0.0, f64::NAN, 0.0);
    let mut film = Film::new(4, 1, quantum());
    let beyond = grey(libm::ldexp(1.0, 41));
    film.add_pass(0, &[bad, grey(f64::INFINITY), beyond, grey(2.0)]);
    assert_eq!(film.refused(), 3);
    for x in 0..3 {
        assert_eq!(film.image().pixel(x, 0), Rgb::BLACK);
        assert_eq!(film.layer_image(Layer::Direct).pixel(x, 0), Rgb::BLACK);
    }
    assert_eq!(film.image().pixel(3, 0), Rgb::grey(2.0));
    film.add_pass(8, &[grey(libm::ldexp(1.0, 40)); 4]);
    assert_eq!(film.refused(), 3, "the edge of the range is inside");
}

#[test]
fn films_of_different_pictures_do_not_merge() {
    let mut film = Film::new(2, 1, quantum());
    let before = film.clone();
    let mut other = Film::new(1, 2, quantum());
    other.add_pass(0, &[grey(1.0); 2]);
    assert_eq!(
        film.merge(&other),
        Err(MergeError::Size {
            ours: [2, 1],
            theirs: [1, 2]
        })
    );
    let mut other = Film::new(2, 1, Quantum::for_typical(5.0));
    other.add_pass(0, &[grey(1.0); 2]);
    assert_eq!(film.merge(&other), Err(MergeError::Quantum));
    assert_eq!(film, before);
}

/// Later rounds tell the same by half of their passes.
#[test]
fn rounds_count_alike_in_the_blur() {
    let mut film = Film::new(1, 1, quantum());
    for pass in 0..144 {
        let told = blur_weight(pass) > 0.0;
        assert!(told || pass >= 48, "{pass}");
        let blur = if told {
            [f64::from(pass / 8), 1.0]
        } else {
            [0.0; 2]
        };
        film.add_pass(pass, &[PixelSample { blur, ..grey(1.0) }]);
    }
    assert_eq!(film.blur(), vec![vec![[8.5, 1.0]]; GROUPS]);
}
