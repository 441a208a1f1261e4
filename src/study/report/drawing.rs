//! A drawing as SVG, for the page or for paper.

use super::{
    palette::{Ink, Medium, dashes, marker},
    words::escape,
};

/// Where a text begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing that grows element by element. Units are pixels of the page.
pub(super) struct Drawing {
    medium: Medium,
    size: [f64; 2],
    body: String,
}

impl Drawing {
    /// An empty one of the given width and height.
    pub(super) fn new(medium: Medium, size: [f64; 2]) -> Self {
        let body = String::new();
        Self { medium, size, body }
    }

    /// Where it will be looked at.
    pub(super) fn medium(&self) -> Medium {
        self.medium
    }

    /// A line from one point to another.
    pub(super) fn line(&mut self, ends: [[f64; 2]; 2], ink: Ink, dashes: &str) {
        let [[x1, y1], [x2, y2]] = ends.map(|end| end.map(pixels));
        let colour = self.medium.colour(ink);
        let dashes = dash_attribute(dashes);
        self.body += &format!(
            "<path d=\"M{x1} {y1}L{x2} {y2}\" stroke=\"{colour}\" stroke-width=\"1\"{dashes}/>\n"
        );
    }

    /// A curve through points, in the look of its number.
    pub(super) fn curve(&mut self, points: &[[f64; 2]], number: usize, dashed: &str) {
        if points.len() < 2 {
            return;
        }
        let places = points.iter().map(|p| p.map(pixels).join(" "));
        let path = places.collect::<Vec<_>>().join("L");
        let colour = self.medium.colour(Ink::Curve(number));
        let dashed = match dashed {
            "" => dashes(number),
            own => own,
        };
        let dashes = dash_attribute(dashed);
        self.body += &format!(
            "<path class=\"mean\" d=\"M{path}\" fill=\"none\" stroke=\"{colour}\" \
             stroke-width=\"1.6\" stroke-linejoin=\"round\"{dashes}/>\n"
        );
    }

    /// The marker of curve `number` about a point. What it says shows when a
    /// pointer rests on it; without words it belongs to a name.
    pub(super) fn dot(&mut self, at: [f64; 2], number: usize, says: Option<&str>, hollow: bool) {
        let [x, y] = at.map(pixels);
        let (shape, colour) = (marker(number), self.medium.colour(Ink::Curve(number)));
        let paint = if hollow {
            format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.3\"")
        } else {
            format!("fill=\"{colour}\"")
        };
        self.body += &match says {
            Some(words) => format!(
                "<path class=\"dot\" transform=\"translate({x} {y})\" d=\"{shape}\" {paint}>\
                 <title>{}</title></path>\n",
                escape(words)
            ),
            None => format!("<path transform=\"translate({x} {y})\" d=\"{shape}\" {paint}/>\n"),
        };
    }

    /// Words at a point of their base line.
    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, ink: Ink, words: &str) {
        let [x, y] = at.map(pixels);
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let colour = self.medium.colour(ink);
        let words = escape(words);
        self.body +=
            &format!("<text x=\"{x}\" y=\"{y}\"{anchor} fill=\"{colour}\">{words}</text>\n");
    }

    /// Words along a vertical axis, read from below.
    pub(super) fn upright(&mut self, at: [f64; 2], ink: Ink, words: &str) {
        let [x, y] = at.map(pixels);
        let (colour, words) = (self.medium.colour(ink), escape(words));
        self.body += &format!(
            "<text transform=\"translate({x} {y}) rotate(-90)\" text-anchor=\"middle\" \
             fill=\"{colour}\">{words}</text>\n"
        );
    }

    /// What `draw` adds becomes a group of class `class`; of series `series`,
    /// which the page can hide.
    pub(super) fn group(&mut self, class: &str, series: usize, draw: impl FnOnce(&mut Self)) {
        self.body += &format!("<g class=\"{class}\" data-s=\"{series}\">\n");
        draw(self);
        self.body += "</g>\n";
    }

    /// The whole as SVG, with its title and a description for those who do not
    /// see it.
    pub(super) fn finish(self, class: &str, title: &str, description: &str) -> String {
        let [width, height] = self.size.map(pixels);
        let (title, description) = (escape(title), escape(description));
        let body = self.body;
        match self.medium {
            Medium::Page => format!(
                "<svg class=\"{class}\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
                 height=\"{height}\" role=\"img\" aria-label=\"{title}. {description}\">\n{body}</svg>\n"
            ),
            Medium::Paper => format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
                 width=\"{width}\" height=\"{height}\" font-family=\"Helvetica, Arial, sans-serif\" \
                 font-size=\"12\">\n<title>{title}</title>\n<desc>{description}</desc>\n\
                 <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
            ),
        }
    }
}

/// A small picture of the marker and line of curve `number`, for a legend.
pub(super) fn key(number: usize) -> String {
    let mut drawing = Drawing::new(Medium::Page, [26.0, 12.0]);
    drawing.curve(&[[1.0, 6.0], [25.0, 6.0]], number, "");
    drawing.dot([13.0, 6.0], number, None, false);
    let body = drawing.body;
    format!(
        "<svg class=\"key\" viewBox=\"0 0 26 12\" width=\"26\" height=\"12\" aria-hidden=\"true\">{body}</svg>"
    )
}

fn dash_attribute(dashes: &str) -> String {
    match dashes {
        "" => String::new(),
        some => format!(" stroke-dasharray=\"{some}\""),
    }
}

/// A length with two decimals, without trailing zeros.
fn pixels(length: f64) -> String {
    let text = format!("{length:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".to_owned(),
        _ => text.to_owned(),
    }
}
