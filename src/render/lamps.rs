//! Which lights matter to the picture: a pilot for the shadow rays that cannot
//! go to all of them.
//!
//! With light `i` picked by chance `p_i`, a point of the picture to which it
//! sends `c_i` is left with a variance of the sum of `c_i^2 / p_i`, less what does
//! not depend on the chances. Summed over the picture, each point weighed by how
//! its error is seen (`1 / (L^2 + 0.01 mean(L)^2)`, see `importance`), that is
//! least for `p_i` in proportion to the root of the weighed sum of `c_i^2`.

use rayon::prelude::*;

use crate::{
    material::Material,
    numeric::Frame,
    sampling::{Purpose, Sequence, Stream, warp},
    transport::{Context, DiffusePoint, End, LightPicker, Walker, from_light},
};

use super::{Renderer, camera_walk::MOST_SHADOW_RAYS, coordinates};

/// Shadow rays of the pilot, about, and bounds on its camera paths.
const RAYS: u64 = 1 << 15;
const PATHS: [u64; 2] = [64, 1024];

/// Number of its sequence among those of pilots.
const SEQUENCE: u32 = 9;

/// What each light sends to the first two diffuse points of a camera path.
type Sent = [Vec<f64>; 2];

impl Renderer<'_> {
    /// The picker that leaves the least variance, as far as a pilot can tell;
    /// as it is where there is nothing to pick.
    pub(super) fn picker_by_need(&self) -> LightPicker {
        let ctx = self.called_for();
        let lights = ctx.scene.lights.len();
        // Every light gets a ray where the eye looks; fewer go from where light
        // comes by a bounce, or by a weak reflection.
        let objects = &ctx.scene.objects;
        let weakens = ctx.plan.indirect() || objects.iter().any(|o| o.material.is_specular());
        if lights < 2 || (lights <= MOST_SHADOW_RAYS && !weakens) {
            return ctx.picker.clone();
        }
        let [least, most] = PATHS;
        let paths = (RAYS / lights as u64).clamp(least, most);
        let sequence = Sequence::new(self.settings.seed, Purpose::Pilot, SEQUENCE, 0);
        let [width, height] = self.resolution.map(f64::from);
        let sent: Vec<Sent> = (0..paths)
            .into_par_iter()
            .map(|i| {
                let stream = sequence.at(i);
                let [u, v] = coordinates::film(&stream);
                let ray = self.camera.ray(glam::DVec2::new(u * width, v * height));
                let mut rest = coordinates::coins(&stream);
                follow(&ctx, Walker::from_camera(&ctx, ray), &mut rest)
            })
            .collect();
        ctx.picker.guided(&scores(&sent, lights))
    }
}

/// Follows a camera path to two diffuse points and asks all lights there.
fn follow(ctx: &Context<'_>, mut path: Walker, stream: &mut Stream) -> Sent {
    let mut sent = Sent::default();
    for found in &mut sent {
        let End::Surface {
            point,
            material: Material::Diffuse { reflectance },
        } = path.walk(ctx, stream, &mut |_| false)
        else {
            break;
        };
        let at = DiffusePoint::new(point, path.ray.dir, reflectance, path.media);
        *found = (0..ctx.scene.lights.len())
            .map(|i| (path.throughput * from_light(ctx, &at, i, stream.next_2d())).mean())
            .collect();
        let local = warp::cosine_hemisphere(stream.next_2d());
        let dir = Frame::around(at.ns).to_world(local).normalize();
        if !ctx.plan.indirect() || dir.dot(at.ng) <= 0.0 {
            break;
        }
        path.throughput *= reflectance;
        path.ray = point.spawn(dir);
    }
    sent
}

/// The root of each light's weighed sum of squares.
fn scores(sent: &[Sent], lights: usize) -> Vec<f64> {
    let light = |s: &Sent| -> f64 {
        let all = s.iter().flatten();
        all.filter(|c| c.is_finite()).sum()
    };
    let mean = sent.iter().map(light).sum::<f64>() / sent.len().max(1) as f64;
    let mut squares = vec![0.0; lights];
    for s in sent {
        let own = light(s);
        let seen = own * own + 0.01 * mean * mean;
        for found in s {
            for (square, c) in squares.iter_mut().zip(found) {
                if *c > 0.0 && c.is_finite() {
                    *square += c * c / seen;
                }
            }
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{render::Job, scene::load_str};

    /// A ball of glass in front of a wall with a strong lamp behind it. Through
    /// the ball a weak reflection may cost the floor one of its two shadow rays:
    /// it must not go to the lamp that nobody sees.
    #[test]
    fn lamps_behind_walls_get_few_rays_from_weak_reflections() {
        let text = "(camera: (eye: (0, -4, 2.5), look_at: (0, 0, 0.3), fov: 40),
            image: (width: 32, height: 24),
            objects: [
                (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
                (shape: Sphere(center: (0, 0, 0.8), radius: 0.5), material: Dielectric(ior: 1.5)),
                (shape: Plane(point: (0, 4, 0), normal: (0, -1, 0)), material: Diffuse(reflectance: 0.5)),
            ],
            lights: [
                Sphere(center: (-1, 0.5, 4), radius: 0.1, power: 100),
                Sphere(center: (1, 8, 4), radius: 0.1, power: 1e5),
            ],
            render: (indirect: false))";
        let scene = load_str(text, "wall", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
        let job = Job::of(&scene);
        let renderer = Renderer::new(&scene, &job.settings, job.resolution, job.window());
        let ctx = renderer.called_for();
        let table = ctx.picker.table().unwrap_or_else(|| panic!("lamps shine"));
        let strong = table.probability(1);
        assert!(strong < 0.2, "{strong} of the rays to the strong lamp");
    }

    /// Two points of the picture, one lit by 3 and 1, one by 4 of the second
    /// light alone and, after a bounce, by 2 of the first: means 4 and 6, floor
    /// 0.25.
    #[test]
    fn scores_are_roots_of_weighed_squares() {
        let sent = [
            [vec![3.0, 1.0], vec![]],
            [vec![0.0, 4.0], vec![2.0, f64::NAN]],
        ];
        // What is not finite counts as nothing.
        let finite = [sent[0].clone(), [vec![0.0, 4.0], vec![2.0, 0.0]]];
        let first = 9.0 / 16.25 + 4.0 / 36.25;
        let second = 1.0 / 16.25 + 16.0 / 36.25;
        for sent in [&sent, &finite] {
            let found = scores(sent, 2);
            for (score, square) in found.iter().zip([first, second]) {
                assert!((score - f64::sqrt(square)).abs() < 1e-12, "{found:?}");
            }
        }
        assert_eq!(scores(&[[vec![], vec![]], [vec![], vec![]]], 3), [0.0; 3]);
    }
}
