//! How errors and sweeps are written.

use std::str::FromStr;

use nephroid::{
    scene::{Kernel, Sampler},
    study::Sweep,
};

/// An error such as `3%` or `0.03`, as a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Percent(pub(crate) f64);

/// An error: per cent with the sign, else a part of one.
pub(crate) fn percent(text: &str) -> Result<Percent, String> {
    let expected = || "expected an error above zero such as 3% or 0.03".to_owned();
    let text = text.trim();
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number.trim(), 100.0),
        None => (text, 1.0),
    };
    let value = number.parse::<f64>().map_err(|_| expected())? / scale;
    if value > 0.0 && value.is_finite() {
        Ok(Percent(value))
    } else {
        Err(expected())
    }
}

/// A setting and its values, such as `radius=1,2,4`.
pub(crate) fn sweep(text: &str) -> Result<Sweep, String> {
    let (name, values) = text
        .split_once('=')
        .ok_or("expected a setting and its values such as radius=1,2,4")?;
    match name.trim() {
        "photons" => list(values, whole).map(Sweep::Photons),
        "radius" => list(values, number).map(Sweep::Radius),
        "max_depth" | "depth" => list(values, whole).map(Sweep::MaxDepth),
        "indirect" => list(values, truth).map(Sweep::Indirect),
        "sampler" => list(values, sampler).map(Sweep::Sampler),
        "kernel" => list(values, kernel).map(Sweep::Kernel),
        "passes" => Err("every curve goes over passes; --passes says how many".to_owned()),
        _ => Err(
            "no such setting; use photons, radius, sampler, kernel, max_depth or indirect"
                .to_owned(),
        ),
    }
}

fn list<T>(values: &str, read: fn(&str) -> Result<T, &'static str>) -> Result<Vec<T>, String> {
    let values = values.split(',').map(str::trim);
    let each = values.map(|text| read(text).map_err(|e| format!("expected {e}, found '{text}'")));
    each.collect()
}

fn whole<T: FromStr>(text: &str) -> Result<T, &'static str> {
    text.parse().map_err(|_| "a whole number")
}

fn number(text: &str) -> Result<f64, &'static str> {
    text.parse().map_err(|_| "a number")
}

fn truth(text: &str) -> Result<bool, &'static str> {
    text.parse().map_err(|_| "true or false")
}

fn sampler(text: &str) -> Result<Sampler, &'static str> {
    match text {
        "Sobol" => Ok(Sampler::Sobol),
        "Independent" => Ok(Sampler::Independent),
        _ => Err("Sobol or Independent"),
    }
}

fn kernel(text: &str) -> Result<Kernel, &'static str> {
    match text {
        "Footprint" => Ok(Kernel::Footprint),
        "Circle" => Ok(Kernel::Circle),
        _ => Err("Footprint or Circle"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors() {
        assert_eq!(percent("3%"), Ok(Percent(0.03)));
        assert_eq!(percent(" 0.3 % "), Ok(Percent(0.003)));
        assert_eq!(percent("0.05"), Ok(Percent(0.05)));
        for text in ["", "%", "0", "-1%", "nan", "inf", "3%%", "three"] {
            assert!(percent(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sweeps() {
        assert_eq!(sweep("radius=1, 2.5"), Ok(Sweep::Radius(vec![1.0, 2.5])));
        assert_eq!(sweep("depth=4"), Ok(Sweep::MaxDepth(vec![4])));
        assert_eq!(sweep("indirect=false"), Ok(Sweep::Indirect(vec![false])));
        let circles = Sweep::Kernel(vec![Kernel::Footprint, Kernel::Circle]);
        assert_eq!(sweep("kernel=Footprint,Circle"), Ok(circles));
        let random = Sweep::Sampler(vec![Sampler::Independent]);
        assert_eq!(sweep("sampler=Independent"), Ok(random));
        assert_eq!(sweep("photons=1000"), Ok(Sweep::Photons(vec![1000])));
        for text in [
            "radius",
            "radius=",
            "radius=x",
            "photons=1.5",
            "passes=1",
            "sampler=x",
        ] {
            assert!(sweep(text).is_err(), "{text}");
        }
    }
}
