//! One step at a specular surface: mirror, dielectric interface, thin pane.

use glam::DVec3;

use crate::{
    geometry::SurfacePoint,
    material::Material,
    optics::{self, Interface},
    spectrum::Rgb,
};

use super::Bend;

/// What a path carries; it decides two factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// Radiance, followed from the eye against the light: it scales with the
    /// squared index ratio at an interface (Veach 1997, section 5.2).
    Radiance,
    /// Flux of a photon: no index factor, but shading normals need Veach's
    /// correction (1997, section 5.3) to be consistent with the radiance.
    Flux,
}

/// One direction in which light goes on.
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// Unit direction.
    pub dir: DVec3,
    /// Probability of following this lobe when one is chosen; the shares of
    /// a step's lobes sum to one.
    pub share: f64,
    /// Factor on what is carried, given that the lobe was chosen.
    pub weight: Rgb,
    /// The part of `weight` that is due to shading normals (1 without).
    pub shading: f64,
    /// The part of `weight` that is due to the change of index (1 for flux):
    /// radiance scales by it, and no light is lost.
    pub index: f64,
    /// How the direction came about.
    pub bend: Bend,
}

impl Lobe {
    /// Whether the light was reflected or refracted, not passed straight on.
    #[inline]
    pub fn is_bent(&self) -> bool {
        self.bend != Bend::Straight
    }
}

/// The one or two lobes of a specular step, reflection first.
#[derive(Clone, Copy, Debug)]
pub enum Lobes {
    /// Light goes on in one direction.
    One(Lobe),
    /// Light splits.
    Two(Lobe, Lobe),
}

impl Lobes {
    /// Follows one lobe by its share. The random number is asked for only
    /// where there is a choice, so that surfaces without one leave a path's
    /// numbers as they are.
    #[inline]
    pub fn choose(self, u: impl FnOnce() -> f64) -> Lobe {
        match self {
            Self::Two(a, b) => {
                if u() < a.share {
                    a
                } else {
                    b
                }
            }
            Self::One(a) => a,
        }
    }
}

/// The lobes of a specular material at `point` for light or sight travelling
/// in unit direction `d`. `None` if the material is not specular.
#[inline]
pub fn lobes(
    material: &Material,
    point: &SurfacePoint,
    d: DVec3,
    carried: Carried,
) -> Option<Lobes> {
    match *material {
        Material::Mirror { reflectance } => {
            Some(Lobes::One(mirror(point, d, reflectance, carried)))
        }
        Material::Dielectric { ior, thin: true } => Some(pane(point, d, ior)),
        Material::Dielectric {
            ior: 1.0,
            thin: false,
        } => Some(Lobes::One(straight(d, 1.0))),
        Material::Dielectric { ior, thin: false } => Some(interface(point, d, ior, carried)),
        Material::Diffuse { .. } | Material::Black => None,
    }
}

/// The geometric and the shading normal on the side from which `d` comes. A
/// shading normal that faces away from `d` is replaced by the geometric one.
#[inline]
fn facing(point: &SurfacePoint, d: DVec3) -> (DVec3, DVec3) {
    let (ng, ns) = if point.ng.dot(d) > 0.0 {
        (-point.ng, -point.ns)
    } else {
        (point.ng, point.ns)
    };
    if ns.dot(d) < 0.0 { (ng, ns) } else { (ng, ng) }
}

/// How a normal that a step used follows the shading normal.
fn turn(point: &SurfacePoint, n: DVec3) -> f64 {
    if n == point.ns {
        1.0
    } else if n == -point.ns {
        -1.0
    } else {
        0.0
    }
}

/// Veach's factor for a light path that arrives along `d` and leaves along
/// `w`: `|cos(in, ns) cos(out, ng)| / |cos(in, ng) cos(out, ns)|`.
#[inline]
fn shading_factor(ng: DVec3, ns: DVec3, d: DVec3, w: DVec3, carried: Carried) -> f64 {
    if carried == Carried::Radiance || ng == ns {
        return 1.0;
    }
    let factor = (d.dot(ns) * w.dot(ng) / (d.dot(ng) * w.dot(ns))).abs();
    // Exactly grazing: no light passes such a point, and 0/0 must not.
    if factor.is_finite() { factor } else { 0.0 }
}

#[inline]
fn straight(d: DVec3, share: f64) -> Lobe {
    Lobe {
        dir: d,
        share,
        weight: Rgb::WHITE,
        shading: 1.0,
        bend: Bend::Straight,
        index: 1.0,
    }
}

/// A reflected lobe; where the shading normal would send it into the surface,
/// the geometric normal decides, so that no light is lost at silhouettes.
#[inline]
fn reflected(point: &SurfacePoint, ng: DVec3, ns: DVec3, d: DVec3, carried: Carried) -> Lobe {
    let w = optics::reflect(d, ns);
    let (w, n, shading) = if w.dot(ng) > 0.0 {
        (w, ns, shading_factor(ng, ns, d, w, carried))
    } else {
        (optics::reflect(d, ng), ng, 1.0)
    };
    Lobe {
        dir: w,
        share: 1.0,
        weight: Rgb::grey(shading),
        shading,
        bend: Bend::Mirror {
            n,
            turn: turn(point, n),
        },
        index: 1.0,
    }
}

#[inline]
fn mirror(point: &SurfacePoint, d: DVec3, reflectance: Rgb, carried: Carried) -> Lobe {
    let (ng, ns) = facing(point, d);
    let lobe = reflected(point, ng, ns, d, carried);
    Lobe {
        weight: lobe.weight * reflectance,
        ..lobe
    }
}

fn pane(point: &SurfacePoint, d: DVec3, ior: f64) -> Lobes {
    let (ng, ns) = facing(point, d);
    let t = optics::pane_transmittance(-d.dot(ns), ior);
    if t >= 1.0 {
        return Lobes::One(straight(d, 1.0));
    }
    // Radiance and flux agree: a pane has the same medium on both sides, and
    // the straight part has no shading normal.
    let mirror = reflected(point, ng, ns, d, Carried::Radiance);
    if t <= 0.0 {
        return Lobes::One(mirror);
    }
    Lobes::Two(
        Lobe {
            share: 1.0 - t,
            ..mirror
        },
        straight(d, t),
    )
}

#[inline]
fn interface(point: &SurfacePoint, d: DVec3, ior: f64, carried: Carried) -> Lobes {
    let (ng, mut ns) = facing(point, d);
    let eta = if point.ng.dot(d) < 0.0 {
        ior
    } else {
        1.0 / ior
    };
    // At most twice: once about the shading normal, and if that would refract
    // to the near side, about the geometric one.
    loop {
        let Interface::Partial {
            cos_t,
            reflectance,
            transmittance,
        } = optics::fresnel(-d.dot(ns), eta)
        else {
            return Lobes::One(reflected(point, ng, ns, d, carried));
        };
        let w = optics::refract(d, ns, eta, cos_t);
        if w.dot(ng) >= 0.0 && ns != ng {
            ns = ng;
            continue;
        }
        let shading = shading_factor(ng, ns, d, w, carried);
        let index = match carried {
            Carried::Radiance => 1.0 / (eta * eta),
            Carried::Flux => 1.0,
        };
        let refracted = Lobe {
            dir: w,
            share: transmittance,
            // A radiance has no shading factor, a flux no index factor.
            weight: Rgb::grey(index * shading),
            shading,
            bend: Bend::Refract {
                n: ns,
                turn: turn(point, ns),
                eta,
                cos_t,
            },
            index,
        };
        let mirror = reflected(point, ng, ns, d, carried);
        return Lobes::Two(
            Lobe {
                share: reflectance,
                ..mirror
            },
            refracted,
        );
    }
}
