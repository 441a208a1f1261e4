//! One photon path, from its launch to its end.
//!
//! Photons are stored where they arrive at a finite lobe after being bent. A
//! path that is stored goes on once: reflected there, it is stored a second
//! time at the next finite lobe. That second kind is light between diffuse
//! surfaces which a camera path would have to find by chance: a focus is a
//! small bright lamp.

use glam::DVec3;

use crate::{
    geometry::SurfacePoint,
    material::Material,
    numeric::Frame,
    sampling::{Stream, warp},
    scene::Kernel,
    spectrum::Rgb,
    transport::{Carried, Context, Differential, Lobe, Met, Ways, media_beside, meet_in},
};

use super::{Emission, Footprint, LightTally, companion::Way, emit};

/// Light that landed at a finite lobe after it was reflected or bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Where it landed, metres.
    pub position: DVec3,
    /// Geometric normal of the surface on the side from which it came.
    pub normal: DVec3,
    /// Flux in W, not yet divided by the number of emitted paths.
    pub flux: Rgb,
    /// The patch it stands for; `None` where derivatives do not tell.
    pub footprint: Option<Footprint>,
    /// Whether a diffuse surface reflected it on its way.
    pub bounced: bool,
    /// Area in m² of the sheet of light that its path stands for there
    /// ([`Differential::sheet`]), not yet divided by the number of emitted paths; 0 for
    /// light that was reflected where it could have passed, and where derivatives do
    /// not tell.
    pub sheet: f64,
}

/// Most photons that one path stores.
pub const PHOTONS_PER_PATH: u64 = 2;

/// Below this fraction of its launched flux a photon plays roulette at
/// absorbing surfaces.
const ROULETTE_BELOW: f64 = 0.25;

/// Stream coordinates of one surface interaction: two for a direction or one
/// for a lobe, and one for the roulette.
const DIMENSIONS_PER_STEP: u32 = 3;

/// A surface that a photon has met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The object.
    pub instance: u32,
    /// How many surfaces the photon had met before.
    pub depth: u32,
    /// What became of it there.
    pub turn: Turn,
    /// Whether it came from behind the surface.
    pub behind: bool,
}

impl Step {
    /// The same where a specular surface sends the photon along a lobe.
    fn turned(self, lobe: &Lobe) -> Self {
        let turn = if lobe.is_bent() {
            Turn::Bent
        } else {
            Turn::Straight
        };
        Self { turn, ..self }
    }
}

/// What a surface does with a photon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// It goes on as before.
    Straight,
    /// A specular surface reflects or refracts it.
    Bent,
    /// A surface that is not specular ends its way, or a leg of it.
    Ended,
}

/// Follows a photon, one of `paths`; what becomes of its flux goes into
/// `tally`, what it leaves behind to `store`.
pub fn trace(
    ctx: &Context<'_>,
    emission: &Emission,
    paths: f64,
    stream: &mut Stream,
    tally: &mut LightTally,
    store: &mut impl FnMut(Photon),
) {
    let watch = &mut |_| {};
    let kernel = Kernel::Footprint;
    trace_watched(ctx, kernel, emission, paths, stream, tally, watch, store);
}

/// [`trace`] for someone who wants to know the surfaces met on the way. Where
/// kernels are circles, photons have no footprints, and nothing is done to find
/// any.
#[allow(clippy::too_many_arguments, reason = "those of `trace`, and a watcher")]
pub(super) fn trace_watched(
    ctx: &Context<'_>,
    kernel: Kernel,
    emission: &Emission,
    paths: f64,
    stream: &mut Stream,
    tally: &mut LightTally,
    watch: &mut impl FnMut(Step),
    store: &mut impl FnMut(Photon),
) {
    let trace = match (ctx.plan.nest().is_some(), kernel) {
        (false, Kernel::Footprint) => trace_in::<false, true, _, _>,
        (true, Kernel::Footprint) => trace_in::<true, true, _, _>,
        (false, Kernel::Circle) => trace_in::<false, false, _, _>,
        (true, Kernel::Circle) => trace_in::<true, false, _, _>,
    };
    trace(ctx, emission, paths, stream, tally, watch, store);
}

/// The same, where bodies of clear media may overlap or not (`NESTED`), for
/// photons that have footprints or do not (`SPREAD`).
#[inline]
fn trace_in<const NESTED: bool, const SPREAD: bool, W: FnMut(Step), S: FnMut(Photon)>(
    ctx: &Context<'_>,
    emission: &Emission,
    paths: f64,
    stream: &mut Stream,
    tally: &mut LightTally,
    watch: &mut W,
    store: &mut S,
) {
    let mut flux = emission.flux;
    tally.paths += 1;
    tally.launched += flux.mean();
    if flux.is_black() {
        return;
    }
    let (mut ray, mut media) = (emission.ray, emission.media);
    let mut differential = emission.differential;
    let mut way = Way::new();
    let weak = ROULETTE_BELOW * flux.max();
    let (mut bent, mut bounced, mut passed) = (false, false, true);
    for depth in 0..=ctx.max_depth {
        let Some(met) = meet_in::<NESTED>(ctx, &ray, f64::INFINITY, &mut media) else {
            tally.escaped += flux.mean();
            return;
        };
        let Met {
            hit,
            point,
            material,
        } = met;
        if SPREAD {
            differential.transfer(ray.dir, hit.t, point.ng);
        }
        if depth == 0 {
            tally.landed_paths += 1;
        }
        let step = Step {
            instance: hit.surface.instance,
            depth,
            turn: Turn::Ended,
            behind: point.ng.dot(ray.dir) > 0.0,
        };
        stream.seek(emit::DIMENSIONS + DIMENSIONS_PER_STEP * depth);
        let (direction, q) = if let Some(ways) = Ways::at(&material, &point, ray.dir) {
            if depth == ctx.max_depth {
                break;
            }
            let lobe = ways.choose(ray.dir, Carried::Flux, || stream.next_1d());
            flux = scatter(flux, &lobe, tally);
            bent |= lobe.is_bent();
            passed &= lobe.is_due();
            watch(step.turned(&lobe));
            differential.chance *= lobe.share;
            if SPREAD {
                way.push(hit.surface.instance, &lobe.bend);
            }
            if SPREAD && lobe.is_bent() {
                let turning = ctx.scene.world.turning(&hit, &point);
                differential.bend(ray.dir, &lobe.bend, &turning);
            }
            // A weak survivor is back at the threshold. Splitting at glass
            // never weakens a photon (it chooses), so this acts only where
            // mirrors absorb.
            (lobe.dir, (flux.max() / weak).max(f64::MIN_POSITIVE))
        } else {
            watch(step);
            let Some(landed) = land(&material, &point, ray.dir, flux, bent || bounced, tally)
            else {
                return;
            };
            let fold = (!bounced).then_some((&way, emission, hit.surface.instance));
            let footprint = patch::<NESTED, SPREAD>(ctx, &differential, paths, &landed, fold);
            store(Photon {
                footprint,
                bounced,
                sheet: sheet(&differential, passed && !bounced && footprint.is_some()),
                ..landed
            });
            let Material::Diffuse { reflectance } = material else {
                return;
            };
            if bounced || !ctx.plan.indirect() {
                return;
            }
            flux = landed.flux * reflectance;
            tally.reflected += flux.mean();
            if depth == ctx.max_depth {
                break;
            }
            bounced = true;
            let local = warp::cosine_hemisphere_mapped(stream.next_2d());
            let frame = Frame::around(landed.normal);
            let direction = frame.to_world(local.at).normalize();
            if SPREAD {
                differential.restart(frame.pair_to_world(local.by), local.room);
            }
            (direction, reflectance.max())
        };
        if q < 1.0 {
            let Some(survived) = play(flux, q, stream.next_1d(), tally) else {
                return;
            };
            flux = survived;
            differential.chance *= q;
        }
        if NESTED {
            media = media_beside(ctx, media, &point, direction);
        }
        ray = point.spawn(direction);
    }
    tally.truncated += flux.mean();
    tally.truncated_paths += 1;
}

/// The flux of a photon that survives with chance `q`; `None` if `u` ends it.
#[inline]
fn play(flux: Rgb, q: f64, u: f64, tally: &mut LightTally) -> Option<Rgb> {
    if u >= q {
        tally.roulette_loss += flux.mean();
        return None;
    }
    tally.roulette_gain += flux.mean() * (1.0 / q - 1.0);
    Some(flux / q)
}

/// The patch that a photon stands for, by its derivatives; with a fold ahead if
/// the photon's way, its start and the object on which it landed are given.
/// Nothing for photons without footprints.
#[inline]
fn patch<const NESTED: bool, const SPREAD: bool>(
    ctx: &Context<'_>,
    differential: &Differential,
    paths: f64,
    landed: &Photon,
    fold: Option<(&Way, &Emission, u32)>,
) -> Option<Footprint> {
    if !SPREAD {
        return None;
    }
    let (mut footprint, rim) = Footprint::with_rim(differential, paths, landed.normal)?;
    if let (Some(rim), Some((way, emission, last))) = (rim, fold)
        && let Some(p) = way.follow::<NESTED>(ctx, emission, &rim, last)
    {
        footprint.learn(&rim, p - landed.position - rim.way);
    }
    Some(footprint)
}

/// The area of the sheet of light that a path stands for, if it is `counted`.
#[inline]
fn sheet(differential: &Differential, counted: bool) -> f64 {
    let area = if counted { differential.sheet() } else { 0.0 };
    if area.is_finite() { area } else { 0.0 }
}

/// The flux after a specular step, with its change booked.
#[inline]
fn scatter(flux: Rgb, lobe: &Lobe, tally: &mut LightTally) -> Rgb {
    if lobe.shading == 1.0 && lobe.weight == Rgb::WHITE {
        return flux;
    }
    let shaded = flux * lobe.shading;
    tally.shading_change += shaded.mean() - flux.mean();
    let out = flux * lobe.weight;
    tally.absorbed += shaded.mean() - out.mean();
    out
}

/// What a photon leaves at a surface that is not specular, if its light is
/// `owned` by the map: otherwise shadow rays bring it. On a smooth-shaded
/// surface its flux is weighted so that the density of photons stands for the
/// irradiance about the shading normal (Veach 1997, section 5.3).
fn land(
    material: &Material,
    point: &SurfacePoint,
    d: DVec3,
    flux: Rgb,
    owned: bool,
    tally: &mut LightTally,
) -> Option<Photon> {
    if !material.is_finite() {
        tally.absorbed += flux.mean();
        return None;
    }
    if !owned {
        tally.direct += flux.mean();
        return None;
    }
    let (mut normal, mut factor) = (point.ng, 1.0);
    if point.is_smooth() {
        let ratio = d.dot(point.ns) / d.dot(point.ng);
        factor = if ratio.is_finite() {
            ratio.max(0.0)
        } else {
            0.0
        };
    }
    if normal.dot(d) > 0.0 {
        normal = -normal;
    }
    let shaded = flux * factor;
    tally.shading_change += shaded.mean() - flux.mean();
    tally.stored += shaded.mean();
    tally.photons += 1;
    Some(Photon {
        position: point.p,
        normal,
        flux: shaded,
        footprint: None,
        bounced: false,
        sheet: 0.0,
    })
}
