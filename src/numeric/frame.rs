//! Orthonormal frames.

use glam::DVec3;

/// A right-handed orthonormal frame; `n` is its z axis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent.
    pub s: DVec3,
    /// Second tangent.
    pub t: DVec3,
    /// Normal.
    pub n: DVec3,
}

impl Frame {
    /// A frame around the unit vector `n`, after Duff et al., *Building an
    /// Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
    #[inline]
    pub fn around(n: DVec3) -> Self {
        let (s, t) = n.any_orthonormal_pair();
        Self { s, t, n }
    }

    /// From frame coordinates to the space in which the frame is given.
    #[inline]
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }

    /// From the space in which the frame is given to frame coordinates.
    #[inline]
    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orthonormal_near_the_poles() {
        for z in [1.0, -1.0, -0.999_999_999_999, 0.0, -0.0, 0.5] {
            let n = DVec3::new((1.0f64 - z * z).max(0.0).sqrt(), 0.0, z);
            let f = Frame::around(n);
            let worst = [
                f.s.dot(f.t),
                f.s.dot(n),
                f.t.dot(n),
                f.s.length() - 1.0,
                f.t.length() - 1.0,
            ]
            .into_iter()
            .fold(0.0, |m: f64, x| m.max(x.abs()));
            assert!(worst < 1e-14, "z = {z}: defect {worst:e}");
            assert!(f.s.cross(f.t).dot(n) > 0.99, "right-handed");
        }
    }
}
