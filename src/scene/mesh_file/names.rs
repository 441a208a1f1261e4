//! What a file calls its triangles: materials, groups, nodes.

use std::collections::{BTreeSet, HashMap};

/// Names at three levels, the most telling first: as numbers of statements.
type Label = [Option<u32>; 3];

/// What a file calls its triangles. Of an OBJ file: material, groups, object;
/// of a glTF file: material, node, mesh; of an STL file: the solid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// The names that each distinct statement gives, one or several.
    statements: Vec<Vec<String>>,
    labels: Vec<Label>,
    /// Where a run of triangles ends, and its label.
    runs: Vec<(usize, u32)>,
}

impl Names {
    /// All names, in alphabetical order.
    pub fn all(&self) -> BTreeSet<&str> {
        self.statements
            .iter()
            .flatten()
            .map(String::as_str)
            .collect()
    }

    /// For each run of triangles its end and which of `keys` it goes by: the
    /// first key that matches at the most telling level.
    pub(in crate::scene) fn runs_by(&self, keys: &[&str]) -> Vec<(usize, Option<usize>)> {
        let by_name: HashMap<&str, usize> = keys.iter().copied().zip(0..).collect();
        let of_statement: Vec<Option<usize>> = self
            .statements
            .iter()
            .map(|names| names.iter().find_map(|n| by_name.get(n.as_str()).copied()))
            .collect();
        let key = |label: u32| {
            let levels = self.labels[label as usize].iter().flatten();
            levels.copied().find_map(|s| of_statement[s as usize])
        };
        self.runs
            .iter()
            .map(|&(end, label)| (end, key(label)))
            .collect()
    }
}

/// Collects names while a file is read.
#[derive(Default)]
pub(super) struct Namer {
    names: Names,
    statements: HashMap<Vec<String>, u32>,
    labels: HashMap<Label, u32>,
    current: Label,
}

impl Namer {
    /// The names at a level from here on; none clears them.
    pub(super) fn say(&mut self, level: usize, names: Vec<String>) {
        if names.is_empty() {
            self.current[level] = None;
            return;
        }
        let next = self.names.statements.len() as u32;
        let number = *self.statements.entry(names).or_insert_with_key(|names| {
            self.names.statements.push(names.clone());
            next
        });
        self.current[level] = Some(number);
    }

    /// All triangles up to `end` that have no label yet get the current one.
    pub(super) fn mark(&mut self, end: usize) {
        let next = self.names.labels.len() as u32;
        let label = *self.labels.entry(self.current).or_insert_with_key(|label| {
            self.names.labels.push(*label);
            next
        });
        match self.names.runs.last_mut() {
            Some((last, same)) if *same == label => *last = end,
            Some((last, _)) if *last == end => {}
            None if end == 0 => {}
            _ => self.names.runs.push((end, label)),
        }
    }

    /// What was collected; nothing if the file has no names.
    pub(super) fn finish(self) -> Names {
        if self.names.labels.iter().all(|l| *l == Label::default()) {
            return Names::default();
        }
        self.names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(names: &[&str]) -> Vec<String> {
        names.iter().map(|n| (*n).to_owned()).collect()
    }

    #[test]
    fn the_most_telling_name_decides() {
        let mut namer = Namer::default();
        namer.mark(2);
        namer.say(1, texts(&["left", "wall"]));
        namer.mark(3);
        namer.say(0, texts(&["glass"]));
        namer.mark(5);
        namer.mark(6);
        namer.say(1, vec![]);
        namer.mark(6);
        namer.say(0, vec![]);
        namer.mark(7);
        let names = namer.finish();
        assert_eq!(
            names.all().into_iter().collect::<Vec<_>>(),
            ["glass", "left", "wall"]
        );
        let runs = |keys: &[&str]| names.runs_by(keys);
        assert_eq!(
            runs(&["wall", "glass"]),
            [(2, None), (3, Some(0)), (6, Some(1)), (7, None)]
        );
        // Without the material, the group decides; of two groups the first.
        assert_eq!(
            runs(&["wall", "left"]),
            [(2, None), (3, Some(1)), (6, Some(1)), (7, None)]
        );
    }

    #[test]
    fn no_names_no_runs() {
        let mut namer = Namer::default();
        namer.mark(4);
        assert_eq!(namer.finish(), Names::default());
    }
}
