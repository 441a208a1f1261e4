//! A formula as a row of operations, each on results of earlier ones.

use super::{
    MAX_NODES,
    graph::{Graph, Node, NodeId},
    operation::{Algebra, Binary, Constant, Unary},
};

/// One operation on registers; its result goes to the next one.
#[derive(Clone, Copy, Debug)]
enum Step {
    Unary(Unary, u16),
    Binary(Binary, u16, u16),
}

/// Registers hold x, y and z, then the constants, then a result a step.
#[derive(Clone, Debug)]
pub(super) struct Tape {
    constants: Box<[Constant]>,
    steps: Box<[Step]>,
    result: u16,
}

/// Registers that every formula needs at most: its nodes, and the variables
/// even if they are not used.
const MAX_REGISTERS: usize = (MAX_NODES + 3).next_power_of_two();

impl Tape {
    /// What is needed for one part of a graph, in its order.
    pub(super) fn of(graph: &Graph, root: NodeId) -> Self {
        let needed = needed(graph, root);
        let parts = || graph.nodes.iter().enumerate().filter(|&(i, _)| needed[i]);
        let mut register = vec![0; graph.nodes.len()];
        let mut constants = Vec::new();
        for (i, node) in parts() {
            match *node {
                Node::Variable(axis) => register[i] = u16::from(axis),
                Node::Constant(c) => {
                    register[i] = 3 + constants.len() as u16;
                    constants.push(graph.constants[c as usize]);
                }
                Node::Unary(..) | Node::Binary(..) => {}
            }
        }
        let mut steps = Vec::new();
        for (i, node) in parts() {
            let at = |id: NodeId| register[id as usize];
            let step = match *node {
                Node::Unary(op, a) => Step::Unary(op, at(a)),
                Node::Binary(op, a, b) => Step::Binary(op, at(a), at(b)),
                Node::Variable(_) | Node::Constant(_) => continue,
            };
            register[i] = (3 + constants.len() + steps.len()) as u16;
            steps.push(step);
        }
        Self {
            constants: constants.into(),
            steps: steps.into(),
            result: register[root as usize],
        }
    }

    /// Number of operations.
    #[cfg(test)]
    pub(super) fn steps(&self) -> usize {
        self.steps.len()
    }

    /// Works the formula out for these variables. The registers are on the
    /// stack, in the smallest of a few sizes.
    #[inline]
    pub(super) fn run<A: Algebra>(&self, variables: [A; 3]) -> A {
        match 3 + self.constants.len() + self.steps.len() {
            ..=16 => self.run_in::<A, 16>(variables),
            17..=64 => self.run_in::<A, 64>(variables),
            _ => self.run_in::<A, MAX_REGISTERS>(variables),
        }
    }

    /// `R` is a power of two, at least the number of registers: indices are
    /// masked by it, which changes none and spares a check.
    fn run_in<A: Algebra, const R: usize>(&self, variables: [A; 3]) -> A {
        let mut registers = [variables[0]; R];
        registers[..3].copy_from_slice(&variables);
        let mut next = 3;
        for c in &self.constants {
            registers[next & (R - 1)] = A::constant(c);
            next += 1;
        }
        for step in &self.steps {
            let at = |i: u16| registers[i as usize & (R - 1)];
            registers[next & (R - 1)] = match *step {
                Step::Unary(op, a) => A::unary(op, at(a)),
                Step::Binary(op, a, b) => A::binary(op, at(a), at(b)),
            };
            next += 1;
        }
        registers[self.result as usize & (R - 1)]
    }
}

/// Which parts of a graph one of them is made of.
fn needed(graph: &Graph, root: NodeId) -> Vec<bool> {
    let mut needed = vec![false; graph.nodes.len()];
    needed[root as usize] = true;
    for i in (0..graph.nodes.len()).rev().filter(|&i| i <= root as usize) {
        if !needed[i] {
            continue;
        }
        match graph.nodes[i] {
            Node::Unary(_, a) => needed[a as usize] = true,
            Node::Binary(_, a, b) => {
                needed[a as usize] = true;
                needed[b as usize] = true;
            }
            Node::Variable(_) | Node::Constant(_) => {}
        }
    }
    needed
}
