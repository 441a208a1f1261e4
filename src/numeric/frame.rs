//! Orthonormal frames.

use glam::DVec3;

use super::VectorPair;

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
        let sign = n.z.signum();
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: DVec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// How the frame made by [`around`](Self::around) changes when its normal
    /// changes by `dn`, which is perpendicular to it. The derivative jumps
    /// where the normal's z changes its sign.
    #[inline]
    #[must_use]
    pub fn change(&self, dn: DVec3) -> Self {
        let n = self.n;
        let sign = n.z.signum();
        let a = -1.0 / (sign + n.z);
        let da = a * a * dn.z;
        let db = (dn.x * n.y + n.x * dn.y) * a + n.x * n.y * da;
        Self {
            s: DVec3::new(
                sign * n.x * (2.0 * dn.x * a + n.x * da),
                sign * db,
                -sign * dn.x,
            ),
            t: DVec3::new(db, n.y * (2.0 * dn.y * a + n.y * da), -dn.y),
            n: dn,
        }
    }

    /// From frame coordinates to the space in which the frame is given.
    #[inline]
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }

    /// [`to_world`](Self::to_world) for two vectors.
    #[inline]
    pub fn pair_to_world(&self, v: VectorPair) -> VectorPair {
        VectorPair::along(self.s, v.x)
            + VectorPair::along(self.t, v.y)
            + VectorPair::along(self.n, v.z)
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

    /// Central differences of step 1e-6 along great circles: their error is
    /// about 1e-12, their rounding 1e-10.
    #[test]
    fn change_is_the_derivative() {
        const H: f64 = 1e-6;
        for i in 0..200 {
            let angle = f64::from(i) * 0.7;
            let z = 1.0 - (f64::from(i) + 0.5) / 100.0;
            let r = (1.0 - z * z).sqrt();
            let frame = Frame::around(DVec3::new(r * angle.cos(), r * angle.sin(), z));
            for dn in [frame.s, frame.t, frame.s * 0.3 - frame.t] {
                let moved = |h: f64| Frame::around((frame.n + dn * h).normalize());
                let (a, b) = (moved(H), moved(-H));
                let change = frame.change(dn);
                let off = [
                    (a.s - b.s) / (2.0 * H) - change.s,
                    (a.t - b.t) / (2.0 * H) - change.t,
                    (a.n - b.n) / (2.0 * H) - change.n,
                ]
                .map(DVec3::length);
                assert!(off.iter().all(|x| *x < 1e-8), "{frame:?}: {off:?}");
            }
        }
    }
}
