//! Why a caustic is missing, at the step where it is lost.

use std::collections::BTreeMap;

use crate::{material::Material, plan::extent, scene::Scene};

use super::{funnel::Tale, percent, raise};

/// No photon met the caster: what stands in the way.
pub(super) fn not_met(scene: &Scene, light: usize, caster: u32, aimed: &[&Tale<'_>]) -> String {
    let (lamp, name) = (&scene.lights[light].name, name(scene, caster));
    let blocker = most_frequent(
        aimed
            .iter()
            .filter_map(|t| t.story.first.map(|s| s.instance)),
    );
    let n = aimed.len();
    match blocker {
        _ if n == 0 => format!("no photon of `{lamp}` sets out towards {name}"),
        Some(other) if other != caster => format!(
            "{} stands between `{lamp}` and {name}: none of {n} photons met it first",
            self::name(scene, other)
        ),
        _ => format!("none of {n} photons of `{lamp}` met {name} first"),
    }
}

/// No photon landed: where they ended instead.
pub(super) fn not_landed(
    scene: &Scene,
    light: usize,
    caster: u32,
    met: &[&Tale<'_>],
    limit: u32,
) -> String {
    let (lamp, name) = (&scene.lights[light].name, name(scene, caster));
    let n = met.len() as f64;
    let part = |f: &dyn Fn(&Tale<'_>) -> bool| met.iter().filter(|t| f(t)).count() as f64 / n;
    let escaped = part(&|t| t.story.ledger.escaped > 0.0);
    let absorbed = part(&|t| t.story.ledger.absorbed > 0.0);
    // Followed far beyond the limit that was asked for.
    let trapped = part(&|t| t.story.ledger.truncated > 0.0);
    let late = met.iter().filter(|t| t.landed);
    let mut depths: Vec<u32> = late.map(|t| t.story.surfaces.saturating_sub(1)).collect();
    if !depths.is_empty() || trapped > escaped.max(absorbed) {
        depths.sort_unstable();
        let needed = if depths.is_empty() {
            u32::MAX
        } else {
            super::light::quantile(&depths)
        };
        let reached = part(&|t| t.story.surfaces > limit + u32::from(t.landed));
        return format!(
            "the depth limit {limit} is reached by {} of the photons: {}",
            percent(reached),
            raise(needed)
        );
    }
    if escaped >= absorbed {
        if let Some(behind) = from_behind(scene, light, caster, met) {
            return behind;
        }
        let encloses = extent(scene, &scene.lights[light])
            .is_some_and(|s| scene.world.encloses(caster, s.center));
        return if encloses {
            format!("{name} encloses `{lamp}`, and nothing diffuse lies where its light goes")
        } else {
            format!("nothing diffuse lies where {name} throws the light of `{lamp}`")
        };
    }
    format!("all that {name} throws is absorbed: what it falls on is not diffuse")
}

/// No photon landed where the camera looks.
pub(super) fn not_seen(scene: &Scene, caster: u32, landed: &[&Tale<'_>]) -> String {
    format!(
        "none of the {} photons from {} that landed fell where the camera looks",
        landed.len(),
        name(scene, caster)
    )
}

/// Whether an open surface was met from behind by nearly all.
fn from_behind(scene: &Scene, light: usize, caster: u32, met: &[&Tale<'_>]) -> Option<String> {
    let open = matches!(
        scene.objects[caster as usize].material,
        Material::Dielectric {
            thin: false,
            priority: None,
            ..
        }
    );
    let behind = met
        .iter()
        .filter(|t| t.story.caster.is_some_and(|c| c.behind))
        .count();
    (open && 2 * behind > met.len()).then(|| {
        format!(
            "{} meets the light of `{}` with its back: if the light is to stand outside, its \
             normals point inward",
            name(scene, caster),
            scene.lights[light].name
        )
    })
}

fn name(scene: &Scene, instance: u32) -> String {
    format!("`{}`", scene.objects[instance as usize].name)
}

/// The value that comes most often, the smallest of equals.
fn most_frequent(values: impl Iterator<Item = u32>) -> Option<u32> {
    let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
    for v in values {
        *counts.entry(v).or_default() += 1;
    }
    let most = counts.values().copied().max()?;
    counts.into_iter().find(|&(_, n)| n == most).map(|(v, _)| v)
}
