//! One camera sample: what is seen through one film position.

use std::f64::consts::FRAC_1_PI;

use crate::{
    built,
    camera::Footprint,
    film::{Layer, PixelSample},
    geometry::Ray,
    material::Material,
    photon::{Kernels, PhotonMap, Vicinity, gather},
    sampling::Stream,
    spectrum::Rgb,
    transport::{Context, DiffusePoint, End, Walker, direct_light},
};

use super::{
    bounce::Bounces,
    coordinates,
    glints::{self, Glints, WAYS},
    tally::CameraTally,
    view::view,
};

/// Where light divides, both ways are followed at the first surface, and later
/// while the weaker way is stronger than this; below, a coin decides. Every
/// single reflection in glass or water is then seen by all samples, with
/// little weight, instead of by few with the weight of all.
pub(super) const SPLIT_ABOVE: f64 = 0.03;

/// Shadow rays at the first diffuse surface: at least the first number, and
/// one to each light up to the second; fewer on a path that carries less. More
/// cost as much as they gain, but where penumbras fill the picture.
const SHADOW_RAYS: [usize; 2] = [2, MOST_SHADOW_RAYS];
pub(super) const MOST_SHADOW_RAYS: usize = 8;

/// Smallest and largest semi-axes of kernels over the round's scale, which
/// begins with two pixels' footprints: much narrower ones than the camera resolves bring
/// only noise, but a third of a pixel already leaves more error around a fold; in wider ones than
/// the largest the derivatives no longer hold. Light that was reflected after it was a caustic
/// comes from everywhere: wide kernels of it would meet in every point.
const LEAST: f64 = 0.08;
const MOST: f64 = 6.0;
const MOST_BOUNCED: f64 = 2.0;

/// Sheets of light are counted where a path ends that carries more than this: of
/// the ways that a sample divides into, one.
const STRONG: f64 = 0.5;

/// What a camera path may ask during one pass.
#[derive(Clone, Copy)]
pub(super) struct Gather<'a> {
    pub(super) ctx: Context<'a>,
    /// The pass's photons; `None` where no caustics are simulated.
    pub(super) map: Option<&'a PhotonMap>,
    /// Kernel scale of the round in footprints.
    pub(super) scale: f64,
    pub(super) footprint: Footprint,
    /// Whether it is found out what narrower kernels find.
    pub(super) draws_in: bool,
    /// How paths go on after their first diffuse surface.
    pub(super) bounces: &'a Bounces,
}

/// What the photons bring at a point: light of caustics, and light reflected
/// after it was one.
#[derive(Clone, Copy, Default)]
pub(super) struct Found {
    pub(super) light: [Rgb; 2],
    /// See [`Gathered::sheets`](crate::photon::Gathered::sheets), and those of narrower
    /// kernels.
    sheets: f64,
    narrower_sheets: [f64; 2],
    narrower: [[f64; 2]; 2],
}

impl Found {
    /// What one kind of light loses when kernels are drawn in, as
    /// [`PixelSample::blur`] has it.
    pub(super) fn blur(&self, kind: usize, throughput: Rgb) -> [f64; 2] {
        let light = (throughput * self.light[kind]).mean();
        let [half, quarter] = self.narrower[kind];
        [light * (1.0 - half), light * (half - quarter)]
    }
}

pub(super) fn add_blur(sum: &mut [f64; 2], more: [f64; 2]) {
    for (s, m) in sum.iter_mut().zip(more) {
        *s += m;
    }
}

impl<'a> Gather<'a> {
    /// Asks the photons for samples that follow each other closely.
    pub(super) fn vicinity(&self) -> Option<Vicinity<'a>> {
        let map = self.map.filter(|_| built::CAUSTICS);
        map.map(if self.draws_in {
            Vicinity::drawing_in
        } else {
            Vicinity::new
        })
    }

    /// Light through a film position, by layer.
    pub(super) fn sample(
        &self,
        ray: Ray,
        stream: &Stream,
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> PixelSample {
        let mut sample = PixelSample::default();
        let mut ends = 0;
        let coins = coordinates::coins(stream);
        view(
            &self.ctx,
            ray,
            SPLIT_ABOVE,
            coins,
            tally,
            |walker, end, tally| match end {
                End::Truncated => tally.truncated += 1,
                End::Surface {
                    point,
                    material: Material::Diffuse { reflectance },
                } => {
                    let at = DiffusePoint::new(*point, walker.ray.dir, *reflectance, walker.media);
                    let found = self.shade(walker, &at, stream, ends, vicinity, tally);
                    sample += found;
                    ends += 1;
                }
                End::Escaped | End::Surface { .. } => {
                    sample[Layer::Emission] += self.source(walker, end);
                }
            },
        );
        sample
    }

    /// Light of the sources that are seen through a film position, directly
    /// or by way of mirrors and glass: the layer `emission` alone.
    pub(super) fn sources(&self, ray: Ray, stream: &Stream, tally: &mut CameraTally) -> Rgb {
        let mut sum = Rgb::BLACK;
        let coins = coordinates::coins(stream);
        view(
            &self.ctx,
            ray,
            SPLIT_ABOVE,
            coins,
            tally,
            |walker, end, _| sum += self.source(walker, end),
        );
        sum
    }

    /// How near to a source the ways through a film position pass, in radii: in the
    /// order in which they come to their ends, which is the same for positions
    /// whose ways do the same.
    pub(super) fn distances_to(&self, glints: &Glints, ray: Ray, stream: &Stream) -> [f64; WAYS] {
        let mut found = [f64::INFINITY; WAYS];
        let mut ends = 0;
        let coins = coordinates::coins(stream);
        view(
            &self.ctx,
            ray,
            glints::PILOT_SPLIT_ABOVE,
            coins,
            &mut CameraTally::default(),
            |walker, end, _| {
                if let Some(found) = found.get_mut(ends) {
                    *found = glints.distance(walker, end);
                }
                ends += 1;
            },
        );
        found
    }

    /// What a walk sees of a source at its end.
    pub(super) fn source(&self, walker: &Walker, end: &End) -> Rgb {
        if !built::SOURCES {
            return Rgb::BLACK;
        }
        let lights = &self.ctx.scene.lights;
        let radiance = match end {
            End::Escaped => {
                let suns = self.ctx.plan.suns.iter();
                suns.fold(Rgb::BLACK, |sum, &sun| {
                    sum + lights[sun as usize].light.sky_radiance(walker.ray.dir)
                })
            }
            End::Surface { point, .. } => match self.ctx.scene.object(point.surface).light {
                Some(light) => {
                    let cos = -point.ng.dot(walker.ray.dir);
                    lights[light as usize].light.surface_radiance(cos)
                }
                None => Rgb::BLACK,
            },
            End::Truncated => Rgb::BLACK,
        };
        walker.throughput * radiance
    }

    /// Shadow rays at the end of a walk from the eye.
    pub(super) fn shadow_rays(&self, walker: &Walker) -> u32 {
        let [least, most] = SHADOW_RAYS;
        let rays = self.ctx.scene.lights.len().clamp(least, most) as f64;
        (rays * walker.strength).ceil() as u32
    }

    /// What a walk from the eye sees at a diffuse point, end `k` of its sample.
    pub(super) fn shade(
        &self,
        walker: &Walker,
        at: &DiffusePoint,
        stream: &Stream,
        k: u32,
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> PixelSample {
        if self.ctx.plan.indirect() {
            self.shade_with::<true>(walker, at, stream, k, vicinity, tally)
        } else {
            self.shade_with::<false>(walker, at, stream, k, vicinity, tally)
        }
    }

    /// The same, where light between diffuse surfaces is followed or not.
    #[inline]
    fn shade_with<const INDIRECT: bool>(
        &self,
        walker: &Walker,
        at: &DiffusePoint,
        stream: &Stream,
        k: u32,
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> PixelSample {
        let mut sample = PixelSample::default();
        let mut here = coordinates::shading(stream, k);
        // Numbers that nobody needs are passed over: others keep their meaning.
        let further = if INDIRECT {
            Some((here.next_2d(), here.next_1d()))
        } else {
            here.skip(3);
            None
        };
        let found = if vicinity.is_some() {
            let width = self.footprint.width + self.footprint.spread * walker.length;
            let found = self.gathered(at, width, true, &mut here, vicinity, tally);
            sample[Layer::Caustic] += walker.throughput * found.light[0];
            if walker.strength > STRONG {
                let weight = (walker.throughput * at.reflectance).mean();
                sample.sheets[0][0] += weight * found.sheets;
                sample.sheets[0][1] += weight;
                if self.draws_in {
                    let [half, quarter] = found.narrower_sheets;
                    let steps = [found.sheets - half, half - quarter];
                    sample.sheet_steps = steps.map(|step| weight * step);
                }
            }
            if self.draws_in {
                sample.blur = found.blur(0, walker.throughput);
            }
            found
        } else {
            here.skip(1);
            Found::default()
        };
        let rays = self.shadow_rays(walker);
        tally.rays += u64::from(rays);
        let direct = direct_light(&self.ctx, at, &mut here, rays);
        sample[Layer::Direct] += walker.throughput * direct;
        let Some((bounce, goes_on)) = further else {
            return sample;
        };
        sample[Layer::Indirect] += walker.throughput * found.light[1];
        if self.draws_in {
            add_blur(&mut sample.blur, found.blur(1, walker.throughput));
        }
        // A path that carries little goes on as seldom.
        if goes_on < walker.strength
            && let Some(bounce) = self.bounces.direction(at, bounce)
        {
            let path = Walker {
                throughput: walker.throughput * at.reflectance / walker.strength,
                strength: at.reflectance.max(),
                ..*walker
            };
            let streams = [coordinates::path(stream, k), coordinates::aside(stream, k)];
            let before = *tally;
            let (light, blur) = self.indirect(path, at, &bounce, streams, vicinity, tally);
            sample[Layer::Indirect] += light;
            add_blur(&mut sample.blur, blur);
            tally.beyond += tally.work_since(&before);
        }
        sample
    }

    /// What a walk from the eye sees at a diffuse point of light that comes there
    /// without a bounce of the path.
    pub(super) fn seen(
        &self,
        walker: &Walker,
        at: &DiffusePoint,
        here: &mut Stream,
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> Rgb {
        let width = self.footprint.width + self.footprint.spread * walker.length;
        let [caustics, bounced] = self.gathered(at, width, true, here, vicinity, tally).light;
        let rays = self.shadow_rays(walker);
        tally.rays += u64::from(rays);
        let direct = direct_light(&self.ctx, at, here, rays);
        walker.throughput * (caustics + bounced + direct)
    }

    /// Reflected radiance of the light in the photon map at a point that the
    /// camera has `seen`, or that a path has reached, for a footprint of the
    /// given width in metres: first of photons that came from their light
    /// through specular steps alone, then of those that bounced once.
    pub(super) fn gathered(
        &self,
        at: &DiffusePoint,
        width: f64,
        seen: bool,
        stream: &mut Stream,
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> Found {
        let Some(vicinity) = vicinity.as_mut().filter(|_| built::CAUSTICS) else {
            stream.skip(1);
            return Found::default();
        };
        let unit = self.scale * width;
        let kernels = Kernels {
            least: LEAST * unit,
            most: MOST * unit,
            most_bounced: MOST_BOUNCED * unit,
            blind: unit,
            caustics: seen,
            // The next pixel sees a point near by; paths scatter.
            spacing: if seen { width } else { 0.0 },
        };
        let found = gather(&self.ctx, vicinity, at, &kernels, stream.next_1d());
        tally.queries += 1;
        tally.visited += u64::from(found.visited);
        tally.tested += u64::from(found.tested);
        tally.accepted += u64::from(found.accepted);
        Found {
            light: [found.irradiance, found.bounced].map(|e| at.reflectance * e * FRAC_1_PI),
            narrower: found.narrower,
            sheets: found.sheets,
            narrower_sheets: found.narrower_sheets,
        }
    }
}
