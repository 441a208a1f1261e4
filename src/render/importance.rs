//! How much a photon matters to the picture, by where it lands.
//!
//! The error of a pixel is seen relative to its light `L`: what counts is
//! the squared error over `L^2 + 0.01 mean(L)^2`. Irradiance `e` at a point that
//! a camera path of throughput `t` (reflectance over pi included) reaches adds
//! `t e`, so an error of `e` there weighs `t^2 / (L^2 + 0.01 mean^2)`. Camera
//! paths leave that weight at the points they reach; its density per area is
//! the *importance* (P. Christensen, *Adjoints and Importance in Rendering: an
//! Overview*, 2003), found like irradiance.

use std::{cell::OnceCell, f64::consts::FRAC_1_PI};

use glam::{DVec2, DVec3};

use crate::{
    camera::{Camera, Footprint as Beam},
    geometry::Ray,
    material::Material,
    numeric::Frame,
    photon::{Footprint, Kernels, Photon, PhotonMap, Query, is_wall},
    sampling::{Stream, warp},
    scene::Scene,
    spectrum::Rgb,
    transport::{Context, DiffusePoint, End, Walker},
};

/// Radius of a point's kernel in mean distances between neighbouring camera
/// paths: it reaches about a dozen others.
const SPACINGS: f64 = 2.0;

/// Radius of a point's kernel after a diffuse bounce, in metres per metre of
/// the way from there.
const DIFFUSE_SPREAD: f64 = 0.2;

/// Smallest cosine of incidence by which a kernel is stretched.
const GRAZING: f64 = 0.2;

/// How far above the surface the way from a photon to a point is looked at, in
/// lengths of the way.
const LIFT: f64 = 0.05;

/// Points that a camera path reached, not yet weighed against their pixel: the
/// weight is `t^2`.
pub(super) type Reached = [Option<Photon>; 2];

/// The kernel radius of points seen by one of `samples` paths over a picture.
pub(super) fn beam(camera: &Camera, resolution: [u32; 2], samples: u64) -> Beam {
    let [w, h] = resolution.map(f64::from);
    let pixel = camera.pixel_footprint();
    let scale = SPACINGS * (w * h / samples as f64).sqrt();
    Beam {
        width: pixel.width * scale,
        spread: pixel.spread * scale,
    }
}

/// Follows a camera ray to the first diffuse surface, where all photons are
/// looked up, and on to the next one, where those that bounced are.
pub(super) fn reach(ctx: &Context<'_>, ray: Ray, beam: Beam, stream: &mut Stream) -> Reached {
    let mut reached = [None; 2];
    let mut path = Walker::from_camera(ctx, ray);
    let (mut beam, mut before) = (beam, 0.0);
    for (i, place) in reached.iter_mut().enumerate() {
        let End::Surface {
            point,
            material: Material::Diffuse { reflectance },
        } = path.walk(ctx, stream, &mut |_| false)
        else {
            break;
        };
        let at = DiffusePoint::new(point, path.ray.dir, reflectance, path.media);
        path.throughput *= reflectance;
        let t = path.throughput.mean() * FRAC_1_PI;
        let radius = beam.width + beam.spread * (path.length - before);
        *place = Some(Photon {
            position: point.p,
            normal: at.ng,
            flux: Rgb::grey(t * t),
            footprint: Some(kernel(path.ray.dir, at.ng, radius)),
            bounced: i > 0,
            sheet: 0.0,
        });
        let local = warp::cosine_hemisphere(stream.next_2d());
        let dir = Frame::around(at.ns).to_world(local).normalize();
        if !ctx.plan.indirect() || dir.dot(at.ng) <= 0.0 {
            break;
        }
        path.ray = point.spawn(dir);
        before = path.length;
        beam = Beam {
            width: radius,
            spread: DIFFUSE_SPREAD,
        };
    }
    reached
}

/// The ellipse in which a beam of a radius, travelling along `d`, meets a
/// surface of normal `n`.
fn kernel(d: DVec3, n: DVec3, radius: f64) -> Footprint {
    let along = (d - n * d.dot(n)).try_normalize();
    let stretch = 1.0 / d.dot(n).abs().max(GRAZING);
    Footprint {
        major: along.unwrap_or_else(|| Frame::around(n).s) * (radius * stretch),
        minor: radius,
        fold: f64::INFINITY,
    }
}

/// Light of the picture, averaged over blocks of pixels.
pub(super) struct Blocks {
    /// Blocks across.
    across: usize,
    /// Side of a block in pixels.
    side: f64,
    /// Sum of the light found and number of samples.
    sums: Vec<(f64, u32)>,
}

impl Blocks {
    /// Samples per block.
    const SAMPLES: f64 = 16.0;

    /// Blocks for so many samples over a picture of so many pixels.
    pub(super) fn new(resolution: [u32; 2], samples: u64) -> Self {
        let [w, h] = resolution.map(f64::from);
        let side = (Self::SAMPLES * w * h / samples as f64).sqrt().max(1.0);
        let across = (w / side).ceil().max(1.0) as usize;
        let down = (h / side).ceil().max(1.0) as usize;
        Self {
            across,
            side,
            sums: vec![(0.0, 0); across * down],
        }
    }

    fn index(&self, film: DVec2) -> usize {
        let [x, y] = [film.x, film.y].map(|v| (v / self.side) as usize);
        (y * self.across + x.min(self.across - 1)).min(self.sums.len() - 1)
    }

    /// Adds a sample, if it is finite.
    pub(super) fn add(&mut self, film: DVec2, light: f64) {
        let i = self.index(film);
        if light.is_finite() {
            self.sums[i].0 += light;
            self.sums[i].1 += 1;
        }
    }

    /// The weights `1 / (L^2 + 0.01 mean^2)` by which errors are seen, as a
    /// function of the place; 1 everywhere in a black picture.
    pub(super) fn sight(&self) -> impl Fn(DVec2) -> f64 + '_ {
        let (sum, count) = self
            .sums
            .iter()
            .fold((0.0, 0), |(s, n), (light, k)| (s + light, n + k));
        let mean = sum / f64::from(count.max(1));
        move |film| {
            let (light, k) = self.sums[self.index(film)];
            let own = light / f64::from(k.max(1));
            let squared = own * own + 0.01 * mean * mean;
            if squared > 0.0 { 1.0 / squared } else { 1.0 }
        }
    }
}

/// Importance of a picture, ready to be asked.
pub(super) struct Importance {
    map: PhotonMap,
    /// The longest kernel, metres.
    longest: f64,
}

impl Importance {
    /// Of weighed points that `samples` camera paths over the whole picture
    /// reached.
    pub(super) fn new(points: &[Photon], samples: u64) -> Self {
        let lengths = points.iter().filter_map(|p| p.footprint);
        Self {
            map: PhotonMap::with_whole_kernels(points, samples),
            longest: lengths
                .map(|f| f.major.length())
                .filter(|length| length.is_finite())
                .fold(f64::MIN_POSITIVE, f64::max),
        }
    }

    /// Importance per m2 where a photon landed, for light of its kind. What
    /// lies behind a wall is not seen.
    pub(super) fn of(&self, scene: &Scene, photon: &Photon) -> f64 {
        let world = &scene.world;
        let walls = OnceCell::new();
        let is_wall = |i: u32| is_wall(&scene.objects[i as usize].material);
        self.weighed(photon, |offset| {
            let near = || world.neighbours(photon.position, self.longest, is_wall);
            let (walls, clear) = walls.get_or_init(near);
            let distance = offset.length();
            if distance <= *clear {
                return true;
            }
            // Above the surface itself, which is a wall, too.
            let start = photon.position + photon.normal * (LIFT * distance);
            let ray = Ray::new(start, offset / distance);
            !world.occluded_by(walls, &ray, distance)
        })
    }

    /// The same where `is_clear` says to which points, seen from the photon,
    /// the way is.
    fn weighed(&self, photon: &Photon, is_clear: impl Fn(DVec3) -> bool) -> f64 {
        let query = Query {
            p: photon.position,
            n: photon.normal,
            kernels: Kernels {
                least: 0.0,
                most: self.longest,
                most_bounced: self.longest,
                blind: 0.0,
                caustics: true,
                spacing: 0.0,
            },
        };
        let found = self.map.irradiance(&query, |offset, _| {
            [f64::from(u8::from(is_clear(offset))); 3]
        });
        let all = if photon.bounced {
            found.irradiance + found.bounced
        } else {
            found.irradiance
        };
        all.mean()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        plan::Plan,
        sampling::{Purpose, Sequence},
        scene::load_str,
        transport::LightPicker,
    };

    /// A camera that looks down on a square of 2 m.
    fn above() -> Camera {
        let (eye, up) = (DVec3::new(0.0, 0.0, 1.0), DVec3::Y);
        Camera::orthographic(eye, DVec3::ZERO, up, 2.0, [64, 64])
    }

    /// Points of weight 3 spread evenly over 4 m2: 3/4 a square metre. Those of
    /// reflected light count for such light alone.
    #[test]
    fn importance_is_weight_per_area() {
        let sequence = Sequence::new(1, Purpose::Pilot, 0, 0);
        let n = 1u64 << 13;
        let radius = beam(&above(), [64, 64], n).width;
        let photon = |p: DVec3, bounced| Photon {
            position: p,
            normal: DVec3::Z,
            flux: Rgb::grey(3.0),
            footprint: Some(kernel(DVec3::NEG_Z, DVec3::Z, radius)),
            bounced,
            sheet: 0.0,
        };
        let points: Vec<Photon> = (0..n)
            .flat_map(|i| {
                let [x, y] = sequence.at(i).next_2d().map(|u| 2.0 * u - 1.0);
                let p = DVec3::new(x, y, 0.0);
                [photon(p, false), photon(p, true)]
            })
            .collect();
        let importance = Importance::new(&points, n);
        for (x, y) in [(0.0, 0.0), (0.5, -0.3), (-0.71, 0.2)] {
            for (bounced, expected) in [(false, 0.75), (true, 1.5)] {
                let found = importance.weighed(&photon(DVec3::new(x, y, 0.0), bounced), |_| true);
                // A dozen low-discrepancy points make up the kernel.
                assert!(
                    (found / expected - 1.0).abs() < 0.25,
                    "{found}, {expected} expected at ({x}, {y})"
                );
            }
        }
        let outside = importance.weighed(&photon(DVec3::new(3.0, 0.0, 0.0), false), |_| true);
        assert_eq!(outside, 0.0, "not seen");
    }

    /// Light 2 in the left half, none in the right one: errors weigh as
    /// 1 / (L^2 + 0.01).
    #[test]
    fn errors_are_seen_against_the_light_around() {
        let mut blocks = Blocks::new([64, 48], 3072);
        for y in 0..48 {
            for x in 0..64 {
                let light = if x < 32 { 2.0 } else { 0.0 };
                let film = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                blocks.add(film, light);
            }
        }
        blocks.add(DVec2::ZERO, f64::NAN);
        let sight = blocks.sight();
        for (film, squared) in [([3.0, 40.0], 4.0), ([60.0, 47.9], 0.0)] {
            let expected = 1.0 / (squared + 0.01);
            let found = sight(DVec2::from(film));
            assert!((found / expected - 1.0).abs() < 1e-12, "{film:?}: {found}");
        }
        assert_eq!(Blocks::new([4, 4], 16).sight()(DVec2::ZERO), 1.0, "black");
    }

    /// Between a floor and a ceiling: the floor weighs (0.5 / pi)^2, the
    /// ceiling (0.5 * 0.4 / pi)^2 and only for reflected light.
    #[test]
    fn camera_paths_reach_two_surfaces() {
        let text = "(camera: (eye: (0, 0, 1), look_at: (0, 1, 0), up: (0, 0, 1), fov: 20),
          image: (width: 8, height: 8),
          materials: {\"floor\": Diffuse(reflectance: 0.5), \"ceiling\": Diffuse(reflectance: 0.4)},
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"floor\"),
            (shape: Plane(point: (0, 0, 3), normal: (0, 0, -1)), material: \"ceiling\"),
          ],
          lights: [Point(position: (0, 0, 2), power: 1)])";
        let scene = load_str(text, "test.ron", Path::new("")).expect("a scene");
        let (plan, picker) = (Plan::new(&scene, &scene.settings), LightPicker::new(&scene));
        let ctx = Context {
            scene: &scene,
            plan: &plan,
            picker: &picker,
            max_depth: 64,
        };
        let sequence = Sequence::new(1, Purpose::Pilot, 0, 0);
        for i in 0..20 {
            let ray = scene.camera.ray(DVec2::new(4.0, 4.0));
            let beam = beam(&scene.camera, scene.resolution, 64);
            let [first, second] =
                reach(&ctx, ray, beam, &mut sequence.at(i)).map(|p| p.expect("a surface"));
            let weight = |r: f64| (r * FRAC_1_PI).powi(2);
            assert!((first.flux[1] / weight(0.5) - 1.0).abs() < 1e-12);
            assert!((second.flux[1] / weight(0.2) - 1.0).abs() < 1e-12);
            assert_eq!((first.normal, second.normal), (DVec3::Z, DVec3::NEG_Z));
            assert!(!first.bounced && second.bounced);
        }
    }
}
