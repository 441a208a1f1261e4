//! Photons side by side, so that one instruction evaluates several kernels.

use std::f32::consts::FRAC_2_PI;

use glam::{Vec3, Vec4};

use super::{
    class::{SAME_FACE_COSINE, SLAB, Search, Stored},
    normal,
};

/// Photons of a block: one for each component of a vector register that every
/// machine has.
pub(super) const LANES: usize = 4;

/// By how much smaller the areas of the kernels are that are evaluated beside
/// each kernel, from the same photons: what they find otherwise tells the blur.
const NARROWER: [f32; 2] = [2.0, 4.0];

/// Squared way to a photon over the square of its major semi-axis, beyond which
/// not even one above the slab reaches the query.
const FARTHEST: f32 = 1.0 / (1.0 - SLAB * SLAB) + 1e-5;

/// Further than any photon.
const NOWHERE: f32 = 1e18;

/// Photons, one a component.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    position: [Vec4; 3],
    axis: [Vec4; 3],
    normal: [Vec4; 3],
    major: Vec4,
    minor: Vec4,
    fold: Vec4,
    flux: [[f32; 3]; LANES],
    sheet: [f32; LANES],
}

/// A kernel that reaches a query.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reaching {
    /// Its place in the block.
    lane: usize,
    /// Its height at the query in 1/m2.
    pub(super) height: f32,
    /// Squared distances of the query, and of its image in the mirror that a fold
    /// is, in units of the semi-axes, the first below 1; and the kernel's height
    /// where that is 0.
    q: [f32; 2],
    peak: f32,
    /// Semi-axes, metres.
    pub(super) major: f32,
    pub(super) minor: f32,
}

impl Reaching {
    /// Heights of the kernel drawn in by each factor of [`NARROWER`].
    #[inline]
    pub(super) fn narrower(&self) -> [f32; 2] {
        // A kernel of the m-th part of the area is m (1 - m q) high.
        let height = |m: f32, q: f32| (m - q * (m * m)).max(0.0);
        NARROWER.map(|m| (height(m, self.q[0]) + height(m, self.q[1])) * self.peak)
    }
}

impl Block {
    /// The photons of these numbers, the last block filled up with photons
    /// that reach nothing.
    pub(super) fn pack(photons: &[Stored], numbers: &[u32]) -> impl Iterator<Item = Self> {
        let nobody = Stored {
            position: [NOWHERE; 3],
            fold: f32::INFINITY,
            ..Stored::default()
        };
        numbers.chunks(LANES).map(move |numbers| {
            let lane = |i: usize| numbers.get(i).map_or(nobody, |&n| photons[n as usize]);
            let lanes = [lane(0), lane(1), lane(2), lane(3)];
            let each = |of: &dyn Fn(&Stored) -> f32| Vec4::from(lanes.each_ref().map(of));
            let normals = lanes.map(|p| normal::decode(p.normal));
            Self {
                position: [0, 1, 2].map(|k| each(&|p| p.position[k])),
                axis: [0, 1, 2].map(|k| each(&|p| p.axis[k])),
                normal: [0, 1, 2].map(|k| Vec4::from(normals.map(|n| n[k]))),
                major: each(&|p| p.major),
                minor: each(&|p| p.minor),
                fold: each(&|p| p.fold),
                flux: lanes.map(|p| p.flux),
                sheet: lanes.map(|p| p.sheet),
            }
        })
    }

    /// Calls `found` with every kernel that reaches `query`, in order.
    #[inline]
    pub(super) fn kernels(&self, query: Vec3, search: &Search, mut found: impl FnMut(&Reaching)) {
        let dot = |a: &[Vec4; 3], b: &[Vec4; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let query = query.to_array().map(Vec4::splat);
        let offset = [0, 1, 2].map(|k| self.position[k] - query[k]);
        let (least, most) = (Vec4::splat(search.least), Vec4::splat(search.most));
        let sized = self.major.cmpgt(Vec4::ZERO);
        let blind = Vec4::splat(search.blind);
        let bounded = |axis: Vec4| Vec4::select(sized, axis.max(least).min(most), blind);
        let (major, minor) = (bounded(self.major), bounded(self.minor));
        let squared = dot(&offset, &offset);
        let (major2, minor2) = (major * major, minor * minor);
        // Photons that come after each other are near each other: most blocks
        // hold none that reaches the query.
        if squared.cmpgt(major2 * FARTHEST).all() {
            return;
        }
        let along = dot(&offset, &self.axis);
        // The mean of the distances from both tangent planes.
        let up = search.normal.to_array().map(Vec4::splat);
        let height = (dot(&offset, &up) + dot(&offset, &self.normal)) * 0.5;
        let (along2, height2) = (along * along, height * height);
        let across2 = (squared - height2 - along2).max(Vec4::ZERO);
        let q = along2 / major2 + across2 / minor2;
        let same_face = dot(&self.normal, &up).cmpge(Vec4::splat(SAME_FACE_COSINE));
        let same_slab = height2.cmple(squared.max(minor2) * (SLAB * SLAB));
        let mut reaching = (q.cmplt(Vec4::ONE) & same_face & same_slab).bitmask();
        if reaching == 0 {
            return;
        }
        let mut image = Vec4::ONE;
        // A fold throws the part of a kernel back that was widened beyond it.
        let folded = minor.cmpgt(self.fold);
        if folded.any() {
            let (n, a) = (&self.normal, &self.axis);
            let away = [0, 1, 2].map(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                n[i] * a[j] - n[j] * a[i]
            });
            // How far from the fold the query lies.
            let depth = self.fold - dot(&offset, &away);
            let from_image = (across2 + self.fold * depth * 4.0).max(Vec4::ZERO);
            let mirrored = along2 / major2 + from_image / minor2;
            image = Vec4::select(folded, mirrored, Vec4::ONE);
            reaching &= !(folded & depth.cmplt(Vec4::ZERO)).bitmask();
        }
        let peak = FRAC_2_PI / (major * minor);
        let height = (Vec4::ONE - q + (Vec4::ONE - image).max(Vec4::ZERO)) * peak;
        let height = height.to_array();
        let (q, image, peak) = (q.to_array(), image.to_array(), peak.to_array());
        let (major, minor) = (major.to_array(), minor.to_array());
        while reaching != 0 {
            let lane = reaching.trailing_zeros() as usize;
            found(&Reaching {
                lane,
                height: height[lane],
                q: [q[lane], image[lane]],
                peak: peak[lane],
                major: major[lane],
                minor: minor[lane],
            });
            reaching &= reaching - 1;
        }
    }

    /// The flux of a photon in W.
    #[inline]
    pub(super) fn flux(&self, kernel: &Reaching) -> [f32; 3] {
        self.flux[kernel.lane]
    }

    /// The area of a photon's sheet of light in m2.
    #[inline]
    pub(super) fn sheet(&self, kernel: &Reaching) -> f32 {
        self.sheet[kernel.lane]
    }

    /// The place of a photon.
    pub(super) fn position(&self, kernel: &Reaching) -> Vec3 {
        component(&self.position, kernel.lane)
    }

    /// Unit vector of a kernel's major axis.
    pub(super) fn axis(&self, kernel: &Reaching) -> Vec3 {
        component(&self.axis, kernel.lane)
    }
}

fn component(v: &[Vec4; 3], lane: usize) -> Vec3 {
    Vec3::new(v[0][lane], v[1][lane], v[2][lane])
}
