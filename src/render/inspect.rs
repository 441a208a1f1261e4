//! What the survey asks of a renderer: single camera samples taken apart, and
//! where photons would be seen.

use crate::{
    film::{Layer, PixelSample},
    geometry::Ray,
    material::Material,
    photon::{Photon, PhotonMap, Vicinity},
    sampling::{Sequence, Stream},
    scene::Scene,
    transport::{
        Bend, Carried, DiffusePoint, End, Lobes, Walker, direct_by_extent, lobes, media_beside,
        meet,
    },
};

use super::{
    Renderer,
    camera_walk::Gather,
    coordinates,
    glints::{self, Glints, NEAR},
    importance::{Importance, beam, reach},
    share::PATH,
    tally::CameraTally,
};

/// What a way from the eye went through.
#[allow(
    clippy::struct_excessive_bools,
    reason = "a way goes through each of them or not"
)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Passed {
    /// A mirror.
    pub(crate) mirror: bool,
    /// Glass or water, reflected or refracted there.
    pub(crate) glass: bool,
    /// Total reflection.
    pub(crate) total: bool,
    /// Something that let it through in a straight line.
    pub(crate) pane: bool,
    /// A surface between two bodies.
    pub(crate) nested: bool,
    /// A surface with interpolated normals, at its end or before.
    pub(crate) smooth: bool,
}

/// Work of a camera sample by what it was done for, in rays cast.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effort {
    /// The way from the eye.
    pub(crate) view: f64,
    /// Shadow rays to lights without extent, and with.
    pub(crate) shadows: [f64; 2],
    /// Queries of the photon map.
    pub(crate) caustics: f64,
    /// Paths between diffuse surfaces.
    pub(crate) indirect: f64,
    /// Rays that look for glints.
    pub(crate) glints: f64,
}

/// A camera sample, followed along one way.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sight {
    /// What it found, by layer.
    pub(crate) light: PixelSample,
    /// The direct light of lights without extent, and with.
    pub(crate) direct: [f64; 2],
    /// What the way went through.
    pub(crate) passed: Passed,
    /// Surfaces on the way from the eye.
    pub(crate) depth: u32,
    /// Work.
    pub(crate) effort: Effort,
}

/// Where photons would be seen.
pub(crate) struct Seen<'a> {
    importance: Importance,
    scene: &'a Scene,
}

impl Seen<'_> {
    /// Whether the camera looks where a photon has landed.
    pub(crate) fn sees(&self, photon: &Photon) -> bool {
        self.importance.of(self.scene, photon) > 0.0
    }
}

impl Renderer<'_> {
    /// Looks from the camera at `samples` places over the whole picture.
    pub(crate) fn seen(&self, sequence: Sequence, samples: u64) -> Seen<'_> {
        let ctx = self.called_for();
        let beam = beam(&self.camera, self.resolution, samples);
        let points: Vec<Photon> = (0..samples)
            .flat_map(|i| {
                let mut stream = sequence.at(i);
                let ray = self.through(&stream);
                stream.seek(2);
                reach(&ctx, ray, beam, &mut stream)
            })
            .flatten()
            .collect();
        Seen {
            importance: Importance::new(&points, samples),
            scene: self.scene,
        }
    }

    /// The ray of a stream through the whole picture.
    fn through(&self, stream: &Stream) -> Ray {
        let [u, v] = coordinates::film(stream);
        let [w, h] = self.resolution.map(f64::from);
        self.camera.ray(glam::DVec2::new(u * w, v * h))
    }

    /// Photon paths of a pass for every camera sample of one sample a pixel, in
    /// rays cast.
    pub(crate) fn photon_effort(&self) -> f64 {
        let pixels = f64::from(self.resolution[0]) * f64::from(self.resolution[1]);
        PATH * self.photons() as f64 / pixels
    }

    /// Takes camera samples apart: those of paths `0 .. count` of a sequence,
    /// with the photons of a map.
    pub(crate) fn sights(
        &self,
        map: Option<&PhotonMap>,
        sequence: Sequence,
        count: u64,
        mut found: impl FnMut(&Sight),
    ) {
        let gather = self.scout(map, 0);
        let glints = self.plan().glints().then(|| Glints::new(self.scene));
        let mut near = gather.vicinity();
        for i in 0..count {
            let stream = sequence.at(i);
            found(&self.sight(&gather, glints.as_ref(), &stream, &mut near));
        }
    }

    fn sight(
        &self,
        gather: &Gather<'_>,
        glints: Option<&Glints>,
        stream: &Stream,
        near: &mut Option<Vicinity<'_>>,
    ) -> Sight {
        let mut sight = Sight::default();
        let ctx = &gather.ctx;
        let ray = self.through(stream);
        let mut walker = Walker::from_camera(ctx, ray);
        let mut coins = coordinates::coins(stream);
        let end = sight.walk(ctx, &mut walker, &mut coins);
        sight.depth = walker.depth;
        sight.effort.view = f64::from(walker.depth.max(1));
        let passes_near = |g| {
            gather
                .distances_to(g, ray, stream)
                .iter()
                .any(|d| *d <= NEAR)
        };
        if glints.is_some_and(passes_near) {
            sight.effort.glints = sight.effort.view * glints::RAYS as f64;
        }
        match &end {
            End::Truncated => {}
            End::Surface {
                point,
                material: Material::Diffuse { reflectance },
            } => {
                sight.passed.smooth |= point.is_smooth();
                let at = DiffusePoint::new(*point, walker.ray.dir, *reflectance, walker.media);
                let mut tally = CameraTally::default();
                sight.light = gather.shade(&walker, &at, stream, 0, near, &mut tally);
                let rays = gather.shadow_rays(&walker);
                let mut shadows = coordinates::shading(stream, 1);
                let direct = direct_by_extent(ctx, &at, &mut shadows, rays);
                sight.light[Layer::Direct] = walker.throughput * (direct[0].0 + direct[1].0);
                sight.direct = direct.map(|(light, _)| (walker.throughput * light).mean());
                sight.effort.shadows = direct.map(|(_, rays)| f64::from(rays));
                sight.effort.indirect = tally.beyond;
                let all = tally.work_since(&CameraTally::default());
                sight.effort.caustics = (all - tally.beyond - f64::from(rays)).max(0.0);
            }
            End::Escaped | End::Surface { .. } => {
                sight.light[Layer::Emission] = gather.source(&walker, &end);
            }
        }
        sight
    }
}

impl Sight {
    /// Follows a walker along one way to its end.
    fn walk(
        &mut self,
        ctx: &crate::transport::Context<'_>,
        walker: &mut Walker,
        coins: &mut Stream,
    ) -> End {
        loop {
            let Some(met) = meet(ctx, &walker.ray, f64::INFINITY, &mut walker.media) else {
                return End::Escaped;
            };
            walker.depth += 1;
            walker.length += met.hit.t;
            let (point, material) = (met.point, met.material);
            let Some(ways) = lobes(&material, &point, walker.ray.dir, Carried::Radiance) else {
                return End::Surface { point, material };
            };
            if walker.depth >= ctx.max_depth {
                return End::Truncated;
            }
            let is_only = matches!(ways, Lobes::One(_));
            let lobe = ways.choose(|| coins.next_1d());
            let is_mirrored = matches!(lobe.bend, Bend::Mirror { .. });
            let passed = &mut self.passed;
            match material {
                Material::Mirror { .. } => passed.mirror = true,
                Material::Dielectric { .. } => {
                    passed.glass |= lobe.is_bent();
                    passed.pane |= !lobe.is_bent();
                    passed.total |= is_mirrored && is_only;
                    passed.nested |= material != ctx.scene.object(point.surface).material;
                }
                Material::Diffuse { .. } | Material::Black => {}
            }
            passed.smooth |= point.is_smooth();
            walker.throughput *= lobe.weight;
            walker.strength *= lobe.weight.max() / lobe.index;
            walker.media = media_beside(ctx, walker.media, &point, lobe.dir);
            walker.ray = point.spawn(lobe.dir);
            if walker.throughput.is_black() {
                return End::Escaped;
            }
        }
    }
}
