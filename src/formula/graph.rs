//! A formula as a graph in which equal parts are one.

use std::collections::HashMap;

use super::{
    MAX_NODES,
    bound::Enclosure,
    operation::{Algebra, Binary, Bits, Constant, Unary},
};

/// Index of a part in its graph. Operands stand before what uses them.
pub(super) type NodeId = u16;

/// A part of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// x, y or z: 0, 1 or 2.
    Variable(u8),
    /// An entry of [`Graph::constants`].
    Constant(u16),
    Unary(Unary, NodeId),
    Binary(Binary, NodeId, NodeId),
}

/// Largest power that is formed by repeated multiplication.
const MAX_WHOLE_POWER: u32 = 1 << 30;

/// Why a part cannot be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// There are [`MAX_NODES`] already.
    TooMany,
    /// Its value, which depends on no variable, is not a finite number.
    NotFinite,
}

/// All parts of a formula.
#[derive(Debug, Default)]
pub(super) struct Graph {
    pub(super) nodes: Vec<Node>,
    pub(super) constants: Vec<Constant>,
    known: HashMap<Node, NodeId>,
    /// Constants by value and bounds.
    numbers: HashMap<[Bits; 3], u16>,
}

impl Graph {
    /// The part, added if it is new.
    fn node(&mut self, node: Node) -> Result<NodeId, Refusal> {
        if let Some(&id) = self.known.get(&node) {
            return Ok(id);
        }
        if self.nodes.len() == MAX_NODES {
            return Err(Refusal::TooMany);
        }
        let id = self.nodes.len() as NodeId;
        self.nodes.push(node);
        self.known.insert(node, id);
        Ok(id)
    }

    pub(super) fn variable(&mut self, index: u8) -> Result<NodeId, Refusal> {
        self.node(Node::Variable(index))
    }

    pub(super) fn number(&mut self, value: f64) -> Result<NodeId, Refusal> {
        self.constant(Constant::of(value))
    }

    fn constant(&mut self, c: Constant) -> Result<NodeId, Refusal> {
        if !c.value.is_finite() {
            return Err(Refusal::NotFinite);
        }
        let key = [c.value, c.bound.lo(), c.bound.hi()].map(Bits::of);
        let next = self.constants.len() as u16;
        let index = *self.numbers.entry(key).or_insert(next);
        if index == next {
            self.constants.push(c);
        }
        self.node(Node::Constant(index))
    }

    /// The constant that a part is, if it is one.
    fn constant_of(&self, id: NodeId) -> Option<Constant> {
        match self.nodes[id as usize] {
            Node::Constant(index) => Some(self.constants[index as usize]),
            _ => None,
        }
    }

    pub(super) fn unary(&mut self, op: Unary, a: NodeId) -> Result<NodeId, Refusal> {
        if let Some(c) = self.constant_of(a) {
            return self.constant(Constant {
                value: f64::unary(op, c.value),
                bound: Enclosure::unary(op, Enclosure::of(c.bound)).range,
            });
        }
        self.node(Node::Unary(op, a))
    }

    pub(super) fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) -> Result<NodeId, Refusal> {
        if let (Some(c), Some(d)) = (self.constant_of(a), self.constant_of(b)) {
            let (x, y) = (Enclosure::of(c.bound), Enclosure::of(d.bound));
            return self.constant(Constant {
                value: f64::binary(op, c.value, d.value),
                bound: Enclosure::binary(op, x, y).range,
            });
        }
        // As a square it is never negative; as two factors nobody would know
        // that they are the same.
        if op == Binary::Mul && a == b {
            return self.unary(Unary::Powi(2), a);
        }
        let commutes = matches!(op, Binary::Add | Binary::Mul);
        let (a, b) = if commutes && b < a { (b, a) } else { (a, b) };
        self.node(Node::Binary(op, a, b))
    }

    /// `a` to the power `b`: repeated multiplication if `b` is a whole
    /// number, `exp(b log a)` if it is not fixed.
    pub(super) fn power(&mut self, a: NodeId, b: NodeId) -> Result<NodeId, Refusal> {
        let Some(exponent) = self.constant_of(b).map(|c| c.value) else {
            let log = self.unary(Unary::Log, a)?;
            let product = self.binary(Binary::Mul, b, log)?;
            return self.unary(Unary::Exp, product);
        };
        let whole = exponent as i32;
        if f64::from(whole) != exponent || whole.unsigned_abs() > MAX_WHOLE_POWER {
            return self.unary(Unary::Powf(Bits::of(exponent)), a);
        }
        match whole {
            0 => self.number(1.0),
            1 => Ok(a),
            _ => self.unary(Unary::Powi(whole), a),
        }
    }
}
