//! Numbers and words as a reader wants them.
//!
//! Digits are as many as the number deserves, units are those of speech. All
//! text that comes from data goes through [`escape`] on its way into a file.

use libm::sqrt;

use crate::study::Run;

/// Minutes begin here, in seconds; hours and days at twice their length too,
/// so that no two units show the same time.
const MINUTE: f64 = 60.0;
const HOUR: f64 = 60.0 * MINUTE;
const DAY: f64 = 24.0 * HOUR;

/// Text that is safe between tags and within quoted attributes of HTML and of
/// XML. Control characters, which XML has no words for, become U+FFFD.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            '\t' | '\n' => safe.push(' '),
            '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            _ if c.is_control() => safe.push('\u{fffd}'),
            _ => safe.push(c),
        }
    }
    safe
}

/// `text` cut to `most` columns, with an ellipsis in place of the rest. Wide
/// characters (from the scripts of East Asia on) take two.
pub(super) fn shortened(text: &str, most: usize) -> String {
    if columns(text) <= most {
        return text.to_owned();
    }
    let mut short = String::new();
    for c in text.chars() {
        if columns(&short) + width(c) + 1 > most {
            break;
        }
        short.push(c);
    }
    short.push('…');
    short
}

/// Columns that `text` takes.
pub(super) fn columns(text: &str) -> usize {
    text.chars().map(width).sum()
}

fn width(c: char) -> usize {
    if c < '\u{2e80}' { 1 } else { 2 }
}

/// A number rounded to `count` significant digits: plain from 0.0001 to below
/// a million, else as a power of ten.
pub(super) fn digits(value: f64, count: usize) -> String {
    if value.is_nan() {
        return "not a number".to_owned();
    }
    let sign = if value < 0.0 { "\u{2212}" } else { "" };
    let size = value.abs();
    if size.is_infinite() {
        return format!("{sign}∞");
    }
    if size == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{:.*e}", count.saturating_sub(1), size);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let rounded: f64 = scientific.parse().unwrap_or(size);
        let decimals = (count as i32 - 1 - exponent).max(0) as usize;
        format!("{sign}{rounded:.decimals$}")
    } else {
        format!("{sign}{}", power(mantissa, exponent))
    }
}

/// A mantissa and a power of ten; the mantissa 1 is left out.
pub(super) fn power(mantissa: &str, exponent: i32) -> String {
    let raised: String = exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '0' => '⁰',
            // The other digits follow each other.
            _ => char::from_u32(0x2070 + u32::from(c) - u32::from('0')).unwrap_or(c),
        })
        .collect();
    match mantissa {
        "1" => format!("10{raised}"),
        _ => format!("{mantissa}·10{raised}"),
    }
}

/// An error or a share in per cent, with `count` significant digits.
pub(super) fn per_cent(share: f64, count: usize) -> String {
    format!("{}\u{a0}%", digits(100.0 * share, count))
}

/// A level that was chosen, such as 0.3 %: as many digits as it has, up to 3.
pub(super) fn level(share: f64) -> String {
    let text = digits(100.0 * share, 3);
    let text = if text.contains('.') && !text.contains('·') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    format!("{text}\u{a0}%")
}

/// A time with two significant digits, in the unit in which one would say it.
pub(super) fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds.abs() {
        s if s < 2.0 * MINUTE || !s.is_finite() => (seconds, "s"),
        s if s < 2.0 * HOUR => (seconds / MINUTE, "min"),
        s if s < 2.0 * DAY => (seconds / HOUR, "h"),
        _ => (seconds / DAY, "d"),
    };
    // Two digits of 119 would say 120.
    let count = if value.abs() >= 100.0 { 3 } else { 2 };
    format!("{}\u{a0}{unit}", digits(value, count))
}

/// How many times as much.
pub(super) fn factor(ratio: f64) -> String {
    format!("{}\u{a0}×", digits(ratio, 2))
}

/// The slope of a curve.
pub(super) fn slope(value: f64) -> String {
    let sign = if value < 0.0 { "\u{2212}" } else { "" };
    if value.is_finite() {
        format!("{sign}{:.2}", value.abs())
    } else {
        "unknown".to_owned()
    }
}

/// A word and how many of it.
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// The error of a run: the root of its relMSE. `None` if it is no number.
pub(super) fn error_of(run: &Run) -> Option<f64> {
    let error = sqrt(run.relmse);
    (!error.is_nan()).then_some(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_could_be_markup_is_not() {
        assert_eq!(
            escape("<a href='x' b=\"y\">&\u{1}\n\u{85}é"),
            "&lt;a href=&#39;x&#39; b=&quot;y&quot;&gt;&amp;\u{fffd} \u{fffd}é"
        );
    }

    #[test]
    fn numbers_have_the_digits_they_deserve() {
        for (value, count, text) in [
            (0.0123456, 2, "0.012"),
            (9.96, 2, "10"),
            (0.996, 2, "1.0"),
            (12345.0, 2, "12000"),
            (1e6, 2, "1.0·10⁶"),
            (1.5e-7, 2, "1.5·10⁻⁷"),
            (1e-7, 1, "10⁻⁷"),
            (-3.2149, 3, "\u{2212}3.21"),
            (0.0, 3, "0"),
            (f64::INFINITY, 2, "∞"),
            (f64::NAN, 2, "not a number"),
            (5e-324, 1, "5·10⁻³²⁴"),
            (4.6e278, 2, "4.6·10²⁷⁸"),
        ] {
            assert_eq!(digits(value, count), text);
        }
        assert_eq!(per_cent(0.01234, 3), "1.23\u{a0}%");
        assert_eq!(
            [0.003, 0.1, 0.05, 1.0].map(level).join(" "),
            "0.3\u{a0}% 10\u{a0}% 5\u{a0}% 100\u{a0}%"
        );
        assert_eq!(slope(-0.5049), "\u{2212}0.50");
    }

    #[test]
    fn times_are_in_the_unit_of_speech() {
        for (seconds, text) in [
            (0.0034, "0.0034 s"),
            (99.7, "100 s"),
            (119.0, "119 s"),
            (120.0, "2.0 min"),
            (7199.0, "120 min"),
            (7200.0, "2.0 h"),
            (5.0 * 86400.0, "5.0 d"),
            (1e14, "1.16·10⁹ d"),
        ] {
            assert_eq!(duration(seconds).replace('\u{a0}', " "), text);
        }
    }

    #[test]
    fn long_names_are_cut() {
        assert_eq!(shortened("metropolis", 10), "metropolis");
        assert_eq!(shortened("metropolis-x", 10), "metropoli…");
        assert_eq!(shortened("光子写像法光子", 8), "光子写…");
    }
}
