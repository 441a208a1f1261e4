//! How an error that is asked for is written.

/// Smallest and largest relative error that can be asked for.
const RANGE: [f64; 2] = [1e-6, 1.0];

/// A relative error such as `5%` or `0.05`.
pub(crate) fn target(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number.trim_end(), 0.01),
        None => (text, 1.0),
    };
    let explain = || "expected a relative error such as 5% or 0.05, up to 100%".to_owned();
    let value: f64 = number.parse().map_err(|_| explain())?;
    let [least, most] = RANGE;
    if (least..=most).contains(&(value * unit)) {
        Ok(value * unit)
    } else if unit == 1.0 && value > most && value <= 100.0 {
        Err(format!("a share is at most 1; did you mean {number}%?"))
    } else {
        Err(explain())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets() {
        for (text, expected) in [
            ("5%", 0.05),
            ("0.05", 0.05),
            ("5 %", 0.05),
            ("0.1%", 0.001),
            ("1", 1.0),
            ("100%", 1.0),
            ("1e-3", 0.001),
        ] {
            let found = target(text).expect(text);
            assert!((found / expected - 1.0).abs() < 1e-15, "{text}: {found}");
        }
        for bad in [
            "", "%", "0", "0%", "-5%", "101%", "nan", "inf", "five", "5%%", "1e-9",
        ] {
            assert!(target(bad).is_err(), "{bad}");
        }
        assert!(target("5").unwrap_err().contains("5%"));
    }
}
