//! Light between diffuse surfaces, by path tracing from the first that the eye
//! sees; caustics on the way have been left to photons.

use crate::{
    material::Material,
    photon::Vicinity,
    sampling::Stream,
    spectrum::Rgb,
    transport::{DiffusePoint, End, Walker, direct_light},
};

use super::{
    bounce::{Bounce, Bounces},
    camera_walk::{Gather, add_blur},
    tally::CameraTally,
};

/// Shadow rays at each of these surfaces.
const SHADOW_RAYS: u32 = 1;

/// Growth of a path's footprint after a diffuse bounce, in metres per metre:
/// the bounce averages over a wide cone, so the photons' light seen there may
/// be blurred over a small part of it.
const DIFFUSE_SPREAD: f64 = 0.003;

/// Bounces between diffuse surfaces before the roulette may end a path for their
/// darkness.
const SURE_BOUNCES: u32 = 2;

/// Light that a path brings, and what of it photons' kernels lose when they are
/// drawn in.
pub(super) type Brought = (Rgb, [f64; 2]);

impl Gather<'_> {
    /// Light that comes to a point `at` out of the direction of a bounce. `path`
    /// ends there, the point's reflectance already in its throughput. Where bounces
    /// are aimed and light divides at the first specular surface on the way, both
    /// ways are followed: the first stream decides about the stronger, the other
    /// about the weaker one. (Elsewhere that costs more than it brings: in `pool`
    /// every bounce meets the water.)
    pub(super) fn indirect(
        &self,
        mut path: Walker,
        at: &DiffusePoint,
        bounce: &Bounce,
        [mut main, mut side]: [Stream; 2],
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> Brought {
        path.throughput *= bounce.weight;
        path.ray = at.point.spawn(bounce.dir);
        let before = path;
        let splits = bounce.is_mixed();
        let mut weaker = None;
        let end = path.walk(&self.ctx, &mut main, &mut |other| {
            let takes = splits && weaker.is_none() && other.depth == before.depth + 1;
            if takes {
                weaker = Some(*other);
            }
            takes
        });
        tally.rays += u64::from(path.depth - before.depth) + 1;
        let (mut light, mut blur) = self.beyond(path, end, &before, &mut main, vicinity, tally);
        if let Some(mut path) = weaker {
            let depth = path.depth;
            let end = path.walk(&self.ctx, &mut side, &mut |_| false);
            tally.rays += u64::from(path.depth - depth) + 1;
            let more = self.beyond(path, end, &before, &mut side, vicinity, tally);
            light += more.0;
            add_blur(&mut blur, more.1);
        }
        (light, blur)
    }

    /// Light that a path finds at the end of its first way between diffuse
    /// surfaces, and from there on; it was as `before` when it set out.
    fn beyond(
        &self,
        mut path: Walker,
        mut end: End,
        before: &Walker,
        stream: &mut Stream,
        vicinity: &mut Option<Vicinity<'_>>,
        tally: &mut CameraTally,
    ) -> Brought {
        let mut sum = Rgb::BLACK;
        let mut blur = [0.0; 2];
        let mut bounces = 0;
        // Footprints are wide after a diffuse bounce, whatever they were.
        let mut width = self.footprint.width + self.footprint.spread * before.length;
        let mut length = before.length;
        // What mirrors and glass have left.
        let mut carried = path.strength / before.strength;
        loop {
            let (point, reflectance) = match end {
                End::Surface {
                    point,
                    material: Material::Diffuse { reflectance },
                } => (point, reflectance),
                End::Truncated => {
                    tally.truncated += 1;
                    return (sum, blur);
                }
                // Lights are sampled directly: meeting one adds nothing.
                End::Surface { .. } | End::Escaped => return (sum, blur),
            };
            width += DIFFUSE_SPREAD * (path.length - length);
            length = path.length;
            let at = DiffusePoint::new(point, path.ray.dir, reflectance, path.media);
            // The caustic itself, as light for the surface before, has come
            // there as photons that bounced here.
            let bounced = self.gathered(&at, width, false, stream, vicinity, tally);
            tally.rays += u64::from(SHADOW_RAYS);
            let found = direct_light(&self.ctx, &at, stream, SHADOW_RAYS) + bounced.light[1];
            if self.draws_in {
                add_blur(&mut blur, bounced.blur(1, path.throughput));
            }
            sum += path.throughput * found;
            path.throughput *= reflectance;
            path.strength *= reflectance.max();
            bounces += 1;
            if path.depth >= self.ctx.max_depth {
                tally.truncated += 1;
                return (sum, blur);
            }
            // A path that carries little goes on as seldom.
            let q = if bounces < SURE_BOUNCES {
                carried.min(1.0)
            } else {
                path.strength.min(0.95)
            };
            carried = 1.0;
            if q < 1.0 {
                if stream.next_1d() >= q {
                    return (sum, blur);
                }
                path.throughput = path.throughput / q;
                path.strength /= q;
            }
            let Some(bounce) = Bounces::EVEN.direction(&at, stream.next_2d()) else {
                return (sum, blur);
            };
            path.ray = at.point.spawn(bounce.dir);
            let depth = path.depth;
            end = path.walk(&self.ctx, stream, &mut |_| false);
            tally.rays += u64::from(path.depth - depth) + 1;
        }
    }
}
