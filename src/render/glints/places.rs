//! Places in a pixel where images of sources may be.
//!
//! The unit square from which film positions are made is searched like a
//! quadtree: a cell is divided where one of the ways through it comes so near to a
//! source that the same way through another of its points may meet it. How much
//! that changes within a cell is seen from its siblings. What is left at each
//! level is a set of ever smaller cells around the images, and half of the pixel's
//! rays go to such sets.

/// Levels of division at most: the smallest cells are a 4096th of the pixel.
const DEEPEST: u8 = 6;

/// Cells of a level that are divided: those where ways come nearest.
const MOST: usize = 6;

/// Ways through a point of the film that are looked at.
pub(in crate::render) const WAYS: usize = 8;

/// Radii from a source within which a way through a cell of the first level may be;
/// of later levels half as many each time, since ways through a quarter of a cell lie
/// half as far apart.
const REACH: f64 = 64.0;

/// Ways that pass within so many radii of a source say that it may be seen.
pub(in crate::render) const NEAR: f64 = 3.0;

/// A cell of which ways are seen may hold others that come nearer by so many times the
/// difference between it and its siblings.
const SLACK: f64 = 2.5;

/// Sets that follow each other have at most this part of the area.
const SMALLER: f64 = 0.125;

/// Cells of a set at most: what takes more is no small image, and pixels with glints
/// are not to need more memory than the film.
const MOST_IN_SET: usize = 64;

/// The share of the rays that go anywhere in the pixel: what the search has
/// missed counts by at most twice its light.
const ANYWHERE: f64 = 0.5;

/// An image that more cells of a level show is large enough for these cells.
const SEEN: usize = 3;

/// A cell of the unit square: column and row among cells of its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::render) struct Cell {
    level: u8,
    at: [u8; 2],
}

impl Cell {
    const WHOLE: Self = Self {
        level: 0,
        at: [0, 0],
    };

    /// The point of the cell that belongs to a point of the unit square.
    pub(in crate::render) fn place(self, u: [f64; 2]) -> [f64; 2] {
        let side = side(self.level);
        [0, 1].map(|i| (f64::from(self.at[i]) + u[i]) * side)
    }

    fn quarters(self) -> [Self; 4] {
        let [x, y] = self.at;
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| Self {
            level: self.level + 1,
            at: [2 * x + i, 2 * y + j],
        })
    }

    /// The cell and those that touch it.
    fn around(self) -> impl Iterator<Item = Self> {
        let cells = 1u8 << self.level;
        let near = move |i: usize| self.at[i].saturating_sub(1)..(self.at[i] + 2).min(cells);
        near(1).flat_map(move |y| {
            near(0).map(move |x| Self {
                level: self.level,
                at: [x, y],
            })
        })
    }

    fn holds(self, place: [f64; 2]) -> bool {
        let cells = side(self.level).recip();
        (0..2).all(|i| (place[i] * cells) as u8 == self.at[i])
    }
}

fn side(level: u8) -> f64 {
    0.5f64.powi(i32::from(level))
}

/// By how much the distance of each way changes among siblings; where some lack
/// a way, or it is far away, by all of `reach`.
fn steps(siblings: &[[f64; WAYS]; 4], reach: f64) -> [f64; WAYS] {
    std::array::from_fn(|w| {
        let of_way = siblings.map(|ways| ways[w].min(reach));
        let [least, most] = [f64::min, f64::max].map(|f| of_way.into_iter().fold(of_way[0], f));
        (most - least).max(f64::MIN_POSITIVE)
    })
}

/// Places in a pixel where images of sources may be; none of them where those are large.
#[derive(Clone, Debug, Default)]
pub(in crate::render) struct Places {
    /// Sets of cells of one size each, every set much smaller than the one
    /// before.
    sets: Vec<Box<[Cell]>>,
}

impl Places {
    /// Asks for the distances from a source, in radii, of the ways of ray number `j`,
    /// through some point of a cell: once in every quarter of the pixel, and if it is looked
    /// at more `closely`, where images may be. `None` where no way comes near.
    pub(in crate::render) fn search(
        closely: bool,
        mut distances: impl FnMut(u64, Cell) -> [f64; WAYS],
    ) -> Option<Self> {
        let (mut places, mut nearest, mut asked) = (Self::default(), f64::INFINITY, 0);
        let (mut cells, mut area) = (vec![Cell::WHOLE], 1.0);
        for level in 1..=if closely { DEEPEST } else { 1 } {
            let reach = REACH * side(level - 1);
            let (mut near, mut set, mut met) = (Vec::new(), Vec::new(), 0);
            for cell in &cells {
                let quarters = cell.quarters();
                let found = quarters.map(|quarter| {
                    asked += 1;
                    distances(asked - 1, quarter)
                });
                let least = found.map(|ways| ways.into_iter().fold(f64::INFINITY, f64::min));
                met += least.iter().filter(|d| **d <= 1.0).count();
                nearest = least.into_iter().fold(nearest, f64::min);
                let steps = steps(&found, reach);
                for (ways, quarter) in found.into_iter().zip(quarters) {
                    let within = |slack: f64| {
                        let may =
                            |&w: &usize| ways[w] <= reach && ways[w] - 1.0 <= slack * steps[w];
                        (0..WAYS).filter(may).map(|w| ways[w]).reduce(f64::min)
                    };
                    near.extend(within(SLACK).map(|least| (least, quarter)));
                    if within(1.0).is_some() {
                        set.extend(quarter.around());
                    }
                }
            }
            set.sort_unstable();
            set.dedup();
            let left = set.len() as f64 * side(level) * side(level);
            if (1..=MOST_IN_SET).contains(&set.len()) && left <= SMALLER * area {
                area = left;
                places.sets.push(set.into());
            }
            if near.is_empty() || met > SEEN {
                break;
            }
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            cells = near.into_iter().map(|(_, cell)| cell).take(MOST).collect();
        }
        (nearest <= NEAR).then_some(places)
    }

    /// A place, and what light found there weighs, by a number that decides among
    /// the sets and a point of the unit square.
    pub(in crate::render) fn draw(&self, (choice, u): (f64, [f64; 2])) -> ([f64; 2], f64) {
        if self.sets.is_empty() {
            return (u, 1.0);
        }
        let at = (choice - ANYWHERE) / (1.0 - ANYWHERE) * self.sets.len() as f64;
        let place = if at < 0.0 {
            u
        } else {
            let set = &self.sets[(at as usize).min(self.sets.len() - 1)];
            let cell = ((at - at.floor()) * set.len() as f64) as usize;
            set[cell.min(set.len() - 1)].place(u)
        };
        (place, self.density(place).recip())
    }

    /// The density by which places are drawn.
    fn density(&self, place: [f64; 2]) -> f64 {
        let share = (1.0 - ANYWHERE) / self.sets.len() as f64;
        let of_set = |set: &[Cell]| {
            let cell = set.iter().find(|cell| cell.holds(place));
            cell.map_or(0.0, |c| (side(c.level).powi(2) * set.len() as f64).recip())
        };
        ANYWHERE + share * self.sets.iter().map(|set| of_set(set)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Sequence};

    /// A disc in a pixel: how far a point is from its centre, in radii.
    fn away([x, y]: [f64; 2], [cx, cy]: [f64; 2], radius: f64) -> f64 {
        (x - cx).hypot(y - cy) / radius
    }

    fn searched(distance: impl Fn([f64; 2]) -> f64, seed: u64) -> Option<Places> {
        let sequence = Sequence::new(seed, Purpose::Glint, 0, 0);
        Places::search(true, |j, cell| {
            let mut ways = [f64::INFINITY; WAYS];
            // Another way passes near, and hides nothing.
            ways[0] = 4.0;
            ways[1] = distance(cell.place(sequence.at(j).next_2d()));
            ways
        })
    }

    /// Mean and relative variance of what rays find of a function that is 1 where its
    /// `distance` is below 1.
    fn found(places: &Places, distance: impl Fn([f64; 2]) -> f64, rays: u64) -> [f64; 2] {
        let sequence = Sequence::new(9, Purpose::Camera, 1, 1).independent();
        let [mut sum, mut squares] = [0.0; 2];
        for i in 0..rays {
            let mut stream = sequence.at(i);
            let u = stream.next_2d();
            let (place, weight) = places.draw((stream.next_1d(), u));
            if distance(place) < 1.0 {
                sum += weight;
                squares += weight * weight;
            }
        }
        let n = rays as f64;
        [sum / n, squares / n / (sum / n * (sum / n)) - 1.0]
    }

    /// Images of all sizes keep their area, and small ones are seen with a
    /// small part of the variance that they have without search.
    #[test]
    fn images_keep_their_area() {
        for (radius, gain) in [(0.3, 0.9), (0.1, 0.9), (0.03, 5.0), (0.01, 25.0)] {
            let area = std::f64::consts::PI * radius * radius;
            let (mut missed, mut variance) = (0, 0.0);
            for seed in 0..20 {
                let centre = [0.37 + 0.01 * seed as f64, 0.61];
                let distance = |p| away(p, centre, radius);
                let Some(places) = searched(distance, seed) else {
                    missed += 1;
                    continue;
                };
                let [mean, spread] = found(&places, distance, 40_000);
                let error = (spread / 40_000.0).sqrt();
                assert!(
                    (mean / area - 1.0).abs() < 5.0 * error + 1e-9,
                    "{radius} {seed}: {mean} {area}"
                );
                variance += spread / 20.0;
            }
            assert!(missed <= 4, "{radius}: {missed} of 20 missed");
            assert!(
                gain * variance < (1.0 - area) / area,
                "{radius}: {variance} of {}",
                (1.0 - area) / area
            );
        }
    }

    /// A thin line across the pixel is longer than the search can follow: what it
    /// leaves out is still found.
    #[test]
    fn a_line_keeps_its_area() {
        for seed in 0..5 {
            let distance = |[x, y]: [f64; 2]| (y - 0.3 - 0.5 * x).abs() / 0.004;
            let Some(places) = searched(distance, seed) else {
                continue;
            };
            let [mean, spread] = found(&places, distance, 400_000);
            let error = (spread / 400_000.0f64).sqrt();
            assert!((mean / 0.008 - 1.0).abs() < 5.0 * error, "{mean}");
            assert!(spread < 248.0, "{spread} of 124: at most twice as much");
        }
    }

    #[test]
    fn nothing_near_is_no_place() {
        assert!(searched(|_| f64::INFINITY, 1).is_none());
        assert!(searched(|_| 50.0, 1).is_none());
    }

    /// Densities sum to one: the mean of all weights is the pixel's area.
    #[test]
    fn weights_sum_to_the_area() {
        let places = searched(|p| away(p, [0.2, 0.8], 0.01), 3).expect("near");
        assert!(!places.sets.is_empty());
        let [mean, spread] = found(&places, |_| 0.0, 100_000);
        assert!((mean - 1.0).abs() < 5.0 * (spread / 1e5).sqrt(), "{mean}");
    }
}
