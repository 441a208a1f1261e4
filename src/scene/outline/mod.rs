//! Where every value of a RON text stands.
//!
//! A deserializer forgets places as soon as it has a value; messages about
//! the meaning of a scene need them later. The outline keeps, for every
//! value, the bytes it covers, its key and its neighbours, and nothing of its
//! content. It accepts whatever is well-formed, types right or wrong; what
//! isn't well-formed is reported as a [`SyntaxError`].

mod scan;

use std::ops::Range;

pub use scan::SyntaxError;

/// Most values in one scene file. Larger meshes belong into mesh files.
pub const MAX_VALUES: usize = 4_000_000;
/// Deepest nesting of brackets.
pub const MAX_DEPTH: usize = 64;

/// Index of a value in its [`Outline`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId(u32);

/// What a value looks like from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `1.5`, `-3`, `+inf`.
    Number,
    /// `"text"`, raw or not.
    Text,
    /// `'c'`.
    Char,
    /// A bare name: `true`, `Box`, `None`.
    Name,
    /// `(1, 2)` or `Name(1, 2)` or `()`.
    Tuple,
    /// `(a: 1)` or `Name(a: 1)`.
    Struct,
    /// `[1, 2]`.
    List,
    /// `{"a": 1}`.
    Map,
}

impl Kind {
    /// The kind in words, with its article.
    pub fn words(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Text => "a text",
            Self::Char => "a character",
            Self::Name => "a name",
            Self::Tuple => "a tuple `(...)`",
            Self::Struct => "fields `(name: ...)`",
            Self::List => "a list `[...]`",
            Self::Map => "a map `{...}`",
        }
    }

    fn is_composite(self) -> bool {
        matches!(self, Self::Tuple | Self::Struct | Self::List | Self::Map)
    }
}

const NONE: u32 = u32::MAX;

/// One value. Offsets are `u32`: scene files are limited to 64 MiB.
#[derive(Clone, Debug)]
struct Node {
    start: u32,
    end: u32,
    /// End of the name in front of a bracket, or the start if there is none.
    name_end: u32,
    key_start: u32,
    key_end: u32,
    parent: u32,
    first_child: u32,
    last_child: u32,
    next: u32,
    /// Position among the parent's children.
    index: u32,
    kind: Kind,
}

/// The places of all values of a text.
#[derive(Clone, Debug)]
pub struct Outline {
    nodes: Vec<Node>,
    /// Extensions named in `#![enable(...)]` headers.
    extensions: Vec<Range<usize>>,
}

impl Outline {
    /// Outlines a text of at most 4 GiB.
    ///
    /// # Errors
    /// The first place at which the text stops being well-formed.
    pub fn scan(text: &str) -> Result<Self, SyntaxError> {
        scan::Scanner::new(text).run()
    }

    /// The outermost value.
    pub fn root(&self) -> NodeId {
        NodeId(0)
    }

    /// Names of the extensions that the text's header enables.
    pub fn extensions(&self) -> &[Range<usize>] {
        &self.extensions
    }

    /// The bytes a value covers, without its key.
    pub fn span(&self, id: NodeId) -> Range<usize> {
        let node = self.node(id);
        node.start as usize..node.end as usize
    }

    /// The name in front of a value's bracket, or the value itself if it is a
    /// bare name.
    pub fn name(&self, id: NodeId) -> Option<Range<usize>> {
        let node = self.node(id);
        let end = if node.kind == Kind::Name {
            node.end
        } else {
            node.name_end
        };
        (end > node.start).then_some(node.start as usize..end as usize)
    }

    /// The beginning of a value: its name, or its bracket, or all of it.
    pub fn head(&self, id: NodeId) -> Range<usize> {
        let span = self.span(id);
        match self.name(id) {
            Some(name) => name,
            None if self.kind(id).is_composite() => span.start..span.start + 1,
            None => span,
        }
    }

    /// The key in front of a field or map entry, quotes included.
    pub fn key(&self, id: NodeId) -> Option<Range<usize>> {
        let node = self.node(id);
        (node.key_end > node.key_start).then_some(node.key_start as usize..node.key_end as usize)
    }

    /// What the value looks like.
    pub fn kind(&self, id: NodeId) -> Kind {
        self.node(id).kind
    }

    /// The value around a value.
    pub fn parent(&self, id: NodeId) -> Option<NodeId> {
        let parent = self.node(id).parent;
        (parent != NONE).then_some(NodeId(parent))
    }

    /// The values inside a value, in order.
    pub fn children(&self, id: NodeId) -> impl Iterator<Item = NodeId> + '_ {
        let link = |index: u32| (index != NONE).then_some(NodeId(index));
        std::iter::successors(link(self.node(id).first_child), move |&child| {
            link(self.node(child).next)
        })
    }

    /// The field or map entry with the given key, the last one if there are
    /// several; keys of maps are compared without their quotes.
    pub fn field(&self, text: &str, id: NodeId, key: &str) -> Option<NodeId> {
        self.children(id)
            .filter(|&child| self.key_text(text, child) == Some(key))
            .last()
    }

    /// A child's key without quotes.
    pub fn key_text<'t>(&self, text: &'t str, id: NodeId) -> Option<&'t str> {
        let key = &text[self.key(id)?];
        let raw = key.strip_prefix("r#").filter(|_| !key.ends_with('#'));
        Some(raw.unwrap_or_else(|| key.trim_matches('"')))
    }

    /// The element with the given index.
    pub fn item(&self, id: NodeId, index: usize) -> Option<NodeId> {
        self.children(id).nth(index)
    }

    /// How a value is reached from the outermost one:
    /// `objects[2].shape.radius`.
    pub fn path(&self, text: &str, id: NodeId) -> String {
        let mut chain = vec![];
        let mut at = id;
        while self.node(at).parent != NONE {
            chain.push(at);
            at = NodeId(self.node(at).parent);
        }
        let mut path = String::new();
        for &child in chain.iter().rev() {
            let parent = NodeId(self.node(child).parent);
            match self.key_text(text, child) {
                Some(key) if self.kind(parent) == Kind::Map => path.extend(["[\"", key, "\"]"]),
                Some(key) if path.is_empty() => path.push_str(key),
                Some(key) => path.extend([".", key]),
                None => path.extend(["[", &self.node(child).index.to_string(), "]"]),
            }
        }
        path
    }

    fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(text: &str) -> Outline {
        Outline::scan(text).unwrap_or_else(|e| panic!("{text:?}: {e:?}"))
    }

    #[test]
    fn every_value_is_found_by_its_path() {
        let text = r##"#![enable(implicit_some)] // header
            Scene( /* nested /* comment */ */
                objects: [ (shape: Sphere(radius: -1.5e3, center: (0, 1, 2))), ],
                materials: { "a \" b": r#"raw " text"#, "c": 'x', },
                flag: true, empty: (), r#type: '\'',
            )"##;
        let o = outline(text);
        let get = |path: &[&str]| {
            path.iter().fold(o.root(), |at, key| match key.parse() {
                Ok(index) => o.item(at, index).unwrap(),
                Err(_) => o.field(text, at, key).unwrap(),
            })
        };
        let radius = get(&["objects", "0", "shape", "radius"]);
        assert_eq!(&text[o.span(radius)], "-1.5e3");
        assert_eq!(o.path(text, radius), "objects[0].shape.radius");
        let center = get(&["objects", "0", "shape", "center"]);
        assert_eq!(
            (&text[o.span(center)], o.kind(center)),
            ("(0, 1, 2)", Kind::Tuple)
        );
        assert_eq!(
            &text[o.name(get(&["objects", "0", "shape"])).unwrap()],
            "Sphere"
        );
        assert_eq!(
            &text[o.span(get(&["materials", "0"]))],
            r##"r#"raw " text"#"##
        );
        assert_eq!(&text[o.span(get(&["materials", "c"]))], "'x'");
        assert_eq!(o.path(text, get(&["materials", "c"])), "materials[\"c\"]");
        assert_eq!(o.kind(get(&["flag"])), Kind::Name);
        assert_eq!(o.kind(get(&["empty"])), Kind::Tuple);
        assert_eq!(&text[o.span(get(&["type"]))], "'\\''");
        assert_eq!(&text[o.extensions()[0].clone()], "implicit_some");
    }

    #[test]
    fn wrong_types_are_outlined_all_the_same() {
        let text = "(camera: [1, {}], objects: 3, image: Foo)";
        let o = outline(text);
        assert_eq!(o.children(o.root()).count(), 3);
    }

    #[test]
    fn malformed_texts_are_reported_where_they_break() {
        for (text, start, part) in [
            ("", 0, "empty"),
            ("(a: 1", 0, "never closed"),
            ("(a: 1]", 5, "`]`"),
            ("(a: 1 b: 2)", 6, "`,`"),
            ("(a: )", 4, "value"),
            ("(a: 1, 2)", 7, "field"),
            ("(1, a: 2)", 4, "field"),
            ("[1, 2] 3", 7, "after"),
            ("(a: \"x)", 4, "text"),
            ("(a: 'xy)", 4, "character"),
            ("/* (a: 1)", 0, "comment"),
            ("{1 2}", 3, "`:`"),
            ("{[1]: 2}", 1, "key"),
            ("(a: @)", 4, "`@`"),
        ] {
            let error = Outline::scan(text).expect_err(text);
            assert_eq!(error.span.start, start, "{text:?}: {error:?}");
            assert!(
                error.message.contains(part) || error.label.contains(part),
                "{text:?}: {error:?}"
            );
        }
    }

    #[test]
    fn depth_is_limited() {
        let deep = |n: usize| format!("{}{}", "[".repeat(n), "]".repeat(n));
        assert!(Outline::scan(&deep(MAX_DEPTH)).is_ok());
        let error = Outline::scan(&deep(100_000)).expect_err("too deep");
        assert_eq!(error.span.start, MAX_DEPTH);
    }
}
