//! What methods do not see.

use nephroid::{
    film::{Film, Layer},
    reference::Method,
};

use super::{BDPT, PATH, PHOTON_MAP, RADIOSITY, ROOM, SPPM, VIEW, common::scene_of, film_of};

/// What a method can't see is said in words.
#[test]
fn blind_spots_are_named() {
    let scene = scene_of(
        VIEW,
        [8, 8],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"glass\"),"
        ),
        "Point(position: (0.1, -0.3, 1.7), power: 30)",
        "",
    );
    let words = |method: Method| method.blind_spots(&scene).join("\n");
    assert!(words(Method::Path).contains("caustics of lights[0]"));
    assert!(words(Method::Bdpt).contains("seen in mirrors or glass"));
    assert!(words(Method::Light).contains("what mirrors and glass show is black"));
    assert!(words(Method::Whitted).contains("caustics are missing"));
    assert!(words(Method::LightNaive).contains("blurred"));
    assert!(words(Method::PhotonMap).contains("only more photons make smaller"));
    assert!(words(Method::Sppm).contains("shrink from pass to pass"));
    assert!(words(Method::Radiosity).contains("mirrors and glass are black"));
    // And it is so.
    let caustic = |by| film_of(&scene, by, 1).layer_image(Layer::Caustic).mean()[1];
    assert_eq!(caustic(PATH), 0.0);
    assert!(caustic(BDPT) > 0.0);
    assert!(caustic(SPPM) > 0.0 && caustic(PHOTON_MAP) > 0.0);
    assert_eq!(caustic(RADIOSITY), 0.0);
    // The middle of the ball is seen at the picture's right.
    let (black, seen) = (film_of(&scene, RADIOSITY, 1), film_of(&scene, SPPM, 1));
    let at_the_ball = |film: &Film| film.image().pixel(5, 5)[1];
    assert!(at_the_ball(&black) == 0.0 && at_the_ball(&seen) > 0.0);
}
