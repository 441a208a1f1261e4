//! Builds the binary tree: parallel locally-ordered clustering (D. Meister, J.
//! Bittner, TVCG 24(3), 2018) by the crate, then reinsertion (the same,
//! *Parallel Reinsertion for Bounding Volume Hierarchy Optimization*, Computer
//! Graphics Forum 37(2), 2018) with its steps.
//!
//! The crate clusters with all threads, and its results do not depend on them:
//! costs are worked out for each box alone, and rayon's unstable sort cuts its
//! list in ways that the list alone decides. Its reinsertion in parallel is
//! another matter: it sorts by areas with a radix sort that chooses its way by
//! the number of threads, so that among nodes of equal area any may come first.
//! Here all threads search where a node had better be, equal ones are in the
//! order of their numbers, and nodes are moved one after the other.

use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{
        Bvh2,
        leaf_collapser::collapse,
        node::Bvh2Node,
        reinsertion::{Reinsertion, find_reinsertion, reinsert_node},
    },
    ploc::PlocBuilder,
};
use rayon::prelude::*;

/// So many shares of the nodes are inserted anew, one after the other: the
/// whole share, a third, a fifth of it and so on, ever nearer to the root.
const ROUNDS: usize = 16;
/// Nodes for which one thread searches at a time.
const CHUNK: usize = 256;

/// The binary tree over some boxes.
pub(super) fn build(boxes: &[Aabb], params: BvhBuildParams) -> Bvh2 {
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        params.ploc_search_distance,
        boxes,
        (0..boxes.len() as u32).collect(),
        params.sort_precision,
        params.search_depth_threshold,
    );
    let share = params.reinsertion_batch_ratio;
    reinsert(&mut tree, share);
    collapse(
        &mut tree,
        params.max_prims_per_leaf,
        params.collapse_traversal_cost,
    );
    reinsert(
        &mut tree,
        share * params.post_collapse_reinsertion_batch_ratio_multiplier,
    );
    tree
}

/// Moves nodes of large area, a share of all, to where they make the tree
/// smaller.
fn reinsert(tree: &mut Bvh2, share: f32) {
    if tree.nodes.is_empty() || tree.nodes[0].is_leaf() {
        return;
    }
    tree.init_parents_if_uninit();
    tree.children_are_ordered_after_parents = false;
    let count = tree.nodes.len();
    let mut touched = vec![false; count];
    for round in 0..ROUNDS {
        let most = ((count as f32 * share) as usize / (2 * round + 1)).max(1);
        let most = most.min(count - 1);
        let moves = moves(tree, &candidates(tree, most));
        touched.fill(false);
        for Reinsertion { from, to, .. } in moves {
            // Not next to what has moved in this round: what was found there
            // holds no more.
            let near = [
                to as usize,
                from as usize,
                Bvh2Node::get_sibling_id(from as usize),
                tree.parents[to as usize] as usize,
                tree.parents[from as usize] as usize,
            ];
            if near.iter().all(|&node| !touched[node]) {
                for node in near {
                    touched[node] = true;
                }
                reinsert_node(tree, from as usize, to as usize);
            }
        }
    }
}

/// The nodes of the largest area among twice as many at the front, where those
/// near the root are.
fn candidates(tree: &Bvh2, most: usize) -> Vec<u32> {
    let front = tree.nodes.len().min(2 * (most + 1));
    let mut list: Vec<(f32, u32)> = (1..front)
        .map(|i| (tree.nodes[i].aabb().half_area(), i as u32))
        .collect();
    let larger_first = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    if most < list.len() {
        list.select_nth_unstable_by(most, larger_first);
        list.truncate(most);
    }
    list.into_iter().map(|(_, node)| node).collect()
}

/// Where nodes had better be, those first that save the most.
fn moves(tree: &Bvh2, nodes: &[u32]) -> Vec<Reinsertion> {
    let mut found: Vec<Reinsertion> = nodes
        .par_chunks(CHUNK)
        .flat_map_iter(|chunk| {
            chunk
                .iter()
                .map(|&node| find_reinsertion(tree, node as usize))
                .filter(|found| found.area_diff > 0.0)
        })
        .collect();
    found.par_sort_unstable_by(|a, b| {
        b.area_diff
            .total_cmp(&a.area_diff)
            .then(a.from.cmp(&b.from))
    });
    found
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;

    /// Boxes of many sizes, most of them crowded, many exactly equal.
    fn boxes(count: u32) -> Vec<Aabb> {
        (0..count)
            .map(|i| {
                let x = f64::from(i / 3);
                let place = [0.618, 0.414, 0.732].map(|k| (x * k).fract() as f32);
                let low = Vec3A::from_array(place).powf(1.0 + 4.0 * place[0]);
                Aabb::new(low, low + Vec3A::splat(1e-3 * place[1]))
            })
            .collect()
    }

    fn bits(tree: &Bvh2) -> Vec<[u32; 8]> {
        let bits = |node: &Bvh2Node| {
            let [a, b, c] = node.aabb().min.to_array().map(f32::to_bits);
            let [d, e, f] = node.aabb().max.to_array().map(f32::to_bits);
            [a, b, c, d, e, f, node.prim_count, node.first_index]
        };
        tree.nodes.iter().map(bits).collect()
    }

    /// Any number of threads makes the same tree, and it is one: every box is
    /// in one leaf and within all boxes above it.
    #[test]
    fn any_number_of_threads_makes_the_same_tree() {
        let params = BvhBuildParams {
            max_prims_per_leaf: 4,
            ..BvhBuildParams::medium_build()
        };
        let boxes = boxes(30_017);
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| build(&boxes, params))
        };
        let (one, five) = (by(1), by(5));
        assert!(bits(&one) == bits(&five), "the trees differ");
        assert!(one.primitive_indices == five.primitive_indices);
        let mut seen = vec![0u8; boxes.len()];
        let mut todo = vec![(0usize, Aabb::LARGEST)];
        while let Some((at, above)) = todo.pop() {
            let node = &one.nodes[at];
            let around = *node.aabb();
            assert!(above.intersection(&around) == around, "a node sticks out");
            let first = node.first_index as usize;
            if node.is_leaf() {
                for i in &one.primitive_indices[first..first + node.prim_count as usize] {
                    seen[*i as usize] += 1;
                    let own = boxes[*i as usize];
                    assert!(around.intersection(&own) == own, "a box sticks out");
                }
            } else {
                todo.extend([(first, around), (first + 1, around)]);
            }
        }
        assert!(seen.iter().all(|&n| n == 1), "each box once");
    }

    /// Nothing tells the boxes apart: all areas tie.
    #[test]
    fn equal_boxes_make_a_tree() {
        let one = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        let tree = build(&vec![one; 5000], BvhBuildParams::medium_build());
        assert_eq!(tree.primitive_indices.len(), 5000);
    }
}
