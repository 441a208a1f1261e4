//! A unit normal in 32 bits.

use glam::Vec3;

/// A unit vector in 32 bits by the octahedral map (Cigolle et al., JCGT 3(2),
/// 2014); the error is below 1e-4 rad,
/// and it serves a gate only.
pub(super) fn encode(n: Vec3) -> u32 {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let (x, y) = if n.z >= 0.0 {
        (n.x, n.y)
    } else {
        (
            (1.0 - n.y.abs()).copysign(n.x),
            (1.0 - n.x.abs()).copysign(n.y),
        )
    };
    let quantise = |v: f32| ((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16) as u32;
    quantise(x) | (quantise(y) << 16)
}

pub(super) fn decode(code: u32) -> Vec3 {
    let part = |v: u32| f32::from(v as u16 as i16) / 32767.0;
    let (x, y) = (part(code), part(code >> 16));
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize()
}
