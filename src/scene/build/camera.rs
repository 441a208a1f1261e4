//! The camera, the image and the settings.

use super::{Builder, BuiltObject, checks::unit};
use crate::{
    camera::{Camera, Filter},
    material::Material,
    numeric::gamma,
    scene::{
        Choice, Effect, Settings, Switch,
        decode::short,
        description::{self, EffectsDescription, Memory, Number, Part, RenderDescription},
        outline::NodeId,
    },
};

/// Largest width or height in pixels.
const MAX_SIDE: u32 = 1 << 16;
/// Most pixels.
const MAX_PIXELS: u64 = 1 << 28;
/// Largest exposure in stops, up or down.
const MAX_STOPS: f64 = 64.0;
/// Largest number of passes.
const MAX_PASSES: u32 = 1 << 24;
/// Largest number of photon paths per pass.
const MAX_PHOTONS: u64 = 1 << 31;
/// Largest depth.
const MAX_DEPTH: u32 = 1 << 16;
/// Least and most memory of the film and of a pass's photons, in bytes.
const MEMORY: std::ops::RangeInclusive<f64> = 1_048_576.0..=1_125_899_906_842_624.0;

/// What the `image` section says.
#[derive(Clone, Copy)]
pub(super) struct Image {
    pub(super) resolution: [u32; 2],
    pub(super) exposure: Option<f64>,
    pub(super) filter: Filter,
}

impl Builder<'_> {
    pub(super) fn image(&mut self) -> Option<Image> {
        let Part { node, value } = self.description.image.as_ref()?;
        let mut good = true;
        for (key, side) in [("width", value.width), ("height", value.height)] {
            if side == 0 || side > MAX_SIDE {
                let place = self.report.field(*node, key);
                let message = if side == 0 {
                    format!("an image of zero {key}")
                } else {
                    format!("the image's {key} is too large")
                };
                let label = format!("expected 1 to {MAX_SIDE} pixels");
                good = self
                    .report
                    .reject(place, message, label, "such as 800")
                    .unwrap_or(false);
            }
        }
        let pixels = u64::from(value.width) * u64::from(value.height);
        if good && pixels > MAX_PIXELS {
            let label = format!("expected at most {MAX_PIXELS} pixels");
            let message = format!("an image of {pixels} pixels");
            good = self
                .report
                .reject(*node, message, label, "make it smaller")
                .unwrap_or(false);
        }
        if value.exposure.is_some_and(|e| e.0.abs() > MAX_STOPS) {
            let place = self.report.field(*node, "exposure");
            let label = format!("expected -{MAX_STOPS} to {MAX_STOPS} stops");
            let help = "a stop is a factor of two";
            good = self
                .report
                .reject(place, "an exposure out of range", label, help)
                .unwrap_or(false);
        }
        let resolution = [value.width, value.height];
        good.then_some(Image {
            resolution,
            exposure: value.exposure.map(|e| e.0),
            filter: match value.filter {
                description::Filter::Box => Filter::Box,
                description::Filter::Gaussian => Filter::Gaussian,
                description::Filter::BlackmanHarris => Filter::BlackmanHarris,
            },
        })
    }

    pub(super) fn camera(&mut self, resolution: [u32; 2]) -> Option<Camera> {
        let Part { node, value: c } = self.description.camera.as_ref()?;
        let node = *node;
        let eye = self.report.point(node, "eye", c.eye);
        let look_at = self.report.point(node, "look_at", c.look_at);
        let up = self.report.direction(node, "up", c.up);
        let fields = [("fov", c.fov.is_some()), ("height", c.height.is_some())];
        let which = self.report.exactly_one(node, &fields);
        let fov = c.fov.and_then(|fov| self.field_of_view(node, fov));
        let height = c.height.and_then(|h| self.report.length(node, "height", h));
        let (eye, look_at, up) = (eye?, look_at?, up?);
        self.check_view(node, look_at - eye, up)?;
        match which? {
            0 => Some(Camera::perspective(eye, look_at, up, fov?, resolution)),
            _ => Some(Camera::orthographic(eye, look_at, up, height?, resolution)),
        }
    }

    /// The object that the camera says it stands in.
    pub(super) fn camera_medium(&mut self, objects: &[BuiltObject]) -> Option<u32> {
        let Part { node, value } = self.description.camera.as_ref()?;
        let name = value.medium.as_ref()?;
        let place = self.report.field(*node, "medium");
        let Some(index) = objects.iter().position(|o| o.object.name == *name) else {
            // Where objects are broken, the one that is meant may be among them.
            if objects.len() == self.description.objects.len() {
                self.dangling(place, "object", "objects", name);
            }
            return None;
        };
        if let Material::Dielectric {
            priority: Some(_), ..
        } = objects[index].object.material
        {
            return Some(index as u32);
        }
        let message = format!("the camera cannot be inside \"{}\"", short(name));
        let label = "expected a closed object of a clear medium";
        let help = "mirrors, panes, open surfaces and those with `outside` are no bodies; \
                    leave `medium` out, and it is found";
        self.report.reject(place, message, label, help)
    }

    fn field_of_view(&mut self, node: NodeId, fov: Number) -> Option<f64> {
        // The film of a pinhole camera has tan(fov / 2) as half its height:
        // both ends of the range must leave something to divide by.
        if (1e-6..=179.999).contains(&fov.0) {
            return Some(fov.0);
        }
        let place = self.report.field(node, "fov");
        let label = "expected an angle between 0 and 180 degrees";
        let help = "`fov` is the vertical angle from edge to edge, such as 45";
        self.report
            .reject(place, "a field of view that no camera has", label, help)
    }

    /// The eye looks somewhere, and `up` says which way is up.
    fn check_view(&mut self, node: NodeId, view: glam::DVec3, up: glam::DVec3) -> Option<()> {
        let Some(forward) = unit(view) else {
            let place = self.report.field(node, "look_at");
            let help = "move one of them";
            return self.report.reject(
                place,
                "`look_at` is where the eye is",
                "same as `eye`",
                help,
            );
        };
        // Two roundings per product and the difference of two, on unit
        // vectors with three roundings each.
        if forward.cross(up).length() <= gamma(16) {
            let has_up = self.report.field(node, "up") != node;
            let place = self
                .report
                .field(node, if has_up { "up" } else { "look_at" });
            let other = if up.x == 0.0 && up.y == 0.0 {
                "(0, 1, 0)"
            } else {
                "(0, 0, 1)"
            };
            let message = "`up` is parallel to the direction of view";
            let label = if has_up {
                "expected another direction"
            } else {
                "straight along the default `up`"
            };
            return self
                .report
                .reject(place, message, label, format!("write `up: {other}`"));
        }
        Some(())
    }

    pub(super) fn settings(&mut self, exposure: Option<f64>) -> Settings {
        let mut settings = Settings {
            exposure,
            ..Settings::default()
        };
        let Some(Part { node, value }) = self.description.render.as_ref() else {
            return settings;
        };
        let node = *node;
        self.counts(node, value, &mut settings);
        settings.seed = value.seed.unwrap_or(settings.seed);
        settings.sampler = value.sampler;
        settings.kernel = value.kernel;
        settings.guidance = value.guidance;
        settings.indirect = value.indirect.unwrap_or(settings.indirect);
        if let Some(radius) = value.radius {
            if (1e-3..=1e3).contains(&radius.0) {
                settings.radius = radius.0;
            } else {
                let place = self.report.field(node, "radius");
                let label = "expected 0.001 to 1000";
                let help =
                    "the radius is counted in widths of a pixel; leave it out for the default";
                self.report
                    .reject::<()>(place, "a kernel radius out of range", label, help);
            }
        }
        if let Some(effects) = &value.effects {
            self.effects(node, effects, &mut settings);
        }
        if let Some(memory) = &value.memory {
            settings.memory = self.memory(node, memory).unwrap_or(settings.memory);
        }
        settings
    }

    fn effects(&mut self, node: NodeId, said: &EffectsDescription, settings: &mut Settings) {
        let block = self.report.field(node, "effects");
        for &(effect, choice) in &said.0 {
            let name = effect.name();
            let place = self.report.field(block, name);
            if !choice.suits(effect) {
                let message = format!("`{name}` cannot be switched");
                let (label, help) = match effect.switch() {
                    Switch::Never => (
                        "it belongs to a material or a light",
                        "leave it out here; to be without it, change the object or the light",
                    ),
                    Switch::On | Switch::OffOrOn => (
                        "without it the scene would be another one",
                        "write `Auto` or `On`",
                    ),
                };
                self.report.reject::<()>(place, message, label, help);
            } else if effect == Effect::Indirect && choice == Choice::On && !settings.indirect {
                let message = "`indirect` is switched off and on";
                let help = "remove one of the two";
                self.report
                    .reject::<()>(place, message, "`indirect: false` says otherwise", help);
            } else {
                settings.effects.set(effect, choice);
            }
        }
    }

    fn counts(&mut self, node: NodeId, value: &RenderDescription, settings: &mut Settings) {
        let counts = [
            ("passes", value.passes.map(u64::from), u64::from(MAX_PASSES)),
            ("photons", value.photons, MAX_PHOTONS),
            (
                "max_depth",
                value.max_depth.map(u64::from),
                u64::from(MAX_DEPTH),
            ),
        ];
        for (key, count, most) in counts {
            if count.is_some_and(|n| n == 0 || n > most) {
                let place = self.report.field(node, key);
                let message = format!("`{key}` is out of range");
                let label = format!("expected 1 to {most}");
                self.report
                    .reject::<()>(place, message, label, "leave it out for the default");
            }
        }
        settings.passes = value.passes.unwrap_or(settings.passes);
        settings.photons = value.photons;
        settings.max_depth = value.max_depth.unwrap_or(settings.max_depth);
    }

    fn memory(&mut self, node: NodeId, memory: &Memory) -> Option<u64> {
        let bytes = match memory {
            Memory::Bytes(n) => Some(*n),
            Memory::Text(text) => parse_memory(text),
        };
        match bytes {
            Some(n) if MEMORY.contains(&n) => Some(n as u64),
            Some(_) => {
                let place = self.report.field(node, "memory");
                let help = "such as \"1 GiB\"";
                self.report.reject(
                    place,
                    "a memory limit out of range",
                    "expected 1 MiB to 1 PiB",
                    help,
                )
            }
            None => {
                let place = self.report.field(node, "memory");
                let label = "expected a number of bytes, or a number and a unit";
                let help =
                    "units are B, kB, MB, GB, TB and KiB, MiB, GiB, TiB; such as \"512 MiB\"";
                self.report
                    .reject(place, "this is not an amount of memory", label, help)
            }
        }
    }
}

/// Bytes of `"512 MiB"`; case and spaces don't matter.
fn parse_memory(text: &str) -> Option<f64> {
    let text = text.trim();
    let split = text
        .find(|c: char| c.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let number: f64 = text[..split].trim().parse().ok()?;
    let unit = match text[split..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1_048_576.0,
        "gib" => 1_073_741_824.0,
        "tib" => 1_099_511_627_776.0,
        _ => return None,
    };
    Some(number * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_texts() {
        assert_eq!(parse_memory("512 MiB"), Some(536_870_912.0));
        assert_eq!(parse_memory(" 1.5gb "), Some(1.5e9));
        assert_eq!(parse_memory("1024"), Some(1024.0));
        for wrong in ["", "MiB", "5 parsecs", "1 2 MB", "five MB"] {
            assert_eq!(parse_memory(wrong), None, "{wrong:?}");
        }
    }
}
