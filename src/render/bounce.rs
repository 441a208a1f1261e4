//! Where camera paths go from their first diffuse surface.
//!
//! A direction drawn by its cosine is a fair look at all that is around. But
//! where all else is dark, a ball in the distance is the only thing that sends
//! light: one direction in a hundred meets it, and counts as if a hundred had. So
//! half of the directions are *aimed* at the spheres around bounded objects,
//! where a pilot says that this pays. Each counts by the density of both ways to
//! come upon it (the balance heuristic as a mixture; Veach 1997, section 9.2.4),
//! so the mean is the same.

mod pilot;
#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::{
    geometry::BoundingSphere,
    material::Material,
    numeric::Frame,
    photon::grouped,
    sampling::warp,
    scene::{Object, Scene},
    transport::DiffusePoint,
};

/// Most spheres to aim at: every bounce asks how large each of them looks.
const MOST_TARGETS: usize = 8;

/// Part of the bounces that is aimed where there is a sphere to aim at. By the
/// count of pilots over `first` and `glass_sphere`, a quarter leaves more noise,
/// and three quarters cost more than they bring.
const AIMED: f64 = 0.5;

/// How bounces are aimed.
#[derive(Clone, Debug)]
pub(super) struct Bounces {
    /// At what; nothing where directions go by the cosine alone.
    targets: Vec<BoundingSphere>,
}

/// The direction of a bounce.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounce {
    /// Unit direction.
    pub(super) dir: DVec3,
    /// The density of directions by their cosine over that of all ways to come
    /// upon this one, at most `1 / (1 - AIMED)`.
    pub(super) weight: f64,
    /// The density of aimed directions over that by the cosine; `None` where
    /// there is nothing to aim at.
    ratio: Option<f64>,
}

/// A sphere as it looks from a point outside of it.
#[derive(Clone, Copy, Default)]
struct Cone {
    axis: DVec3,
    /// One minus the cosine of the half-angle.
    q: f64,
    /// Bound on its share of the hemisphere, weighed by cosines: twice that at
    /// most.
    size: f64,
}

impl Bounces {
    /// Bounces of which none is aimed.
    pub(super) const EVEN: Self = Self {
        targets: Vec::new(),
    };

    /// Bounces that are aimed at the objects of a scene.
    fn aimed(scene: &Scene) -> Self {
        // Lights are looked for by shadow rays.
        let sends = |o: &Object| o.light.is_none() && !matches!(o.material, Material::Black);
        let senders = (0u32..).zip(&scene.objects).filter(|(_, o)| sends(o));
        let spheres = senders.filter_map(|(i, _)| scene.world.instance_sphere(i));
        Self {
            targets: grouped(spheres.collect(), MOST_TARGETS, |s| s.radius),
        }
    }

    /// A direction on the viewer's side of a point; `None` where the normals
    /// would send it into the surface.
    pub(super) fn direction(&self, at: &DiffusePoint, u: [f64; 2]) -> Option<Bounce> {
        let bounce = if self.targets.is_empty() {
            Bounce::by_cosine(at, u)
        } else {
            self.mixed(at, u)?
        };
        (bounce.dir.dot(at.ng) > 0.0).then_some(bounce)
    }

    /// A direction around the shading normal; `None` for aimed ones below it.
    fn mixed(&self, at: &DiffusePoint, [u, v]: [f64; 2]) -> Option<Bounce> {
        let mut cones = [Cone::default(); MOST_TARGETS];
        let sum = self.look(at, &mut cones);
        if sum <= 0.0 {
            return Some(Bounce::by_cosine(at, [u, v]));
        }
        let dir = if u < AIMED {
            let (cone, u) = choose(&cones, u / AIMED * sum)?;
            let local = warp::cone([u, v], cone.q);
            Frame::around(cone.axis).to_world(local).normalize()
        } else {
            let u = (u - AIMED) / (1.0 - AIMED);
            Bounce::by_cosine(at, [u, v]).dir
        };
        let by_cosine = warp::cosine_hemisphere_pdf(dir.dot(at.ns));
        let within = |c: &&Cone| c.size > 0.0 && 1.0 - dir.dot(c.axis) <= c.q;
        let met = cones.iter().filter(within);
        let aimed = met.map(|c| c.size * warp::cone_pdf(c.q)).sum::<f64>() / sum;
        let ratio = aimed / by_cosine;
        ratio.is_finite().then(|| Bounce {
            dir,
            weight: 1.0 / density(Some(ratio)),
            ratio: Some(ratio),
        })
    }

    /// The targets as they look from a point, and the sum of their sizes. None
    /// is seen from within or from below the horizon.
    fn look(&self, at: &DiffusePoint, cones: &mut [Cone; MOST_TARGETS]) -> f64 {
        let mut sum = 0.0;
        for (cone, target) in cones.iter_mut().zip(&self.targets) {
            let way = target.center - at.point.p;
            let distance = way.length();
            let sin = target.radius / distance;
            // Not a number where both are 0.
            if sin.is_nan() || sin >= 1.0 {
                continue;
            }
            let axis = way / distance;
            let q = warp::one_minus_cos(sin);
            let cos = axis.dot(at.ns);
            // The largest cosine of a direction in the cone.
            let most = if cos >= 1.0 - q {
                1.0
            } else {
                cos * (1.0 - q) + (1.0 - cos * cos).max(0.0).sqrt() * sin
            };
            if q > 0.0 && most > 0.0 {
                let size = q * most;
                *cone = Cone { axis, q, size };
                sum += size;
            }
        }
        sum
    }
}

impl Bounce {
    /// Whether it is one of those of which a part is aimed.
    pub(super) fn is_mixed(&self) -> bool {
        self.ratio.is_some()
    }

    fn by_cosine(at: &DiffusePoint, u: [f64; 2]) -> Self {
        let local = warp::cosine_hemisphere(u);
        Self {
            dir: Frame::around(at.ns).to_world(local).normalize(),
            weight: 1.0,
            ratio: None,
        }
    }
}

/// The density of mixed directions over that by the cosine.
fn density(ratio: Option<f64>) -> f64 {
    1.0 + AIMED * (ratio.unwrap_or(1.0) - 1.0)
}

/// The cone in which a number between 0 and the sum of the sizes falls, and how
/// far it is through it, from 0 to 1.
fn choose(cones: &[Cone], mut x: f64) -> Option<(&Cone, f64)> {
    let mut last = None;
    for cone in cones.iter().filter(|c| c.size > 0.0) {
        if x < cone.size {
            return Some((cone, x / cone.size));
        }
        x -= cone.size;
        last = Some(cone);
    }
    // Roundings may leave a rest behind the last one.
    last.map(|cone| (cone, 1.0))
}
