//! What a shape is, by polynomials whose sign tells inside from outside, and
//! what that makes of a ray: the slow way to find what it meets.

use glam::DVec3;
use nephroid::geometry::{Ray, SurfacePoint, World};

use crate::{
    along::Poly,
    exact::{Dd, vec},
    field::Field,
    leaks::Bag,
    quick::Sight,
};

/// What is inside, over the numbers of fields.
pub(crate) enum Tree {
    Below(usize),
    All(Vec<Tree>),
    Any(Vec<Tree>),
    Not(Box<Tree>),
}

impl Tree {
    /// Whether it holds, if the signs of the fields are known well enough:
    /// -1, 1 or, where unknown, 0.
    pub(crate) fn holds(&self, sign: &impl Fn(usize) -> i8) -> Option<bool> {
        match self {
            Self::Below(i) => match sign(*i) {
                0 => None,
                s => Some(s < 0),
            },
            Self::Not(tree) => tree.holds(sign).map(|is| !is),
            Self::All(list) => Self::first(list, sign, false),
            Self::Any(list) => Self::first(list, sign, true),
        }
    }

    /// `decides` if one of the list is so, not if none may be.
    fn first(list: &[Self], sign: &impl Fn(usize) -> i8, decides: bool) -> Option<bool> {
        let mut all = Some(!decides);
        for tree in list {
            match tree.holds(sign) {
                Some(is) if is == decides => return Some(decides),
                Some(_) => {}
                None => all = None,
            }
        }
        all
    }
}

/// A shape.
pub(crate) struct Truth {
    pub(crate) fields: Vec<Field>,
    pub(crate) tree: Tree,
    /// For an open surface: it is where the first field is zero and the tree
    /// holds. A closed one bounds what the tree says is inside.
    pub(crate) open: bool,
    /// How far a point may be off because of what the ray and the shape's own
    /// numbers are rounded to, beyond the error that it states: over the
    /// distance from the origin of the world and from the start of the ray.
    pub(crate) slack: [f64; 2],
    /// No way through the shape is longer.
    pub(crate) size: f64,
}

/// What a ray meets, as the shape says.
pub(crate) struct Meets {
    /// Where it meets the shape first, and then straight on, in its parameter:
    /// the end of the hunt where nothing is met.
    pub(crate) first: f64,
    pub(crate) second: f64,
    /// Whether anything is met.
    pub(crate) something: bool,
    /// Whether it enters there; as if it did if nothing is met.
    pub(crate) entering: bool,
}

/// A ray beside a shape.
struct Walk<'a> {
    truth: &'a Truth,
    ray: &'a Ray,
    along: Vec<Poly>,
    /// Roots and turning points of all fields, from 0 to where nothing is.
    breaks: Vec<f64>,
    /// What the start may be off, in metres.
    error: f64,
    /// That times the slope there, of the fields on whose zero it may be. A
    /// ray that leaves a surface is asked where it meets the level on which it
    /// starts, which may be far from zero where the slope is less.
    levels: Vec<f64>,
}

/// A stretch without a crossing, as somebody says, and whether it is inside.
struct Claim {
    from: f64,
    to: f64,
    inside: bool,
}

/// What a comparison says.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Right,
    /// Wrong for this start, right for one within the error of it.
    Within,
    Wrong,
}

impl Truth {
    /// Whether what a ray meets that leaves a point is what it should: at a
    /// glance if that tells, by 32 digits if not.
    pub(crate) fn judge(&self, world: &World, point: &SurfacePoint, dir: DVec3) -> Bag {
        let ray = point.spawn(dir);
        let meets = self.meets(world, &ray);
        if Sight::confirms(self, &ray, point, &meets) {
            return Bag {
                rays: 1,
                glances: 1,
                ..Bag::default()
            };
        }
        self.judge_slowly(&ray, point, &meets)
    }

    /// What a ray meets.
    pub(crate) fn meets(&self, world: &World, ray: &Ray) -> Meets {
        let dir = ray.dir;
        let end = 3.0 * self.size;
        let hit = world.closest(ray, f64::INFINITY);
        let first = hit.map_or(end, |hit| hit.t);
        // Where it is met once more, straight on.
        let met = hit.map(|hit| world.surface(ray, &hit));
        let second = met.as_ref().map_or(end, |met| {
            let on = met.spawn(dir);
            let past = (on.origin - ray.origin).dot(dir) / dir.length_squared();
            world
                .closest(&on, f64::INFINITY)
                .map_or(end, |hit| past + hit.t)
        });
        Meets {
            first,
            second,
            something: met.is_some(),
            entering: met.is_none_or(|met| met.ng.dot(dir) < 0.0),
        }
    }

    /// What a start of this ray may be off, in metres: the point may be off by
    /// its error along each axis, and the start is pushed by at most the root
    /// of 3 times as much and to the next float.
    pub(crate) fn error_of(&self, ray: &Ray, point: &SurfacePoint) -> f64 {
        let [by_place, by_way] = self.slack;
        let largest = ray.origin.abs().max_element();
        4.0 * (point.error + f64::EPSILON * largest) + by_place * largest + by_way * self.size
    }

    /// Judges in 32 digits.
    pub(crate) fn judge_slowly(&self, ray: &Ray, point: &SurfacePoint, meets: &Meets) -> Bag {
        let &Meets {
            first,
            second,
            something,
            entering,
        } = meets;
        let walk = Walk::new(self, ray, point);
        let end = 3.0 * self.size;
        let mut bag = Bag {
            rays: 1,
            ..Bag::default()
        };
        let verdicts = if self.open {
            [
                walk.crosses_nothing(first.min(end), something),
                if something {
                    walk.is_met_at(first)
                } else {
                    Verdict::Right
                },
            ]
        } else {
            let verdicts = walk.compare_all(first.min(end), second.min(end), entering);
            // A chord so short that the normal's rounding decides which end of
            // it was met: the start knows on which side it is.
            let side = point.ng.dot(ray.dir) > 0.0;
            if verdicts.contains(&Verdict::Wrong) && something && entering != side {
                match walk.compare_all(first.min(end), second.min(end), side) {
                    other if other.contains(&Verdict::Wrong) => verdicts,
                    _ => [Verdict::Within; 2],
                }
            } else {
                verdicts
            }
        };
        match verdicts {
            [Verdict::Wrong, _] => bag.missed = 1,
            [_, Verdict::Wrong] => bag.false_hits = 1,
            [Verdict::Right, Verdict::Right] => {}
            _ => bag.undecided = 1,
        }
        bag
    }
}

/// Places between two breaks at which it is looked closely.
const LOOKS: u32 = 8;

impl<'a> Walk<'a> {
    fn new(truth: &'a Truth, ray: &'a Ray, point: &SurfacePoint) -> Self {
        let along: Vec<Poly> = truth.fields.iter().map(|f| f.along(ray)).collect();
        let end = 3.0 * truth.size;
        let mut breaks = vec![0.0, end];
        for poly in &along {
            poly.breaks(0.0, end, &mut breaks);
        }
        breaks.sort_by(f64::total_cmp);
        let error = truth.error_of(ray, point);
        let mut walk = Self {
            truth,
            ray,
            along,
            breaks,
            error,
            levels: Vec::new(),
        };
        walk.levels = (0..walk.along.len())
            .map(|i| {
                let level = error * walk.slope(i, 0.0);
                if walk.along[i].at(0.0).0.abs() <= level {
                    level
                } else {
                    0.0
                }
            })
            .collect();
        walk
    }

    /// How steep a field is there.
    fn slope(&self, field: usize, t: f64) -> f64 {
        let (o, d) = (vec(self.ray.origin), vec(self.ray.dir));
        let at = std::array::from_fn(|i| o[i] + d[i] * Dd::of(t));
        self.truth.fields[field].slope::<Dd>(at)
    }

    /// The sign of a field, if moving the place by the error leaves it so.
    fn firm_sign(&self, field: usize, t: f64) -> i8 {
        let (value, lost) = self.along[field].at(t);
        let margin = (self.error * self.slope(field, t)).max(self.levels[field]);
        if value.abs() <= lost + margin {
            return 0;
        }
        if value < 0.0 { -1 } else { 1 }
    }

    /// Whether the place is inside; where the sign of a field isn't even proven
    /// nobody knows.
    fn inside(&self, t: f64) -> Option<bool> {
        self.truth.tree.holds(&|i| self.along[i].sign(t))
    }

    /// The same for all places within the error.
    fn firmly_inside(&self, t: f64) -> Option<bool> {
        self.truth.tree.holds(&|i| self.firm_sign(i, t))
    }

    /// The stretches between breaks within another one.
    fn stretches(&self, from: f64, to: f64) -> impl Iterator<Item = [f64; 2]> {
        self.breaks
            .windows(2)
            .map(move |pair| [pair[0].max(from), pair[1].min(to)])
            .filter(|[a, b]| a < b)
    }

    fn looks([a, b]: [f64; 2]) -> impl Iterator<Item = f64> {
        (0..=LOOKS).map(move |i| a + (b - a) * (f64::from(i) / f64::from(LOOKS)))
    }

    /// What is true of the claim that a closed shape is entered or left at one
    /// place and then met at another one.
    fn compare_all(&self, first: f64, second: f64, entering: bool) -> [Verdict; 2] {
        let claims = [(0.0, first, !entering), (first, second, entering)];
        let claims = claims.map(|(from, to, inside)| Claim { from, to, inside });
        let verdicts = [self.compare(&claims[0]), self.compare(&claims[1])];
        if !verdicts.contains(&Verdict::Wrong) && self.has_the_order_of(&claims) {
            return [Verdict::Right; 2];
        }
        verdicts
    }

    /// What is true of a claim about a closed shape.
    fn compare(&self, claim: &Claim) -> Verdict {
        let mut verdict = Verdict::Right;
        for [a, b] in self.stretches(claim.from, claim.to) {
            // As near as this is where it is said to be.
            if b - a <= self.error || self.inside(0.5 * (a + b)) == Some(claim.inside) {
                continue;
            }
            let wrong = |t| self.firmly_inside(t) == Some(!claim.inside);
            if Self::looks([a, b]).any(wrong) {
                return Verdict::Wrong;
            }
            verdict = Verdict::Within;
        }
        verdict
    }

    /// Whether the first crossings are those of two claims in their order,
    /// though not to the error: a chord at a grazing angle is as long as the
    /// root of it.
    fn has_the_order_of(&self, [near, far]: &[Claim; 2]) -> bool {
        let mut changes = Vec::new();
        let mut is = near.inside;
        for [a, b] in self.stretches(0.0, f64::INFINITY) {
            if self.inside(0.5 * (a + b)) != Some(is) {
                changes.push(a);
                is = !is;
            }
        }
        let end = 3.0 * self.truth.size;
        let [first, second] = [0, 1].map(|i| changes.get(i).copied().unwrap_or(end));
        near.to < end && 0.0 < first && first < far.to && near.to < second
    }

    /// Whether the tree of an open surface holds there, for all places within
    /// the error.
    fn is_within(&self, t: f64) -> Option<bool> {
        let sign = |i| if i == 0 { -1 } else { self.firm_sign(i, t) };
        self.truth.tree.holds(&sign)
    }

    /// Whether an open surface may be said to be nowhere before a place, which
    /// may be a crossing itself.
    fn crosses_nothing(&self, to: f64, ends_there: bool) -> Verdict {
        let mut verdict = Verdict::Right;
        // The side on which the ray is for sure, and whether it changed since
        // where the surface may be or must be.
        let (mut last, mut may, mut must) = (0, false, false);
        let mut before = 0;
        for [a, b] in self.stretches(0.0, to) {
            let now = self.along[0].sign(0.5 * (a + b));
            if before * now < 0 {
                let within = self.is_within(a);
                must |= within == Some(true);
                may |= within.is_none();
            }
            before = now;
            let firm = Self::looks([a, b]).map(|t| self.firm_sign(0, t));
            for firm in firm.filter(|&s| s != 0) {
                if last != 0 && firm != last && must {
                    return Verdict::Wrong;
                }
                if must || may {
                    verdict = Verdict::Within;
                }
                (last, must, may) = (firm, false, false);
            }
        }
        if (must || may) && !ends_there {
            return Verdict::Within;
        }
        verdict
    }

    /// Whether an open surface is where a ray is said to meet it.
    fn is_met_at(&self, t: f64) -> Verdict {
        let within = self.is_within(t);
        if self.firm_sign(0, t) != 0 || within == Some(false) {
            return Verdict::Wrong;
        }
        let reach = self.error + 4.0 * f64::EPSILON * t;
        let changes = self.breaks.windows(3).filter(|at| {
            let sides = [0, 1].map(|i| self.along[0].sign(0.5 * (at[i] + at[i + 1])));
            sides[0] * sides[1] < 0
        });
        let near = changes.map(|at| at[1]).any(|root| {
            let between = [root.min(t), root.max(t)];
            between[1] - between[0] <= reach
                || Self::looks(between).all(|t| self.firm_sign(0, t) == 0)
        });
        if near && within.is_some() {
            Verdict::Right
        } else {
            Verdict::Within
        }
    }
}
