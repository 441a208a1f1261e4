//! The picture as a density of light.

/// A picture: linear brightness, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Brightness from 0 up, finite.
    pub values: Vec<f64>,
}

impl Picture {
    /// The densities that a lens can make of the picture, on `size` cells:
    /// means over each cell, blurred by a binomial of one cell's standard
    /// deviation, raised to at least `darkest` times the brightest, and scaled
    /// to a mean of 1. `None` if the picture is black.
    pub fn density(&self, size: [usize; 2], darkest: f64) -> Option<Vec<f64>> {
        let [width, height] = self.size;
        let rows: Vec<Vec<f64>> = self
            .values
            .chunks(width)
            .map(|row| means(row, size[0]))
            .collect();
        let mut density = vec![0.0; size[0] * size[1]];
        let mut column = vec![0.0; height];
        for i in 0..size[0] {
            for (value, row) in column.iter_mut().zip(&rows) {
                *value = row[i];
            }
            let line = blurred(means(&column, size[1]));
            for (j, value) in line.into_iter().enumerate() {
                density[j * size[0] + i] = value;
            }
        }
        for row in density.chunks_mut(size[0]) {
            let line = blurred(row.to_vec());
            row.copy_from_slice(&line);
        }
        let brightest = density.iter().copied().fold(0.0, f64::max);
        if brightest <= 0.0 {
            return None;
        }
        for value in &mut density {
            *value = darkest + (1.0 - darkest) * (*value / brightest);
        }
        let mean = density.iter().sum::<f64>() / density.len() as f64;
        for value in &mut density {
            *value /= mean;
        }
        Some(density)
    }
}

/// The means of a row of equal steps over `n` equal parts.
fn means(row: &[f64], n: usize) -> Vec<f64> {
    let part = row.len() as f64 / n as f64;
    // The integral from the row's start.
    let mut sums = Vec::with_capacity(row.len() + 1);
    sums.push(0.0);
    for value in row {
        sums.push(sums[sums.len() - 1] + value);
    }
    let integral = |x: f64| {
        let i = (x as usize).min(row.len() - 1);
        sums[i] + (x - i as f64) * row[i]
    };
    (0..n)
        .map(|i| (integral((i + 1) as f64 * part) - integral(i as f64 * part)).max(0.0) / part)
        .collect()
}

/// Weights 1 2 1, twice; the edges mirror.
fn blurred(mut row: Vec<f64>) -> Vec<f64> {
    for _ in 0..2 {
        let last = row.len() - 1;
        let mean = |i: usize| {
            let around = row[i.saturating_sub(1)] + row[(i + 1).min(last)];
            0.25 * around + 0.5 * row[i]
        };
        row = (0..row.len()).map(mean).collect();
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_keep_the_sum() {
        let row = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0];
        assert_eq!(means(&row, 3), [2.0, 2.5, 7.0]);
        for n in [1, 2, 5, 7, 16] {
            let mean = means(&row, n).iter().sum::<f64>() / n as f64;
            assert!((mean - 23.0 / 6.0).abs() < 1e-14, "{n}");
        }
        assert!((means(&row, 4)[1] - (0.5 * 1.0 + 4.0) / 1.5).abs() < 1e-14);
    }

    #[test]
    fn densities_have_mean_one_and_a_floor() {
        let picture = Picture {
            size: [3, 2],
            values: vec![0.0, 0.0, 0.0, 0.0, 0.0, 6.0],
        };
        let density = picture.density([32, 16], 0.1).unwrap();
        let mean = density.iter().sum::<f64>() / 512.0;
        assert!((mean - 1.0).abs() < 1e-14);
        // The bright sixth is that of the last column and row.
        let (dark, bright) = (density[0], density[511]);
        assert!((dark / bright - 0.1).abs() < 1e-14);
        assert!((bright - 1.0 / (0.1 + 0.9 / 6.0)).abs() < 1e-13);
        let black = Picture {
            size: [1, 1],
            values: vec![0.0],
        };
        assert!(black.density([2, 2], 0.1).is_none());
    }
}
