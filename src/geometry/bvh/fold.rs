//! From a binary tree to wide nodes.

use obvhs::bvh2::Bvh2;

use super::node::{COUNT_SHIFT, LEAF, Node, WIDTH};

/// Folds a binary tree into wide nodes, parents first, and lists the
/// primitives in the order in which their leaves are met.
pub(super) fn fold(binary: &Bvh2) -> (Vec<Node>, Vec<u32>) {
    let mut nodes = vec![Node::EMPTY];
    let mut order = Vec::with_capacity(binary.primitive_indices.len());
    let mut todo = vec![(0u32, 0usize)];
    while let Some((from, to)) = todo.pop() {
        for (lane, &child) in open(binary, from).iter().enumerate() {
            let source = &binary.nodes[child as usize];
            let reference = if source.is_leaf() {
                let first = order.len() as u32;
                let slots = source.first_index..source.first_index + source.prim_count;
                order.extend(slots.map(|i| binary.primitive_indices[i as usize]));
                LEAF | (source.prim_count - 1) << COUNT_SHIFT | first
            } else {
                nodes.push(Node::EMPTY);
                todo.push((child, nodes.len() - 1));
                (nodes.len() - 1) as u32
            };
            nodes[to].set(lane, source.aabb(), reference);
        }
    }
    (nodes, order)
}

/// The descendants of a binary node that become the children of a wide one:
/// the largest inner one is opened until there are enough.
pub(super) fn open(binary: &Bvh2, node: u32) -> Vec<u32> {
    let mut children = vec![node];
    while children.len() < WIDTH {
        let area = |&i: &u32| binary.nodes[i as usize].aabb().half_area();
        let largest = (0..children.len())
            .filter(|&i| !binary.nodes[children[i] as usize].is_leaf())
            .max_by(|&i, &j| area(&children[i]).total_cmp(&area(&children[j])));
        let Some(i) = largest else { break };
        let first = binary.nodes[children[i] as usize].first_index;
        children[i] = first;
        children.push(first + 1);
    }
    children
}

/// The most entries on the stack at once: a node replaces its own entry by
/// one for each child. Children come after their parents.
pub(super) fn stack_need(nodes: &[Node]) -> usize {
    let mut need = vec![0usize; nodes.len()];
    for (i, node) in nodes.iter().enumerate().rev() {
        let (mut count, mut below) = (0, 0);
        for child in node.used() {
            count += 1;
            if child & LEAF == 0 {
                below = below.max(need[child as usize]);
            }
        }
        need[i] = count + below;
    }
    need[0]
}
