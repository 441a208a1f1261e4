//! The scene: nodes, one within the other, and the meshes that hang on them.

use std::{collections::HashMap, rc::Rc};

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use serde::Deserialize;

use super::{
    accessor::{Buffers, Elements, Wanted},
    document::{Document, List},
};
use crate::scene::{
    MAX_TRIANGLES,
    mesh_file::{Fault, MeshData, fill_normals, names::Namer, position, unit_normal},
};

/// Most primitives that are placed, each time a node shows one.
const MAX_PLACED: usize = 1 << 20;

#[derive(Deserialize)]
struct SceneEntry {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Node {
    name: Option<String>,
    #[serde(default)]
    children: Vec<usize>,
    mesh: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
struct Mesh {
    name: Option<String>,
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    material: Option<usize>,
    #[serde(default = "triangles")]
    mode: u32,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Attributes {
    position: Option<usize>,
    normal: Option<usize>,
}

#[derive(Deserialize)]
struct Named {
    name: Option<String>,
}

const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

fn triangles() -> u32 {
    TRIANGLES
}

/// Where a node puts what hangs on it.
#[derive(Clone, Copy)]
struct Place {
    map: DAffine3,
    /// How normals are mapped, up to their length.
    normals: DMat3,
    mirrors: bool,
}

impl Place {
    fn of(map: DAffine3) -> Self {
        let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
        let mirrors = x.dot(y.cross(z)) < 0.0;
        // The inverse transpose times the determinant; its sign goes to the
        // side on which the mirrored normal belongs.
        let sign = if mirrors { -1.0 } else { 1.0 };
        let normals = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
        Self {
            map,
            normals,
            mirrors,
        }
    }
}

/// Puts the meshes of a scene together.
pub(super) struct Assembler<'a, 'd> {
    document: &'d Document<'a>,
    buffers: Buffers<'a, 'd>,
    meshes: HashMap<usize, Rc<Mesh>>,
    namer: Namer,
    vertices: Vec<DVec3>,
    normals: Vec<DVec3>,
    any_normal: bool,
    triangles: Vec<[u32; 3]>,
    placed: usize,
}

impl<'a, 'd> Assembler<'a, 'd> {
    pub(super) fn new(document: &'d Document<'a>, buffers: Buffers<'a, 'd>) -> Self {
        Self {
            document,
            buffers,
            meshes: HashMap::new(),
            namer: Namer::default(),
            vertices: Vec::new(),
            normals: Vec::new(),
            any_normal: false,
            triangles: Vec::new(),
            placed: 0,
        }
    }

    /// All meshes of the scene to show: the file's default one, or its first,
    /// or all nodes if it has no scenes.
    pub(super) fn scene(mut self) -> Result<MeshData, Fault> {
        // y up to z up: (x, y, z) becomes (x, -z, y).
        let turn = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
        let mut seen = vec![false; self.document.count(List::Nodes)];
        let mut stack = Vec::new();
        self.hang(
            &self.roots()?,
            DAffine3::from_mat3(turn),
            &mut seen,
            &mut stack,
        )?;
        while let Some((index, above)) = stack.pop() {
            let node: Node = self.document.get(List::Nodes, index)?;
            let map = above * self.local(&node, index)?;
            if let Some(mesh) = node.mesh {
                self.namer.say(1, node.name.into_iter().collect());
                self.mesh(mesh, index, &Place::of(map))?;
            }
            self.hang(&node.children, map, &mut seen, &mut stack)?;
        }
        Ok(self.finish())
    }

    /// Puts nodes on the stack, the first on top; each may come once.
    fn hang(
        &self,
        nodes: &[usize],
        map: DAffine3,
        seen: &mut [bool],
        stack: &mut Vec<(usize, DAffine3)>,
    ) -> Result<(), Fault> {
        for &index in nodes.iter().rev() {
            if seen
                .get_mut(index)
                .is_some_and(|seen| std::mem::replace(seen, true))
            {
                let message = "a node that hangs on two others, or on itself";
                return Err(self.document.fault(List::Nodes, index, message));
            }
            stack.push((index, map));
        }
        Ok(())
    }

    fn roots(&self) -> Result<Vec<usize>, Fault> {
        if self.document.count(List::Scenes) > 0 {
            let scene: SceneEntry = self
                .document
                .get(List::Scenes, self.document.default_scene().unwrap_or(0))?;
            return Ok(scene.nodes);
        }
        let count = self.document.count(List::Nodes);
        let mut is_child = vec![false; count];
        for index in 0..count {
            let node: Node = self.document.get(List::Nodes, index)?;
            for child in node.children {
                if let Some(is_child) = is_child.get_mut(child) {
                    *is_child = true;
                }
            }
        }
        Ok((0..count).filter(|&i| !is_child[i]).collect())
    }

    /// A node's own transform.
    fn local(&self, node: &Node, index: usize) -> Result<DAffine3, Fault> {
        let fault = |message| Err(self.document.fault(List::Nodes, index, message));
        if let Some(m) = node.matrix {
            let m = DMat4::from_cols_array(&m);
            if m.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
                return fault("the last row of `matrix` is not 0 0 0 1");
            }
            return Ok(DAffine3::from_mat4(m));
        }
        let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let length = rotation.length();
        if !(length.is_finite() && length > 0.0) {
            return fault("`rotation` is not a quaternion of some length");
        }
        Ok(DAffine3::from_scale_rotation_translation(
            DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
            rotation / length,
            DVec3::from_array(node.translation.unwrap_or([0.0; 3])),
        ))
    }

    fn mesh(&mut self, index: usize, node: usize, place: &Place) -> Result<(), Fault> {
        let mesh = match self.meshes.get(&index) {
            Some(mesh) => mesh.clone(),
            None => {
                let mesh: Rc<Mesh> = Rc::new(self.document.get(List::Meshes, index)?);
                self.meshes.insert(index, mesh.clone());
                mesh
            }
        };
        self.namer.say(2, mesh.name.iter().cloned().collect());
        // Primitives of a mesh often share their vertices.
        let mut bases = HashMap::new();
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            self.placed += 1;
            if self.placed > MAX_PLACED {
                let message = "more than a million primitives in all nodes";
                return Err(self.document.fault(List::Nodes, node, message));
            }
            if !(TRIANGLES..=FAN).contains(&primitive.mode) {
                continue;
            }
            let at = |message: &str| {
                let message = format!("primitives[{k}]: {message}");
                self.document.fault(List::Meshes, index, &message)
            };
            let Some(positions) = primitive.attributes.position else {
                return Err(at("`attributes` has no POSITION"));
            };
            let positions = self.buffers.elements(positions, Wanted::Vector)?;
            let key = (primitive.attributes.position, primitive.attributes.normal);
            let base = match bases.get(&key) {
                Some(&base) => base,
                None => {
                    let normals = primitive.attributes.normal;
                    let normals = normals.map(|n| self.buffers.elements(n, Wanted::Vector));
                    let base = self.vertices(&positions, normals.transpose()?.as_ref(), place);
                    let base = base.map_err(|message| at(&message))?;
                    bases.insert(key, base);
                    base
                }
            };
            let material = primitive.material;
            let material = material.map(|m| self.document.get::<Named>(List::Materials, m));
            let material = material.transpose()?.and_then(|m| m.name);
            self.namer.say(0, material.into_iter().collect());
            let indices = primitive.indices;
            let indices = indices.map(|i| self.buffers.elements(i, Wanted::Index));
            let corners = Corners {
                base,
                vertices: positions.count,
                indices: indices.transpose()?,
            };
            self.faces(&corners, primitive.mode, place.mirrors)
                .map_err(|message| at(&message))?;
        }
        Ok(())
    }

    /// Adds vertices; the number of the first one.
    fn vertices(
        &mut self,
        positions: &Elements,
        normals: Option<&Elements>,
        place: &Place,
    ) -> Result<u32, String> {
        let base = self.vertices.len();
        if (base + positions.count) as u64 > 3 * MAX_TRIANGLES {
            return Err(format!(
                "more than {} vertices in all nodes",
                3 * MAX_TRIANGLES
            ));
        }
        for i in 0..positions.count {
            let p = place
                .map
                .transform_point3(DVec3::from_array(positions.vector(i)));
            let p = position(p.to_array())
                .ok_or_else(|| format!("vertex {i} is not finite or too far away"))?;
            self.vertices.push(p);
        }
        if let Some(normals) = normals {
            if normals.count != positions.count {
                let (n, v) = (normals.count, positions.count);
                return Err(format!("{n} normals for {v} vertices"));
            }
            self.any_normal = true;
            for i in 0..normals.count {
                let n = unit_normal(normals.vector(i)).map(|n| place.normals * n);
                let n = n.and_then(|n| unit_normal(n.to_array()));
                self.normals
                    .push(n.ok_or_else(|| format!("normal {i} is not finite"))?);
            }
        }
        self.normals.resize(self.vertices.len(), DVec3::ZERO);
        Ok(base as u32)
    }

    fn faces(&mut self, corners: &Corners, mode: u32, mirrors: bool) -> Result<(), String> {
        let count = corners.count();
        let faces = match mode {
            TRIANGLES if !count.is_multiple_of(3) => {
                return Err(format!("{count} corners are no whole number of triangles"));
            }
            TRIANGLES => count / 3,
            _ => count.saturating_sub(2),
        };
        if (self.triangles.len() + faces) as u64 > MAX_TRIANGLES {
            return Err(format!("more than {MAX_TRIANGLES} triangles in all nodes"));
        }
        for i in 0..faces {
            let [a, b, c] = match mode {
                TRIANGLES => [3 * i, 3 * i + 1, 3 * i + 2],
                // Every other triangle of a strip runs backwards.
                STRIP if i % 2 == 1 => [i, i + 2, i + 1],
                STRIP => [i, i + 1, i + 2],
                _ => [i + 1, i + 2, 0],
            };
            let [a, b, c] = [corners.vertex(a)?, corners.vertex(b)?, corners.vertex(c)?];
            self.triangles
                .push(if mirrors { [a, c, b] } else { [a, b, c] });
        }
        self.namer.mark(self.triangles.len());
        Ok(())
    }

    fn finish(self) -> MeshData {
        let mut normals = self.normals;
        if self.any_normal {
            fill_normals(&self.vertices, &self.triangles, &mut normals);
        }
        MeshData {
            normals: self.any_normal.then_some(normals),
            vertices: self.vertices,
            triangles: self.triangles,
            names: self.namer.finish(),
        }
    }
}

/// The corners of a primitive, in the order of the file.
struct Corners<'a> {
    base: u32,
    vertices: usize,
    indices: Option<Elements<'a>>,
}

impl Corners<'_> {
    fn count(&self) -> usize {
        self.indices.as_ref().map_or(self.vertices, |i| i.count)
    }

    fn vertex(&self, corner: usize) -> Result<u32, String> {
        let Some(indices) = &self.indices else {
            return Ok(self.base + corner as u32);
        };
        let index = indices.index(corner);
        if index as usize >= self.vertices {
            let n = self.vertices;
            return Err(format!(
                "index {corner} names vertex {index}, but there are {n}"
            ));
        }
        Ok(self.base + index)
    }
}
