//! Asking a map from one place after another.
//!
//! Queries of neighbouring pixels meet the same photons. Their kernels are
//! found once for a small region, by a search of the trees that is a little
//! wider than one query needs, and kept side by side; each query in the region
//! then tests them several at a time. Where queries do not follow each other
//! closely, each searches for itself. The answer does not depend on which of
//! the two is done: the photons are summed in the order of their numbers.

use glam::DVec3;

use crate::spectrum::Rgb;

use super::{
    Ellipse, Gathered, PhotonMap, Query,
    block::{Block, LANES, Reaching},
    class::Search,
};

/// Regions that are remembered at once: a pixel may show several surfaces.
const REGIONS: usize = 6;

/// Radius of a region in distances between queries.
const RADIUS: f64 = 6.0;

/// By how much the kernels of a region's queries may exceed those of the query
/// for which it was searched.
const SLACK: f32 = 1.2;

/// Most photons of a region: more would take more memory than they are worth.
const MOST_PHOTONS: usize = 1 << 14;

/// Largest radius of a region in metres: squares of more leave single precision.
const LARGEST: f64 = 1e18;

/// What is known of a region.
#[derive(Clone, Copy, Debug)]
enum Known {
    /// One query has been here.
    Marked,
    /// The photons for kernels that are no wider than these.
    Photons([Search; 2]),
    /// There are too many photons.
    Crowded,
}

/// Where queries were, and perhaps what photons are near.
#[derive(Debug)]
struct Region {
    center: DVec3,
    /// In metres; negative where there is no region.
    radius: f64,
    known: Known,
    /// Photons by class, caustics first.
    blocks: Vec<Block>,
    /// Where each class ends.
    ends: Vec<usize>,
}

/// Asks a map, and remembers what is near.
pub struct Vicinity<'a> {
    map: &'a PhotonMap,
    regions: [Region; REGIONS],
    /// The region that is forgotten next.
    oldest: usize,
    numbers: Vec<u32>,
    draws_in: bool,
}

impl<'a> Vicinity<'a> {
    /// Nothing is near yet.
    pub fn new(map: &'a PhotonMap) -> Self {
        Self {
            map,
            regions: std::array::from_fn(|_| Region {
                center: DVec3::ZERO,
                radius: -1.0,
                known: Known::Marked,
                blocks: Vec::new(),
                ends: Vec::new(),
            }),
            oldest: 0,
            numbers: Vec::new(),
            draws_in: false,
        }
    }

    /// The same, to find out as well what narrower kernels find
    /// ([`Gathered::narrower`]).
    pub fn drawing_in(map: &'a PhotonMap) -> Self {
        Self {
            draws_in: true,
            ..Self::new(map)
        }
    }

    /// Whether it is found out what narrower kernels find.
    pub fn draws_in(&self) -> bool {
        self.draws_in
    }

    /// The map.
    pub fn map(&self) -> &'a PhotonMap {
        self.map
    }

    /// Irradiance in W/m2 at a point, by Epanechnikov kernels
    /// `2/pi (1 - q) / (a b)`, where `a`, `b` are the semi-axes of the photon's
    /// ellipse and `q < 1` the squared distance in units of them. Kernels
    /// longer than `clear`, which is asked for only where there are photons,
    /// count by a factor: `weigh` is given the offset of the photon and its
    /// ellipse, and answers for it and for ellipses of half and of a quarter of
    /// its area, of which only the first counts where no kernel is drawn in; 0
    /// where a wall stands between.
    pub fn irradiance(
        &mut self,
        query: &Query,
        clear: impl Fn() -> f64,
        weigh: impl Fn(DVec3, &Ellipse) -> [f64; 3],
    ) -> Gathered {
        let finite = query.p.is_finite() && query.n.is_finite();
        if !(finite
            && query.kernels.least >= 0.0
            && query.kernels.most > 0.0
            && query.kernels.blind >= 0.0)
        {
            return Gathered::default();
        }
        if self.draws_in {
            self.sum::<true>(query, clear, weigh)
        } else {
            self.sum::<false>(query, clear, weigh)
        }
    }

    /// The same; `DRAWN_IN` says whether narrower kernels are evaluated, too: what
    /// decides that for a whole pass must not be asked for every kernel.
    fn sum<const DRAWN_IN: bool>(
        &mut self,
        query: &Query,
        clear: impl Fn() -> f64,
        weigh: impl Fn(DVec3, &Ellipse) -> [f64; 3],
    ) -> Gathered {
        let mut gathered = Gathered::default();
        let map = self.map;
        let searches = query.searches(map.rotation);
        let p = map.rotation * query.p;
        let near = query.kernels.spacing > 0.0 && RADIUS * query.kernels.spacing < LARGEST;
        let region = near
            .then(|| self.region(p, query, &searches, &mut gathered))
            .flatten();
        let back = map.rotation.transpose();
        let mut sums = [[0.0; 3]; 2];
        let mut sheets = 0.0;
        let mut narrower = [[0.0; 2]; 2];
        let mut narrower_sheets = [0.0; 2];
        for (c, class) in map.classes().enumerate() {
            let bounced = usize::from(c >= map.caustics.len());
            if bounced == 0 && !query.kernels.caustics {
                continue;
            }
            let search = &searches[bounced];
            let local = class.local(p);
            let sum = &mut sums[bounced];
            let less = &mut narrower[bounced];
            let mut add = |block: &Block, kernel: &Reaching| {
                let mut k = f64::from(kernel.height);
                let mut power = [1.0; 2];
                if f64::from(kernel.major) > clear() {
                    let offset = block.position(kernel) - local;
                    let ellipse = Ellipse {
                        axis: back * block.axis(kernel).as_dvec3(),
                        major: f64::from(kernel.major),
                        minor: f64::from(kernel.minor),
                    };
                    let [full, half, quarter] = weigh(back * offset.as_dvec3(), &ellipse);
                    k *= full;
                    if k <= 0.0 {
                        return;
                    }
                    power = [half, quarter];
                }
                gathered.accepted += 1;
                let flux = block.flux(kernel).map(f64::from);
                let sheet = f64::from(block.sheet(kernel));
                sheets += k * sheet;
                for (s, f) in sum.iter_mut().zip(flux) {
                    *s += k * f;
                }
                if DRAWN_IN {
                    let whole = flux[0] + flux[1] + flux[2];
                    let narrower = kernel.narrower();
                    for i in 0..2 {
                        let k = power[i] * f64::from(narrower[i]);
                        less[i] += k * whole;
                        narrower_sheets[i] += k * sheet;
                    }
                }
            };
            if let Some(r) = region {
                for block in self.regions[r].class(c) {
                    gathered.tested += LANES as u32;
                    block.kernels(local, search, |kernel| add(block, kernel));
                }
            } else {
                gathered.visited += class.find(p, search, 0.0, &mut self.numbers);
                for block in Block::pack(class.photons(), &self.numbers) {
                    gathered.tested += LANES as u32;
                    block.kernels(local, search, |kernel| add(&block, kernel));
                }
            }
        }
        if DRAWN_IN {
            for (less, sum) in narrower.iter_mut().zip(sums) {
                let whole = sum[0] + sum[1] + sum[2];
                *less = less.map(|s| if whole > 0.0 { s / whole } else { 1.0 });
            }
            gathered.narrower = narrower;
            gathered.narrower_sheets = narrower_sheets.map(|s| s * map.per_path);
        }
        let [caustics, bounced] = sums.map(|s| Rgb(s) * map.per_path);
        gathered.sheets = sheets * map.per_path;
        gathered.irradiance = caustics;
        gathered.bounced = bounced;
        gathered
    }

    /// A region whose photons serve a query at `p`. Where one query has been
    /// near, the photons are looked for; where none has, the place is marked.
    fn region(
        &mut self,
        p: DVec3,
        query: &Query,
        searches: &[Search; 2],
        gathered: &mut Gathered,
    ) -> Option<usize> {
        let mut marked = None;
        for (i, region) in self.regions.iter().enumerate() {
            if p.distance_squared(region.center) > region.radius * region.radius.abs() {
                continue;
            }
            match &region.known {
                Known::Marked => marked = Some(i),
                Known::Crowded => return None,
                Known::Photons(bounds) => {
                    let serves = |(q, b): (&Search, &Search)| {
                        q.least <= b.least && q.most <= b.most && q.blind <= b.blind
                    };
                    if searches.iter().zip(bounds).all(serves) {
                        return Some(i);
                    }
                }
            }
        }
        let i = marked.unwrap_or_else(|| {
            self.oldest = (self.oldest + 1) % REGIONS;
            self.oldest
        });
        let region = &mut self.regions[i];
        region.center = p;
        region.radius = RADIUS * query.kernels.spacing;
        region.known = Known::Marked;
        marked?;
        gathered.visited += region.search(self.map, searches, &mut self.numbers);
        matches!(region.known, Known::Photons(_)).then_some(i)
    }
}

impl Region {
    /// Finds all photons that may reach a query in the region; the number of
    /// candidates for it.
    fn search(&mut self, map: &PhotonMap, searches: &[Search; 2], numbers: &mut Vec<u32>) -> u32 {
        let bounds = searches.map(|s| Search {
            least: s.least * SLACK,
            most: s.most * SLACK,
            blind: s.blind * SLACK,
            ..s
        });
        // With room for rounding.
        let margin = (self.radius * (1.0 + 1e-5)) as f32;
        self.blocks.clear();
        self.ends.clear();
        let mut visited = 0;
        for (c, class) in map.classes().enumerate() {
            let bounds = &bounds[usize::from(c >= map.caustics.len())];
            visited += class.find(self.center, bounds, margin, numbers);
            if self.blocks.len() * LANES + numbers.len() > MOST_PHOTONS {
                self.known = Known::Crowded;
                return visited;
            }
            self.blocks.extend(Block::pack(class.photons(), numbers));
            self.ends.push(self.blocks.len());
        }
        self.known = Known::Photons(bounds);
        visited
    }

    /// The photons of a class.
    fn class(&self, c: usize) -> &[Block] {
        let first = c.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.blocks[first..self.ends[c]]
    }
}
