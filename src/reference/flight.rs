//! From one place of a path to the next where something happens. The only
//! file of this room that asks how light goes on at a specular surface.

use glam::DVec3;

use crate::{
    geometry::{Ray, SurfacePoint},
    light::{DirectSample, Source},
    material::Material,
    numeric::Frame,
    plan::Media,
    sampling::warp,
    spectrum::Rgb,
    transport::{Carried, Context, DiffusePoint, Lobe, lobes, media_beside, meet, transmittance},
};

use super::{
    random::{Layout, Random},
    sources::Start,
};

/// The most diffuse surfaces that a path meets on average, where none reflects
/// more than `reflectance`: two for sure, then as long as the roulette lets it
/// go on, which goes by what two have left at first and by one after that.
pub(super) fn mean_bounces(reflectance: f64) -> f64 {
    let survives = |strength: f64| strength.min(MOST_SURVIVING);
    let first = survives(reflectance * reflectance);
    f64::from(SURE_BOUNCES) + first / (1.0 - survives(reflectance))
}

/// Diffuse surfaces on a path before the roulette may end it.
const SURE_BOUNCES: u32 = 2;

/// Largest chance of surviving the roulette.
const MOST_SURVIVING: f64 = 0.95;

/// What a path meets.
pub(super) enum Met {
    /// Nothing more: it left the scene.
    Sky,
    /// The end of what is followed: the depth limit, or a surface that
    /// reflects nothing.
    End,
    /// A mirror or glass; the path has been sent on along the lobe.
    Bent {
        /// Where.
        point: SurfacePoint,
        /// How it goes on.
        lobe: Lobe,
        /// The direction in which it came.
        from: DVec3,
    },
    /// A diffuse surface.
    Diffuse(DiffusePoint),
    /// The body of a light, given by its index.
    Light { point: SurfacePoint, light: usize },
}

/// A path in mid-air.
pub(super) struct Flight {
    pub(super) ray: Ray,
    /// Factor on what is carried.
    pub(super) throughput: Rgb,
    /// Length of the way so far, in metres.
    pub(super) way: f64,
    /// The largest channel of the throughput since the start, without the
    /// index factors: what the roulette goes by.
    strength: f64,
    /// Surfaces met so far, also those that were crossed in a straight line.
    pub(super) depth: u32,
    /// Diffuse surfaces left so far.
    pub(super) bounces: u32,
    /// The bodies of clear media around it.
    media: Media,
    carried: Carried,
    layout: Layout,
}

impl Flight {
    /// A path from the eye.
    pub(super) fn from_camera(ctx: &Context<'_>, ray: Ray) -> Self {
        let media = match &ctx.plan.nest {
            Some(nested) => nested.starts.camera.at(&ctx.scene.world, ray.origin),
            None => Media::NONE,
        };
        Self {
            ray,
            media,
            throughput: Rgb::WHITE,
            way: 0.0,
            strength: 1.0,
            depth: 0,
            bounces: 0,
            carried: Carried::Radiance,
            layout: Layout::CAMERA,
        }
    }

    /// A path from a light.
    pub(super) fn from_light(ctx: &Context<'_>, start: &Start) -> Self {
        let ray = start.ray;
        let media = match &ctx.plan.nest {
            Some(nested) => nested.starts.lights[start.light].at(&ctx.scene.world, ray.origin),
            None => Media::NONE,
        };
        Self {
            throughput: start.flux,
            media,
            carried: Carried::Flux,
            layout: Layout::LIGHT,
            ..Self::from_camera(ctx, ray)
        }
    }

    /// A path that carries `flux` off a surface outside all bodies of clear
    /// media.
    pub(super) fn from_surface(ray: Ray, flux: Rgb) -> Self {
        Self {
            ray,
            throughput: flux,
            way: 0.0,
            strength: 1.0,
            depth: 0,
            bounces: 0,
            media: Media::NONE,
            carried: Carried::Flux,
            layout: Layout::LIGHT,
        }
    }

    /// What the path carries.
    pub(super) fn carried(&self) -> Carried {
        self.carried
    }

    /// Flies to the next place where something happens; what lets light
    /// through in a straight line is passed. `random` is left at the
    /// coordinates of the surface that was met.
    pub(super) fn next(&mut self, ctx: &Context<'_>, random: &mut impl Random) -> Met {
        loop {
            let Some(met) = meet(ctx, &self.ray, f64::INFINITY, &mut self.media) else {
                return Met::Sky;
            };
            self.depth += 1;
            self.way += met.hit.t;
            random.seek(self.layout.surface(self.depth));
            let (point, from) = (met.point, self.ray.dir);
            let Some(lobes) = lobes(&met.material, &point, from, self.carried) else {
                return match (met.material, ctx.scene.object(point.surface).light) {
                    (Material::Diffuse { reflectance }, _) => {
                        Met::Diffuse(DiffusePoint::new(point, from, reflectance, self.media))
                    }
                    (_, Some(light)) => Met::Light {
                        point,
                        light: light as usize,
                    },
                    _ => Met::End,
                };
            };
            if self.depth >= ctx.max_depth {
                return Met::End;
            }
            let lobe = lobes.choose(|| random.next_1d());
            self.throughput *= lobe.weight;
            self.strength *= lobe.weight.max() / lobe.index;
            self.ray = point.spawn(lobe.dir);
            self.media = media_beside(ctx, self.media, &point, lobe.dir);
            if self.throughput.is_black() {
                return Met::End;
            }
            if lobe.is_bent() {
                return Met::Bent { point, lobe, from };
            }
        }
    }

    /// Goes on from a diffuse surface in a random direction; `false` if the
    /// path ends there. Follows [`Met::Diffuse`] at once. The density of the
    /// direction is what [`density`] says.
    pub(super) fn bounce(
        &mut self,
        ctx: &Context<'_>,
        at: &DiffusePoint,
        random: &mut impl Random,
    ) -> bool {
        let around = match self.carried {
            Carried::Radiance => at.ns,
            Carried::Flux => {
                self.throughput *= landing(at, self.ray.dir);
                at.ng
            }
        };
        let local = warp::cosine_hemisphere(random.next_2d());
        let roulette = random.next_1d();
        let dir = Frame::around(around).to_world(local).normalize();
        self.throughput *= at.reflectance;
        self.strength *= at.reflectance.max();
        self.bounces += 1;
        let goes_on = self.depth < ctx.max_depth
            && dir.dot(at.ng) > 0.0
            && dir.dot(around) > 0.0
            && !self.throughput.is_black();
        if goes_on && self.bounces >= SURE_BOUNCES {
            let q = self.strength.min(MOST_SURVIVING);
            if roulette >= q {
                return false;
            }
            self.throughput = self.throughput / q;
            self.strength /= q;
        }
        self.ray = at.point.spawn(dir);
        goes_on
    }
}

/// Density per solid angle with which a path that carries `carried` leaves a
/// diffuse point in unit direction `w`.
pub(super) fn density(at: &DiffusePoint, w: DVec3, carried: Carried) -> f64 {
    let normal = match carried {
        Carried::Radiance => at.ns,
        Carried::Flux => at.ng,
    };
    if w.dot(at.ng) > 0.0 {
        warp::cosine_hemisphere_pdf(w.dot(normal))
    } else {
        0.0
    }
}

/// Factor on the flux that lands on a smooth surface along `d`: the light is
/// reflected about the shading normal (Veach 1997, section 5.3).
pub(super) fn landing(at: &DiffusePoint, d: DVec3) -> f64 {
    let factor = d.dot(at.ns) / d.dot(at.ng);
    if factor.is_finite() {
        factor.max(0.0)
    } else {
        0.0
    }
}

/// Fraction of the light of `source` that arrives at `from` in a straight
/// line. `body` is the instance that shows the light, if it is one.
pub(super) fn arriving(
    ctx: &Context<'_>,
    from: &DiffusePoint,
    source: Source,
    wi: DVec3,
    body: Option<u32>,
) -> f64 {
    let sample = DirectSample {
        source,
        wi,
        weight: Rgb::WHITE,
    };
    transmittance(ctx, &from.point, &from.media, &sample, body)
}

/// The same between two diffuse points; `w` is the unit direction from the
/// first to the second.
pub(super) fn between(ctx: &Context<'_>, a: &DiffusePoint, b: &DiffusePoint, w: DVec3) -> f64 {
    // A ray from each to the middle: where a ray from one end meets the
    // surface of the other is known less well than the ends themselves.
    let middle = Source::Point(a.point.p + (b.point.p - a.point.p) * 0.5);
    let first = arriving(ctx, a, middle, w, None);
    if first == 0.0 {
        return 0.0;
    }
    first * arriving(ctx, b, middle, -w, None)
}
