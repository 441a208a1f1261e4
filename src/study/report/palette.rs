//! Colours and markers.
//!
//! Curves are told apart by colour, by marker, and by their names at the line's
//! end: none of them is needed alone. The page has a light and a dark set, kept
//! in variables of its style sheet; paper has the light one written out.

use crate::{film::srgb_byte, metrics::magma};

/// Where a drawing will be looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Medium {
    /// In the page, whose style sheet has the colours.
    Page,
    /// In a file of its own: white ground, nothing from outside.
    Paper,
}

/// What a colour is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ink {
    /// Letters.
    Text,
    /// Letters of less weight.
    Quiet,
    /// Axes and leaders.
    Rule,
    /// Lines in the background.
    Grid,
    /// A curve, by its number.
    Curve(usize),
}

/// A set of colours.
pub(super) struct Theme {
    ground: &'static str,
    panel: &'static str,
    text: &'static str,
    quiet: &'static str,
    rule: &'static str,
    grid: &'static str,
    accent: &'static str,
    curves: [&'static str; COLOURS],
}

/// Colours of curves.
pub(super) const COLOURS: usize = 8;

/// The light set.
pub(super) const LIGHT: Theme = Theme {
    ground: "#ffffff",
    panel: "#f5f5f2",
    text: "#1b1d22",
    quiet: "#5b5f68",
    rule: "#7d828c",
    grid: "#e4e4e0",
    accent: "#0b5cad",
    curves: [
        "#0b62b0", "#d95a00", "#0e8f6e", "#9a3d8f", "#6b4f00", "#2f90cc", "#44464d", "#e0638f",
    ],
};

/// The dark set.
pub(super) const DARK: Theme = Theme {
    ground: "#14161b",
    panel: "#1e2128",
    text: "#e9e9e4",
    quiet: "#a9adb6",
    rule: "#7f858f",
    grid: "#2d313a",
    accent: "#7db8f5",
    curves: [
        "#4f9ff0", "#ff8a45", "#2fb98f", "#d184cc", "#f0dd85", "#9bd6fb", "#c9cbd1", "#ff9fc0",
    ],
};

/// Markers about the origin, each about 7 units wide. With [`COLOURS`] colours
/// and the turn in [`marker`] the first 64 curves all look different.
const MARKERS: [&str; 8] = [
    "M-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0z",
    "M-2.7-2.7h5.4v5.4h-5.4z",
    "M0-3.8L3.5 2.4h-7z",
    "M0-4L3.2 0L0 4L-3.2 0z",
    "M0 3.8L3.5-2.4h-7z",
    "M-1-3.4h2v2.4h2.4v2h-2.4v2.4h-2v-2.4h-2.4v-2h2.4z",
    "M-3.6-2.2l1.4-1.4L0-1.4l2.2-2.2l1.4 1.4L1.4 0l2.2 2.2l-1.4 1.4L0 1.4l-2.2 2.2l-1.4-1.4L-1.4 0z",
    "M-3.8-1.6h7.6v3.2h-7.6z",
];

/// Dashes of the lines of each further round through the colours.
const DASHES: [&str; 4] = ["", "7 3", "2 3", "9 3 2 3"];

/// The path of the marker of curve `number`.
pub(super) fn marker(number: usize) -> &'static str {
    MARKERS[(number + number / COLOURS) % MARKERS.len()]
}

/// The dashes of the line of curve `number`, empty for none.
pub(super) fn dashes(number: usize) -> &'static str {
    DASHES[number / COLOURS % DASHES.len()]
}

impl Medium {
    /// The colour of `ink` as an attribute has it.
    pub(super) fn colour(self, ink: Ink) -> String {
        let theme = &LIGHT;
        match (self, ink) {
            (Self::Page, Ink::Text) => "var(--text)".to_owned(),
            (Self::Page, Ink::Quiet) => "var(--quiet)".to_owned(),
            (Self::Page, Ink::Rule) => "var(--rule)".to_owned(),
            (Self::Page, Ink::Grid) => "var(--grid)".to_owned(),
            (Self::Page, Ink::Curve(number)) => format!("var(--c{})", number % COLOURS),
            (Self::Paper, Ink::Text) => theme.text.to_owned(),
            (Self::Paper, Ink::Quiet) => theme.quiet.to_owned(),
            (Self::Paper, Ink::Rule) => theme.rule.to_owned(),
            (Self::Paper, Ink::Grid) => theme.grid.to_owned(),
            (Self::Paper, Ink::Curve(number)) => theme.curves[number % COLOURS].to_owned(),
        }
    }
}

impl Theme {
    /// Its colours as declarations of variables.
    fn declarations(&self) -> String {
        let mut css = format!(
            "--ground:{};--panel:{};--text:{};--quiet:{};--rule:{};--grid:{};--accent:{};",
            self.ground, self.panel, self.text, self.quiet, self.rule, self.grid, self.accent
        );
        for (number, colour) in self.curves.iter().enumerate() {
            css += &format!("--c{number}:{colour};");
        }
        css
    }
}

/// Rules that give the page the colours of the system's taste, or of the
/// reader's choice in the attribute `data-theme`; and those of paper in print.
pub(super) fn style_sheet() -> String {
    let (light, dark) = (LIGHT.declarations(), DARK.declarations());
    format!(
        ":root{{color-scheme:light;{light}}}\n\
         @media (prefers-color-scheme:dark){{:root:not([data-theme=light]){{color-scheme:dark;{dark}}}}}\n\
         :root[data-theme=dark]{{color-scheme:dark;{dark}}}\n\
         @media print{{:root:root:root{{color-scheme:light;{light}}}}}\n\
         .scale i{{background:linear-gradient(to right,{})}}\n",
        stops()
    )
}

/// The colours of an error map, from nothing to the most, as a gradient's stops.
fn stops() -> String {
    const STEPS: u32 = 16;
    let stop = |step: u32| {
        let [r, g, b] = magma(f64::from(step) / f64::from(STEPS)).0.map(srgb_byte);
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    (0..=STEPS).map(stop).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::srgb_linear;

    fn linear(colour: &str) -> [f64; 3] {
        [1, 3, 5].map(|at| {
            let code = u8::from_str_radix(&colour[at..at + 2], 16).unwrap();
            srgb_linear(f64::from(code) / 255.0)
        })
    }

    /// Contrast of WCAG 2.2.
    fn contrast(a: &str, b: &str) -> f64 {
        let luminance = |colour: &str| {
            let [r, g, b] = linear(colour);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let [a, b] = [a, b].map(luminance);
        a.max(b) / a.min(b)
    }

    /// Level AA: 4.5 for letters, 3 for what carries meaning without letters.
    #[test]
    fn contrasts_suffice() {
        for theme in [LIGHT, DARK] {
            for ground in [theme.ground, theme.panel] {
                for letters in [theme.text, theme.quiet, theme.accent] {
                    assert!(contrast(letters, ground) >= 4.5, "{letters} on {ground}");
                }
                for shape in theme.curves.into_iter().chain([theme.rule]) {
                    let found = contrast(shape, ground);
                    assert!(found >= 2.99, "{shape} on {ground}: {found}");
                }
            }
        }
    }

    /// Lightness and opponent colours of CIE 1976 L*a*b* as an eye sees them
    /// that lacks the long or the middle cones (F. Viénot, H. Brettel, J. Mollon,
    /// *Digital Video Colourmaps for Checking the Legibility of Displays by
    /// Dichromats*, 1999, its matrices for linear sRGB), or all three.
    fn seen([r, g, b]: [f64; 3], lacks: usize) -> [f64; 3] {
        let [r, g, b] = match lacks {
            1 => [
                0.11238 * r + 0.88762 * g,
                0.11238 * r + 0.88762 * g,
                0.00401 * r - 0.00401 * g + b,
            ],
            2 => [
                0.29275 * r + 0.70725 * g,
                0.29275 * r + 0.70725 * g,
                -0.02234 * r + 0.02234 * g + b,
            ],
            _ => [r, g, b],
        };
        let x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505;
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
        let [x, y, z] = [x, y, z].map(libm::cbrt);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Any two of the first six colours differ by at least twelve units, any two
    /// at all by six, whichever cones are missing. Two units can be told apart
    /// side by side.
    #[test]
    fn colours_differ_for_every_eye() {
        for theme in [LIGHT, DARK] {
            for lacks in 0..3 {
                let labs = theme.curves.map(|c| seen(linear(c), lacks));
                for j in 0..COLOURS {
                    for i in 0..j {
                        let apart: f64 = (0..3).map(|k| (labs[i][k] - labs[j][k]).powi(2)).sum();
                        let least = if j < 6 { 12.0 } else { 6.0 };
                        assert!(
                            apart.sqrt() >= least,
                            "{} and {} without {lacks}: {}",
                            theme.curves[i],
                            theme.curves[j],
                            apart.sqrt()
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn looks_do_not_repeat_early() {
        let looks: Vec<_> = (0..64).map(|n| (n % COLOURS, marker(n))).collect();
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "{i}");
        }
    }
}
