//! A film as bytes, without loss.
//!
//! | what | bytes |
//! |---|---|
//! | width, height | 2 x 4 |
//! | value of a quantum | 8 |
//! | passes of each replicate | 8 x 8 |
//! | samples refused | 8 |
//! | for each row, for each replicate and then each layer, for each channel: the bytes `w` of a count, then the row's counts | 1 + `w` x width |
//! | the same for each group of the replicates and each step between kernels | 1 + `w` x width |
//! | the same for the sheets of light of each replicate, in pixels and then around them, and for each group and step between kernels | 1 + `w` x width |
//! | the same for the passes that told nothing of sheets | 1 + `w` x width |
//!
//! All numbers are little-endian, counts in two's complement. `w` (1 to 16) is
//! what the row's largest count needs: sums of a row have about the same size,
//! and most of a sum's 16 bytes are zero. As every count takes a byte at least,
//! a film in memory is at most sixteen times as large as its bytes.

use std::io::{self, Read, Write};

use rayon::prelude::*;
use thiserror::Error;

use super::accumulator::{Film, GROUPS, REPLICATES};
use crate::numeric::{ExactSum, exact::Quantum};

/// Rows that are encoded at a time, in parallel.
const ROWS: usize = 64;
/// Lists of sums, and rows of counts that each pixel row makes: one for each
/// list and channel.
const LISTS: usize = REPLICATES + 4;
const COLOURS: usize = 3 * LISTS;
/// The same with the differences of kernels, and with the sheets.
const DIFFERENCES: usize = COLOURS + 2 * GROUPS;
/// Counts of sheets of a pixel, and one of passes that told nothing.
const SHEETS: usize = 2 * REPLICATES + 2 * GROUPS;
const PLANES: usize = DIFFERENCES + SHEETS + 1;
/// Bytes before the rows.
const HEAD: usize = 4 + 4 + 8 + 8 * REPLICATES + 8;
/// Bytes of the widest count.
const WIDEST: usize = size_of::<i128>();

/// Why bytes are no film.
#[derive(Debug, Error)]
pub enum StateError {
    /// Reading failed, or the bytes ended early.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The bytes contradict themselves.
    #[error("{0}")]
    Nonsense(&'static str),
}

impl Film {
    /// Writes the film as bytes.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_state(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(&self.width.to_le_bytes())?;
        out.write_all(&self.height.to_le_bytes())?;
        out.write_all(&self.quantum.unit().to_le_bytes())?;
        for passes in self.passes {
            out.write_all(&passes.to_le_bytes())?;
        }
        out.write_all(&self.refused.to_le_bytes())?;
        let height = self.height as usize;
        for first in (0..height).step_by(ROWS) {
            let rows = first..height.min(first + ROWS);
            let encoded: Vec<Vec<u8>> = rows.into_par_iter().map(|y| self.encode_row(y)).collect();
            for bytes in encoded {
                out.write_all(&bytes)?;
            }
        }
        Ok(())
    }

    fn encode_row(&self, y: usize) -> Vec<u8> {
        let width = self.width as usize;
        let row = y * width..(y + 1) * width;
        let mut bytes = Vec::with_capacity(PLANES * (1 + 10 * width));
        for replicate in &self.replicates {
            for channel in 0..3 {
                encode(
                    replicate[row.clone()].iter().map(|s| s[channel]),
                    &mut bytes,
                );
            }
        }
        for layer in 0..4 {
            for channel in 0..3 {
                let sums = self.layers[row.clone()].iter().map(|s| s[layer][channel]);
                encode(sums, &mut bytes);
            }
        }
        for group in 0..GROUPS {
            for step in 0..2 {
                let sums = self.blur[row.clone()].iter().map(|s| s[group][step]);
                encode(sums, &mut bytes);
            }
        }
        let sheets = &self.sheets[row];
        for number in 0..SHEETS {
            let sums = sheets.iter().map(|s| s.counts().nth(number).unwrap_or(0));
            encode(sums.map(|s| ExactSum::of_counts(s.into())), &mut bytes);
        }
        let untold = sheets.iter().map(|s| s.untold);
        encode(untold.map(|n| ExactSum::of_counts(n.into())), &mut bytes);
        bytes
    }

    /// Reads a film from its bytes, of which there are `length`. Memory is
    /// taken for at most sixteen times as many.
    ///
    /// # Errors
    /// If the bytes are not those of a film.
    pub fn read_state(input: &mut dyn Read, length: u64) -> Result<Self, StateError> {
        let mut head = [0; HEAD];
        input.read_exact(&mut head)?;
        let word = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        let half = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        let [width, height] = [half(0), half(4)];
        let quantum = Quantum::of_unit(f64::from_bits(word(8)))
            .ok_or(StateError::Nonsense("the quantum is none"))?;
        let planes = (PLANES as u64).saturating_mul(u64::from(height));
        let least = planes.saturating_mul(1 + u64::from(width));
        if least.saturating_add(HEAD as u64) > length {
            return Err(StateError::Nonsense("the film is larger than its bytes"));
        }
        let mut film = Self::new(width, height, quantum);
        film.passes = std::array::from_fn(|r| word(16 + 8 * r));
        film.refused = word(16 + 8 * REPLICATES);
        let mut left = length - HEAD as u64;
        let mut bytes = vec![0; WIDEST * width as usize];
        for y in 0..height as usize {
            for plane in 0..PLANES {
                let mut size = [0];
                input.read_exact(&mut size)?;
                let size = usize::from(size[0]);
                if !(1..=WIDEST).contains(&size) {
                    return Err(StateError::Nonsense("a count has no such size"));
                }
                let counts = &mut bytes[..size * width as usize];
                left = left
                    .checked_sub(1 + counts.len() as u64)
                    .ok_or(StateError::Nonsense("the rows are longer than the film"))?;
                input.read_exact(counts)?;
                film.decode(y, plane, size, counts)
                    .ok_or(StateError::Nonsense("sheets of light are too many"))?;
            }
        }
        if left > 0 {
            return Err(StateError::Nonsense("the film ends early"));
        }
        Ok(film)
    }

    /// Takes the counts of a row; `None` if they are larger than those of sheets can be.
    fn decode(&mut self, y: usize, plane: usize, size: usize, counts: &[u8]) -> Option<()> {
        let width = self.width as usize;
        let row = y * width..(y + 1) * width;
        let (list, channel) = (plane / 3, plane % 3);
        let values = counts.chunks_exact(size).map(count);
        if let Some(number) = plane.checked_sub(DIFFERENCES) {
            for (sheets, value) in self.sheets[row].iter_mut().zip(values) {
                let value = value.counts();
                if number < SHEETS {
                    *sheets.counts_mut().nth(number)? = value.try_into().ok()?;
                } else {
                    sheets.untold = value.try_into().ok()?;
                }
            }
        } else if let Some(difference) = plane.checked_sub(COLOURS) {
            let sums = self.blur[row].iter_mut();
            sums.zip(values)
                .for_each(|(sum, v)| sum[difference / 2][difference % 2] = v);
        } else if list < REPLICATES {
            let sums = self.replicates[list][row].iter_mut();
            sums.zip(values).for_each(|(sum, v)| sum[channel] = v);
        } else {
            let sums = self.layers[row].iter_mut();
            let layer = list - REPLICATES;
            sums.zip(values)
                .for_each(|(sum, v)| sum[layer][channel] = v);
        }
        Some(())
    }
}

/// Appends the counts of a row, all in as many bytes as the largest needs.
fn encode(sums: impl Iterator<Item = ExactSum> + Clone, bytes: &mut Vec<u8>) {
    // A count and its complement have their highest bit of information at the
    // same place; one more bit is the sign.
    let magnitudes = sums.clone().fold(0, |all, sum| {
        let count = sum.counts();
        all | (count ^ (count >> 127))
    });
    let size = (128 - magnitudes.leading_zeros() as usize) / 8 + 1;
    bytes.push(size as u8);
    for sum in sums {
        bytes.extend_from_slice(&sum.counts().to_le_bytes()[..size]);
    }
}

/// The count behind 1 to 16 bytes.
fn count(bytes: &[u8]) -> ExactSum {
    let is_negative = bytes.last().is_some_and(|b| b & 0x80 != 0);
    let mut whole = [if is_negative { 0xff } else { 0 }; WIDEST];
    whole[..bytes.len()].copy_from_slice(bytes);
    ExactSum::of_counts(i128::from_le_bytes(whole))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::{Layer, PixelSample},
        spectrum::Rgb,
    };
    use proptest::prelude::*;

    fn film(width: u32, height: u32, passes: u32) -> Film {
        let mut film = Film::new(width, height, Quantum::for_typical(0.3));
        for pass in 0..passes {
            let sample = |i: u32| {
                let mut sample = PixelSample::default();
                let v = f64::from(i * 7 + pass * 3) / 13.0;
                sample[Layer::Direct] = Rgb::new(v, -v * 1e-9, v * v);
                sample[Layer::Caustic] = Rgb::grey(libm::exp2(v));
                sample.blur = [0.1 * v, -0.01 * v];
                sample.sheets = [[v, 0.5 + f64::from(i % 2)], [30.0 * v, 25.0]];
                sample.sheet_steps = [0.01 * v, -0.02 * v];
                if i == 1 && pass == 3 {
                    sample.sheets = Default::default();
                }
                if i == 2 {
                    sample[Layer::Indirect] = Rgb::grey(f64::NAN);
                }
                sample
            };
            film.add_pass(pass, &(0..width * height).map(sample).collect::<Vec<_>>());
        }
        film
    }

    fn bytes(film: &Film) -> Vec<u8> {
        let mut bytes = Vec::new();
        film.write_state(&mut bytes).unwrap();
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Film, StateError> {
        let mut rest = bytes;
        let film = Film::read_state(&mut rest, bytes.len() as u64)?;
        assert!(rest.is_empty(), "all was read");
        Ok(film)
    }

    #[test]
    fn films_come_back_as_they_were() {
        for (width, height, passes) in [(0, 0, 0), (1, 1, 0), (5, 3, 11), (3, 130, 2), (7, 0, 9)] {
            let film = film(width, height, passes);
            assert_eq!(read(&bytes(&film)).unwrap(), film);
        }
        assert!(film(5, 3, 11).refused() > 0);
    }

    #[test]
    fn it_takes_half_of_the_memory() {
        let film = film(40, 30, 16);
        let size = bytes(&film).len();
        assert!(size * 2 < film.bytes(), "{size}");
        // Black: one byte a count, and one for each row of them.
        let black = Film::new(40, 30, Quantum::for_typical(1.0));
        assert_eq!(bytes(&black).len(), HEAD + PLANES * 30 * 41);
    }

    #[test]
    fn cut_or_longer_bytes_are_no_film() {
        let whole = bytes(&film(3, 2, 9));
        for end in 0..whole.len() {
            assert!(read(&whole[..end]).is_err(), "{end}");
            let mut rest = &whole[..end];
            let result = Film::read_state(&mut rest, whole.len() as u64);
            assert!(matches!(result, Err(StateError::Io(_))), "{end}");
        }
        let longer = [&whole[..], &[0]].concat();
        assert!(read(&longer).is_err());
    }

    /// A head that promises a giant must not be believed.
    #[test]
    fn giants_are_refused_before_they_take_memory() {
        let mut forged = bytes(&film(3, 2, 9));
        for at in [0, 4] {
            forged[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
            assert!(matches!(read(&forged), Err(StateError::Nonsense(_))));
        }
    }

    proptest! {
        #[test]
        fn counts_of_any_size(values in prop::collection::vec(any::<i128>(), 1..9), shift in 0u32..128) {
            let sums: Vec<ExactSum> = values.iter().map(|v| ExactSum::of_counts(v >> shift)).collect();
            let mut bytes = Vec::new();
            encode(sums.iter().copied(), &mut bytes);
            let size = usize::from(bytes[0]);
            let back: Vec<ExactSum> = bytes[1..].chunks_exact(size).map(count).collect();
            prop_assert_eq!(back, sums);
        }

        #[test]
        fn whatever_the_bytes_nothing_breaks(at in 0usize..2000, value: u8, noise in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut mutated = bytes(&film(3, 2, 9));
            let at = at % mutated.len();
            mutated[at] = value;
            let _ = read(&mutated).map(|film| film.noise());
            let _ = Film::read_state(&mut &noise[..], noise.len() as u64);
        }
    }
}
