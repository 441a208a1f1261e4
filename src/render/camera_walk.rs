//! One camera sample: what is seen through one film position.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use crate::{
    camera::Footprint,
    film::{Layer, PixelSample},
    geometry::Ray,
    material::Material,
    numeric::Frame,
    photon::{Kernels, PhotonMap, gather},
    sampling::{Stream, warp},
    spectrum::Rgb,
    transport::{Context, DiffusePoint, End, Walker, direct_light},
};

/// Surfaces at which both the reflected and the refracted way are followed;
/// later ones toss a coin. The first glass surface shows the light's own
/// reflection, which a coin of a few per cent would turn into noise.
const SPLITS: u32 = 1;

/// First stream coordinate of a split's side path.
const SIDE_PATH: u32 = 24;

/// Shadow rays at the first diffuse surface: at least the first number, and
/// one to each light up to the second; fewer on a path that carries less. More
/// cost as much as they gain, but where penumbras fill the picture.
const SHADOW_RAYS: [usize; 2] = [2, 8];

/// Shadow rays at later diffuse surfaces.
const LATER_SHADOW_RAYS: u32 = 1;

/// Smallest and largest semi-axes of kernels over the round's scale: narrower
/// ones than the camera resolves bring only noise, in wider ones the
/// derivatives no longer hold. Light that was reflected after it was a caustic
/// varies slowly and is rare.
const LEAST: f64 = 0.125;
const MOST: f64 = 6.0;
const MOST_BOUNCED: f64 = 8.0;

/// Growth of a path's footprint after a diffuse bounce, in metres per metre:
/// the bounce averages over a wide cone, so the photons' light seen there may
/// be blurred over a small part of it.
const DIFFUSE_SPREAD: f64 = 0.01;

/// Bounces between diffuse surfaces before the roulette may end a path.
const SURE_BOUNCES: u32 = 2;

/// What a camera path may ask during one pass.
#[derive(Clone, Copy)]
pub(super) struct Gather<'a> {
    pub(super) ctx: Context<'a>,
    /// The pass's photons; `None` where no caustics are simulated.
    pub(super) map: Option<&'a PhotonMap>,
    /// Kernel scale of the round in footprints.
    pub(super) scale: f64,
    pub(super) footprint: Footprint,
}

/// What came of a camera sample besides its light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CameraTally {
    pub(super) truncated: u64,
    pub(super) queries: u64,
    pub(super) visited: u64,
    pub(super) accepted: u64,
}

impl Gather<'_> {
    /// Light through a film position, by layer.
    pub(super) fn sample(
        &self,
        ray: Ray,
        stream: &mut Stream,
        tally: &mut CameraTally,
    ) -> PixelSample {
        let mut sample = PixelSample::default();
        let mut pending = vec![(Walker::new(ray), SPLITS)];
        let first = stream.dimension();
        let mut side_paths = 0;
        while let Some((mut walker, splits)) = pending.pop() {
            stream.seek(first + side_paths * SIDE_PATH);
            side_paths += 1;
            let end = walker.walk(&self.ctx, stream, splits, &mut |other, left| {
                pending.push((other, left));
            });
            self.finish(&walker, end, stream, &mut sample, tally);
        }
        sample
    }

    /// Adds what a walk from the eye ends at.
    fn finish(
        &self,
        walker: &Walker,
        end: End,
        stream: &mut Stream,
        sample: &mut PixelSample,
        tally: &mut CameraTally,
    ) {
        match end {
            End::Escaped => {
                for &sun in &self.ctx.plan.suns {
                    let light = &self.ctx.scene.lights[sun as usize].light;
                    sample[Layer::Emission] +=
                        walker.throughput * light.sky_radiance(walker.ray.dir);
                }
            }
            End::Truncated => tally.truncated += 1,
            End::Surface {
                point,
                material: Material::Diffuse { reflectance },
            } => {
                let at = DiffusePoint::new(point, walker.ray.dir, reflectance);
                let width = self.footprint.width + self.footprint.spread * walker.length;
                let strength = walker.throughput.max().min(1.0);
                let [least, most] = SHADOW_RAYS;
                let rays = self.ctx.scene.lights.len().clamp(least, most) as f64;
                let rays = (rays * strength).ceil() as u32;
                let direct = direct_light(&self.ctx, &at, stream, rays);
                sample[Layer::Direct] += walker.throughput * direct;
                let [caustic, bounced] = self.gathered(&at, width, true, stream, tally);
                sample[Layer::Caustic] += walker.throughput * caustic;
                if self.ctx.plan.indirect {
                    sample[Layer::Indirect] += walker.throughput * bounced;
                    // A path that carries little goes on as seldom.
                    if stream.next_1d() < strength {
                        let path = Walker {
                            throughput: walker.throughput * reflectance / strength,
                            ..*walker
                        };
                        sample[Layer::Indirect] += self.indirect(path, at, stream, tally);
                    }
                }
            }
            End::Surface { point, .. } => {
                if let Some(light) = self.ctx.scene.object(point.surface).light {
                    let cos = -point.ng.dot(walker.ray.dir);
                    let radiance = self.ctx.scene.lights[light as usize]
                        .light
                        .surface_radiance(cos);
                    sample[Layer::Emission] += walker.throughput * radiance;
                }
            }
        }
    }

    /// Reflected radiance of the light in the photon map, for a footprint of
    /// the given width in metres: first of photons that came from their light
    /// through specular steps alone, then of those that bounced once.
    fn gathered(
        &self,
        at: &DiffusePoint,
        width: f64,
        caustics: bool,
        stream: &mut Stream,
        tally: &mut CameraTally,
    ) -> [Rgb; 2] {
        let Some(map) = self.map else {
            return [Rgb::BLACK; 2];
        };
        let unit = self.scale * width;
        let kernels = Kernels {
            least: LEAST * unit,
            most: MOST * unit,
            most_bounced: MOST_BOUNCED * unit,
            blind: unit,
            caustics,
        };
        let found = gather(&self.ctx, map, at, &kernels, stream.next_1d());
        tally.queries += 1;
        tally.visited += u64::from(found.visited);
        tally.accepted += u64::from(found.accepted);
        [found.irradiance, found.bounced].map(|e| at.reflectance * e * FRAC_1_PI)
    }

    /// Light from further diffuse surfaces, by path tracing; `path` has just
    /// been reflected at `at`, its reflectance already in the throughput.
    fn indirect(
        &self,
        mut path: Walker,
        mut at: DiffusePoint,
        stream: &mut Stream,
        tally: &mut CameraTally,
    ) -> Rgb {
        let mut sum = Rgb::BLACK;
        let mut bounces = 0;
        // Footprints are wide after a diffuse bounce, whatever they were.
        let mut width = self.footprint.width + self.footprint.spread * path.length;
        loop {
            let Some(dir) = bounce_direction(&at, stream) else {
                return sum;
            };
            let before = path.length;
            path.ray = at.point.spawn(dir);
            let end = path.walk(&self.ctx, stream, 0, &mut |_, _| {});
            let (point, reflectance) = match end {
                End::Surface {
                    point,
                    material: Material::Diffuse { reflectance },
                } => (point, reflectance),
                End::Truncated => {
                    tally.truncated += 1;
                    return sum;
                }
                // Lights are sampled directly: meeting one adds nothing.
                End::Surface { .. } | End::Escaped => return sum,
            };
            width += DIFFUSE_SPREAD * (path.length - before);
            at = DiffusePoint::new(point, path.ray.dir, reflectance);
            // The caustic itself, as light for the surface before, has come
            // there as photons that bounced here.
            let [_, bounced] = self.gathered(&at, width, false, stream, tally);
            let found = direct_light(&self.ctx, &at, stream, LATER_SHADOW_RAYS) + bounced;
            sum += path.throughput * found;
            path.throughput *= reflectance;
            bounces += 1;
            if path.depth >= self.ctx.max_depth {
                tally.truncated += 1;
                return sum;
            }
            if bounces >= SURE_BOUNCES {
                let q = path.throughput.max().min(0.95);
                if stream.next_1d() >= q {
                    return sum;
                }
                path.throughput = path.throughput / q;
            }
        }
    }
}

/// A cosine-weighted direction on the viewer's side; `None` where the shading
/// normal would send it into the surface.
fn bounce_direction(at: &DiffusePoint, stream: &mut Stream) -> Option<DVec3> {
    let local = warp::cosine_hemisphere(stream.next_2d());
    let dir = Frame::around(at.ns).to_world(local).normalize();
    (dir.dot(at.ng) > 0.0).then_some(dir)
}
