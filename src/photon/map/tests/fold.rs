//! Kernels next to folds.

use std::f64::consts::PI;

use super::*;

/// Photons next to a fold: whatever least width a query asks for, no kernel
/// reaches into the dark beyond, and all light is there, thrown back by the fold.
#[test]
fn kernels_end_at_a_fold() {
    let (fold, strip) = (0.01, 2e-3);
    for (side, normal) in [(1.0, DVec3::Z), (-1.0, DVec3::Z), (1.0, -DVec3::Z)] {
        // The light lies towards +x.
        let photon = Photon {
            position: DVec3::ZERO,
            normal,
            flux: Rgb::WHITE,
            footprint: Some(Footprint {
                major: normal.cross(DVec3::X) * -0.2 * side,
                minor: 0.05,
                fold,
            }),
            bounced: false,
            sheet: 0.0,
        };
        let map = PhotonMap::new(&[photon], 1, 1.0);
        for least in [0.0, 0.008, 0.02, 0.06] {
            let cell = 1e-3;
            let (mut beyond, mut edge, mut all) = (0.0, 0.0, 0.0);
            for i in -250..250 {
                for j in -250..250 {
                    let p = DVec3::new(f64::from(i) + 0.5, f64::from(j) + 0.5, 0.0) * cell;
                    let q = query(p, normal, 0.0);
                    let q = Query {
                        kernels: Kernels { least, ..q.kernels },
                        ..q
                    };
                    let light = ask(&map, &q).irradiance[0] * cell * cell;
                    all += light;
                    // Towards the light when `side` is right.
                    if p.x * side < -fold - 1e-6 {
                        beyond += light;
                    }
                    if (p.x * side + fold).abs() < strip {
                        edge += light;
                    }
                }
            }
            assert!((all - 1.0).abs() < 2e-3, "{side} {normal} {least}: {all}");
            assert_eq!(beyond, 0.0, "{side} {normal} {least}");
            if least > fold {
                // The profile of a kernel, and of its image, where they meet.
                let profile = (1.0 - (fold / least).powi(2)).powf(1.5) * 8.0 / (3.0 * PI * least);
                let expected = 2.0 * profile * strip;
                assert!(
                    (edge / expected - 1.0).abs() < 0.01,
                    "{least}: {edge}, not {expected}"
                );
            }
        }
    }
}
