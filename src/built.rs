//! Which effects this build of the program has: all of them, unless it was
//! built to show what an effect costs where no scene calls for it.
//!
//! `NEPHROID_WITHOUT=mirrors,panes cargo build` makes a program without these
//! effects: what asks for one of the constants below is then removed when
//! compiling, with all that lies behind it. Objects that need such an effect
//! absorb, its light is missing, and `nephroid plan` says so. `benches/effects`
//! sets such builds beside the whole program.

/// The effects left out, by their names in scene files, with commas between.
const WITHOUT: &str = match option_env!("NEPHROID_WITHOUT") {
    Some(names) => names,
    None => "",
};

pub(crate) const SOURCES: bool = has("sources");
pub(crate) const HARD_SHADOWS: bool = has("hard_shadows");
pub(crate) const SOFT_SHADOWS: bool = has("soft_shadows");
pub(crate) const CAUSTICS: bool = has("caustics");
pub(crate) const INDIRECT: bool = has("indirect");
pub(crate) const MIRRORS: bool = has("mirrors");
pub(crate) const REFRACTION: bool = has("refraction");
pub(crate) const TOTAL_REFLECTION: bool = has("total_reflection");
pub(crate) const PANES: bool = has("panes");
pub(crate) const NESTING: bool = has("nesting");
pub(crate) const SHADING_NORMALS: bool = has("shading_normals");
pub(crate) const GLINTS: bool = has("glints");

/// Whether the effect of a name is part of this build.
pub(crate) const fn has(name: &str) -> bool {
    let (all, name) = (WITHOUT.as_bytes(), name.as_bytes());
    let mut start = 0;
    while start < all.len() {
        let mut end = start;
        while end < all.len() && all[end] != b',' {
            end += 1;
        }
        if is_same(all, start, end, name) {
            return false;
        }
        start = end + 1;
    }
    true
}

/// Whether `all[start..end]` is `name`; slices do not compare when compiling.
const fn is_same(all: &[u8], start: usize, end: usize, name: &[u8]) -> bool {
    let mut i = 0;
    while i < name.len() && start + i < end && all[start + i] == name[i] {
        i += 1;
    }
    i == name.len() && start + i == end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Effect;

    /// A build of the tests leaves out just what it was told to.
    #[test]
    fn effects_are_left_out_by_name() {
        let without: Vec<&str> = WITHOUT.split(',').collect();
        for effect in Effect::ALL {
            assert_eq!(has(effect.name()), !without.contains(&effect.name()));
        }
        assert!(is_same(b"a,bc", 2, 4, b"bc") && !is_same(b"a,bc", 2, 4, b"b"));
        assert!(!is_same(b"a,bc", 2, 3, b"bc"));
    }
}
