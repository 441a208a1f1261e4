//! One step at a specular surface: mirror, dielectric interface, thin pane.

use glam::DVec3;

use crate::{
    built,
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

    /// Whether the light goes the way on which sheets of it are counted: where it
    /// could pass, it does. Reflections in glass are faint, and their sheets
    /// would hide the others.
    #[inline]
    pub fn is_due(&self) -> bool {
        self.share == 1.0 || !matches!(self.bend, Bend::Mirror { .. })
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
    Some(match Ways::at(material, point, d)? {
        Ways::Straight => Lobes::One(straight(d, 1.0)),
        Ways::Back {
            facing,
            reflectance,
        } => Lobes::One(facing.reflected(d, 1.0, carried).dimmed(reflectance)),
        Ways::Pane {
            facing,
            transmittance: t,
        } => Lobes::Two(
            facing.reflected(d, 1.0 - t, Carried::Radiance),
            straight(d, t),
        ),
        Ways::Interface { facing, split } => Lobes::Two(
            facing.reflected(d, split.reflectance, carried),
            facing.refracted(d, &split, carried),
        ),
    })
}

/// Where light can go at a specular surface, known before either way is worked
/// out.
#[derive(Clone, Copy, Debug)]
pub enum Ways {
    /// On as before.
    Straight,
    /// Back, at a mirror or by total reflection.
    Back {
        /// The normals.
        facing: Facing,
        /// Fraction of the light reflected.
        reflectance: Rgb,
    },
    /// Reflected by a thin pane, or on as before.
    Pane {
        /// The normals.
        facing: Facing,
        /// Fraction of the power that passes, between 0 and 1.
        transmittance: f64,
    },
    /// Reflected or refracted.
    Interface {
        /// The normals.
        facing: Facing,
        /// How much goes either way.
        split: Split,
    },
}

/// How light splits at an interface.
#[derive(Clone, Copy, Debug)]
pub struct Split {
    eta: f64,
    cos_t: f64,
    reflectance: f64,
    transmittance: f64,
}

impl Ways {
    /// The ways of light at a point of a specular material; `None` if it is
    /// not specular.
    #[inline]
    pub fn at(material: &Material, point: &SurfacePoint, d: DVec3) -> Option<Self> {
        Some(match *material {
            Material::Mirror { reflectance } => built::MIRRORS.then(|| Self::Back {
                facing: Facing::new(point, d),
                reflectance,
            })?,
            Material::Dielectric {
                ior, thin: true, ..
            } if built::PANES => Self::through_pane(point, d, ior),
            // Bodies that touch may have equal indices, too.
            Material::Dielectric { ior: 1.0, .. } if built::PANES || built::NESTING => {
                Self::Straight
            }
            Material::Dielectric { ior, .. } => {
                built::REFRACTION.then(|| Self::through_interface(point, d, ior))??
            }
            Material::Diffuse { .. } | Material::Black => return None,
        })
    }

    /// The lobe of one way, chosen by its share; the other one is not worked
    /// out. The random number is asked for only where there is a choice, as in
    /// [`Lobes::choose`].
    #[inline]
    pub fn choose(&self, d: DVec3, carried: Carried, u: impl FnOnce() -> f64) -> Lobe {
        match self {
            Self::Straight => straight(d, 1.0),
            Self::Back {
                facing,
                reflectance,
            } => facing.reflected(d, 1.0, carried).dimmed(*reflectance),
            Self::Pane {
                facing,
                transmittance: t,
            } => {
                if u() < 1.0 - t {
                    facing.reflected(d, 1.0 - t, Carried::Radiance)
                } else {
                    straight(d, *t)
                }
            }
            Self::Interface { facing, split } => {
                if u() < split.reflectance {
                    facing.reflected(d, split.reflectance, carried)
                } else {
                    facing.refracted(d, split, carried)
                }
            }
        }
    }

    #[inline]
    fn through_pane(point: &SurfacePoint, d: DVec3, ior: f64) -> Self {
        let facing = Facing::new(point, d);
        let transmittance = optics::pane_transmittance(-d.dot(facing.ns), ior);
        if transmittance >= 1.0 {
            Self::Straight
        } else if transmittance <= 0.0 {
            Self::Back {
                facing,
                reflectance: Rgb::WHITE,
            }
        } else {
            Self::Pane {
                facing,
                transmittance,
            }
        }
    }

    #[inline]
    fn through_interface(point: &SurfacePoint, d: DVec3, ior: f64) -> Option<Self> {
        let mut facing = Facing::new(point, d);
        let eta = if point.ng.dot(d) < 0.0 {
            ior
        } else {
            1.0 / ior
        };
        // At most twice: once about the shading normal, and if that would
        // refract to the near side, about the geometric one.
        loop {
            let Facing { ng, ns, smooth, .. } = facing;
            let Interface::Partial {
                cos_t,
                reflectance,
                transmittance,
            } = optics::fresnel(-d.dot(ns), eta)
            else {
                return built::TOTAL_REFLECTION.then_some(Self::Back {
                    facing,
                    reflectance: Rgb::WHITE,
                });
            };
            if built::SHADING_NORMALS && smooth && optics::refract(d, ns, eta, cos_t).dot(ng) >= 0.0
            {
                facing = facing.flat();
                continue;
            }
            return Some(Self::Interface {
                facing,
                split: Split {
                    eta,
                    cos_t,
                    reflectance,
                    transmittance,
                },
            });
        }
    }
}

/// The normals of a surface on the side from which light comes.
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    /// Geometric normal.
    ng: DVec3,
    /// The normal that decides on directions: the shading normal, or where
    /// that would not do, the geometric one.
    ns: DVec3,
    /// How `ns` follows the surface's shading normal, see [`Bend`].
    turn: f64,
    /// How `ng` does.
    flat_turn: f64,
    /// Whether these are two normals: where there is one, nothing is asked of
    /// the other.
    smooth: bool,
}

impl Facing {
    /// A shading normal that faces away from `d` is replaced by the geometric
    /// one.
    #[inline]
    fn new(point: &SurfacePoint, d: DVec3) -> Self {
        let side = if point.ng.dot(d) > 0.0 { -1.0 } else { 1.0 };
        let ng = point.ng * side;
        let flat = Self {
            ng,
            ns: ng,
            turn: side,
            flat_turn: side,
            smooth: false,
        };
        if !point.is_smooth() {
            return flat;
        }
        let facing = Self {
            ns: point.ns() * side,
            flat_turn: 0.0,
            smooth: true,
            ..flat
        };
        if facing.ns.dot(d) < 0.0 {
            facing
        } else {
            facing.flat()
        }
    }

    /// The geometric normal in both roles.
    #[inline]
    fn flat(self) -> Self {
        Self {
            ns: self.ng,
            turn: self.flat_turn,
            smooth: false,
            ..self
        }
    }

    /// A reflected lobe; where the shading normal would send it into the
    /// surface, the geometric normal decides, so that no light is lost at
    /// silhouettes.
    #[inline]
    fn reflected(&self, d: DVec3, share: f64, carried: Carried) -> Lobe {
        let w = optics::reflect(d, self.ns);
        let (dir, n, turn, shading) =
            if !built::SHADING_NORMALS || !self.smooth || w.dot(self.ng) > 0.0 {
                (w, self.ns, self.turn, self.shading_factor(d, w, carried))
            } else {
                (optics::reflect(d, self.ng), self.ng, self.flat_turn, 1.0)
            };
        Lobe {
            dir,
            share,
            weight: Rgb::grey(shading),
            shading,
            bend: Bend::Mirror { n, turn },
            index: 1.0,
        }
    }

    /// A refracted lobe.
    #[inline]
    fn refracted(&self, d: DVec3, split: &Split, carried: Carried) -> Lobe {
        let Split { eta, cos_t, .. } = *split;
        let dir = optics::refract(d, self.ns, eta, cos_t);
        let shading = self.shading_factor(d, dir, carried);
        let index = match carried {
            Carried::Radiance => 1.0 / (eta * eta),
            Carried::Flux => 1.0,
        };
        Lobe {
            dir,
            share: split.transmittance,
            // A radiance has no shading factor, a flux no index factor.
            weight: Rgb::grey(index * shading),
            shading,
            bend: Bend::Refract {
                n: self.ns,
                turn: self.turn,
                eta,
                cos_t,
            },
            index,
        }
    }

    /// Veach's factor for a light path that arrives along `d` and leaves along
    /// `w`: `|cos(in, ns) cos(out, ng)| / |cos(in, ng) cos(out, ns)|`.
    #[inline]
    fn shading_factor(&self, d: DVec3, w: DVec3, carried: Carried) -> f64 {
        let Self { ng, ns, .. } = *self;
        if !built::SHADING_NORMALS || carried == Carried::Radiance || !self.smooth {
            return 1.0;
        }
        let factor = (d.dot(ns) * w.dot(ng) / (d.dot(ng) * w.dot(ns))).abs();
        // Exactly grazing: no light passes such a point, and 0/0 must not.
        if factor.is_finite() { factor } else { 0.0 }
    }
}

impl Lobe {
    /// The lobe with a further factor on what is carried.
    #[inline]
    fn dimmed(self, reflectance: Rgb) -> Self {
        Self {
            weight: self.weight * reflectance,
            ..self
        }
    }
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
