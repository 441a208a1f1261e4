//! One camera sample: what is seen through one film position.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use crate::{
    camera::Footprint,
    film::{Layer, PixelSample},
    geometry::{Ray, SurfacePoint},
    material::Material,
    numeric::Frame,
    photon::{PhotonMap, gather},
    sampling::{Stream, warp},
    spectrum::Rgb,
    transport::{Context, DiffusePoint, End, Walker, direct_light},
};

use super::coordinates;

/// Where light divides, both ways are followed while the weaker one keeps more
/// than this strength; below, a coin decides. A light that is seen by way of
/// weak reflections inside glass is then found by every sample that could, and
/// weighs little, instead of by few with the weight of all.
const SPLIT_ABOVE: f64 = 0.01;

/// Ends of the view weaker than this are shaded only now and then, with this
/// strength: what they show differs less from its surroundings than lights do,
/// and shading costs more than the way there.
const SHADE_ABOVE: f64 = 0.25;

/// Ways of the view that may wait to be followed; beyond, coins decide. Ways
/// share the strength 1, so this many are rare.
const PENDING: usize = 16;

/// Shadow rays at the first diffuse surface: at least the first number, and
/// one to each light up to the second; fewer on a path that carries less. More
/// cost as much as they gain, but where penumbras fill the picture.
const SHADOW_RAYS: [usize; 2] = [2, 8];

/// Shadow rays at later diffuse surfaces.
const LATER_SHADOW_RAYS: u32 = 1;

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
    /// Kernel radius in footprints.
    pub(super) scale: f64,
    pub(super) footprint: Footprint,
}

/// What came of a camera sample besides its light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CameraTally {
    /// Rays cast, to surfaces and to lights.
    pub(super) rays: u64,
    pub(super) truncated: u64,
    pub(super) queries: u64,
    pub(super) visited: u64,
}

/// Ways of the view that wait to be followed.
struct Pending {
    walkers: [Option<Walker>; PENDING],
    count: usize,
}

impl Pending {
    /// Takes a way if it is worth it and there is room.
    fn take(&mut self, walker: &Walker) -> bool {
        let taken = walker.strength > SPLIT_ABOVE && self.count < PENDING;
        if taken {
            self.walkers[self.count] = Some(*walker);
            self.count += 1;
        }
        taken
    }

    /// The way that was taken last.
    fn next(&mut self) -> Option<Walker> {
        self.count = self.count.checked_sub(1)?;
        self.walkers[self.count].take()
    }
}

/// Decides which ends of the view are shaded: strong ones always, of weak ones
/// a systematic sample. Every end is shaded with its strength on average.
struct Picker {
    /// Strength of the weak ends since the last that was shaded, in units of
    /// [`SHADE_ABOVE`]; starts anywhere between 0 and 1.
    owed: f64,
    /// Ends shaded so far.
    shaded: u32,
}

impl Picker {
    /// The number of the shaded end and the strength with which it is shaded;
    /// `None` where it is passed over.
    fn pick(&mut self, strength: f64) -> Option<(u32, f64)> {
        let mut shaded_as = strength;
        if strength < SHADE_ABOVE {
            self.owed += strength / SHADE_ABOVE;
            if self.owed < 1.0 {
                return None;
            }
            self.owed -= 1.0;
            shaded_as = SHADE_ABOVE;
        }
        let k = self.shaded;
        self.shaded += 1;
        Some((k, shaded_as))
    }
}

impl Gather<'_> {
    /// Light through a film position, by layer.
    pub(super) fn sample(
        &self,
        ray: Ray,
        stream: &Stream,
        tally: &mut CameraTally,
    ) -> PixelSample {
        let mut sample = PixelSample::default();
        let mut pending = Pending {
            walkers: [None; PENDING],
            count: 0,
        };
        let mut picker = Picker {
            owed: coordinates::pick(stream),
            shaded: 0,
        };
        let mut coins = coordinates::coins(stream);
        let mut next = Some(Walker::new(ray));
        while let Some(mut walker) = next {
            let before = walker.depth;
            let end = walker.walk(&self.ctx, &mut coins, &mut |other| pending.take(other));
            tally.rays += u64::from(walker.depth - before) + 1;
            match end {
                End::Escaped => sample[Layer::Emission] += self.sky(&walker),
                End::Truncated => tally.truncated += 1,
                End::Surface {
                    point,
                    material: Material::Diffuse { reflectance },
                } => {
                    if let Some((k, strength)) = picker.pick(walker.strength) {
                        walker.throughput *= strength / walker.strength;
                        walker.strength = strength;
                        let at = DiffusePoint::new(point, walker.ray.dir, reflectance);
                        self.shade(&walker, &at, stream, k, &mut sample, tally);
                    }
                }
                End::Surface { point, .. } => {
                    sample[Layer::Emission] += self.emitted(&walker, &point);
                }
            }
            next = pending.next();
        }
        sample
    }

    /// What an escaped walk sees of the suns.
    fn sky(&self, walker: &Walker) -> Rgb {
        let mut sum = Rgb::BLACK;
        for &sun in &self.ctx.plan.suns {
            let light = &self.ctx.scene.lights[sun as usize].light;
            sum += walker.throughput * light.sky_radiance(walker.ray.dir);
        }
        sum
    }

    /// What a walk that ends on a black body sees there.
    fn emitted(&self, walker: &Walker, point: &SurfacePoint) -> Rgb {
        let Some(light) = self.ctx.scene.object(point.surface).light else {
            return Rgb::BLACK;
        };
        let light = &self.ctx.scene.lights[light as usize].light;
        walker.throughput * light.surface_radiance(-point.ng.dot(walker.ray.dir))
    }

    /// Adds what a walk from the eye sees at a diffuse point, end `k` of its
    /// sample.
    fn shade(
        &self,
        walker: &Walker,
        at: &DiffusePoint,
        stream: &Stream,
        k: u32,
        sample: &mut PixelSample,
        tally: &mut CameraTally,
    ) {
        let mut here = coordinates::shading(stream, k);
        let (bounce, goes_on) = (here.next_2d(), here.next_1d());
        let width = self.footprint.width + self.footprint.spread * walker.length;
        let [caustic, bounced] = self.gathered(at, width, &mut here, tally);
        sample[Layer::Caustic] += walker.throughput * caustic;
        let [least, most] = SHADOW_RAYS;
        let rays = self.ctx.scene.lights.len().clamp(least, most) as f64;
        let rays = (rays * walker.strength).ceil() as u32;
        tally.rays += u64::from(rays);
        let direct = direct_light(&self.ctx, at, &mut here, rays);
        sample[Layer::Direct] += walker.throughput * direct;
        if !self.ctx.plan.indirect {
            return;
        }
        sample[Layer::Indirect] += walker.throughput * bounced;
        // A path that carries little goes on as seldom.
        if goes_on < walker.strength {
            let factor = at.reflectance / walker.strength;
            let path = Walker {
                throughput: walker.throughput * factor,
                strength: at.reflectance.max(),
                ..*walker
            };
            let mut beyond = coordinates::path(stream, k);
            sample[Layer::Indirect] += self.indirect(path, *at, bounce, &mut beyond, tally);
        }
    }

    /// Reflected radiance of the light in the photon map, for a footprint of
    /// the given width in metres: first of photons that came from their light
    /// through specular steps alone, then of those that bounced once.
    fn gathered(
        &self,
        at: &DiffusePoint,
        width: f64,
        stream: &mut Stream,
        tally: &mut CameraTally,
    ) -> [Rgb; 2] {
        let Some(map) = self.map else {
            return [Rgb::BLACK; 2];
        };
        let found = gather(&self.ctx, map, at, self.scale * width, stream.next_1d());
        tally.queries += 1;
        tally.visited += u64::from(found.visited);
        [found.irradiance, found.bounced].map(|e| at.reflectance * e * FRAC_1_PI)
    }

    /// Light from further diffuse surfaces, by path tracing; `path` has just
    /// been reflected at `at`, its reflectance already in the throughput, into
    /// the direction that `bounce` stands for.
    fn indirect(
        &self,
        mut path: Walker,
        mut at: DiffusePoint,
        mut bounce: [f64; 2],
        stream: &mut Stream,
        tally: &mut CameraTally,
    ) -> Rgb {
        let mut sum = Rgb::BLACK;
        let mut bounces = 0;
        // Footprints are wide after a diffuse bounce, whatever they were.
        let mut width = self.footprint.width + self.footprint.spread * path.length;
        loop {
            let Some(dir) = bounce_direction(&at, bounce) else {
                return sum;
            };
            let before = path;
            path.ray = at.point.spawn(dir);
            let end = path.walk(&self.ctx, stream, &mut |_| false);
            tally.rays += u64::from(path.depth - before.depth) + 1;
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
            width += DIFFUSE_SPREAD * (path.length - before.length);
            at = DiffusePoint::new(point, path.ray.dir, reflectance);
            // The caustic itself, as light for the surface before, has come
            // there as photons that bounced here.
            let [_, bounced] = self.gathered(&at, width, stream, tally);
            tally.rays += u64::from(LATER_SHADOW_RAYS);
            let found = direct_light(&self.ctx, &at, stream, LATER_SHADOW_RAYS) + bounced;
            sum += path.throughput * found;
            path.throughput *= reflectance;
            path.strength *= reflectance.max();
            bounces += 1;
            if path.depth >= self.ctx.max_depth {
                tally.truncated += 1;
                return sum;
            }
            if bounces >= SURE_BOUNCES {
                let q = path.strength.min(0.95);
                if stream.next_1d() >= q {
                    return sum;
                }
                path.throughput = path.throughput / q;
                path.strength /= q;
            }
            bounce = stream.next_2d();
        }
    }
}

/// A cosine-weighted direction on the viewer's side; `None` where the shading
/// normal would send it into the surface.
fn bounce_direction(at: &DiffusePoint, u: [f64; 2]) -> Option<DVec3> {
    let local = warp::cosine_hemisphere(u);
    let dir = Frame::around(at.ns).to_world(local).normalize();
    (dir.dot(at.ng) > 0.0).then_some(dir)
}
