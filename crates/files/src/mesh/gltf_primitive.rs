//! The triangles of one primitive of a glTF document.

use crate::mesh::error::MeshError;
use crate::mesh::gltf_buffers::{Buffers, Elements, broken};
use crate::mesh::gltf_nodes::cofactors;
use glam::{DAffine3, DMat3, DVec3};
use gltf::json::Root;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use lumiduct_base::mesh::{MeshBuilder, UNNAMED_FACE};

/// Positions and normals of a primitive, with the transform to the scene.
struct Vertices<'a> {
    positions: Elements<'a>,
    normals: Option<Elements<'a>>,
    to_scene: DAffine3,
    normal_to_scene: DMat3,
}

impl Vertices<'_> {
    fn position(&self, index: usize) -> Option<DVec3> {
        Some(self.to_scene.transform_point3(vector3(self.positions.get(index)?)?))
    }

    fn normal(&self, index: usize) -> Option<DVec3> {
        Some(self.normal_to_scene * vector3(self.normals?.get(index)?)?)
    }
}

/// Adds the triangles of a primitive.
pub(crate) fn add_primitive(
    builder: &mut MeshBuilder,
    root: &Root,
    buffers: &Buffers<'_>,
    primitive: &Primitive,
    to_scene: &DAffine3,
) -> Result<(), MeshError> {
    if primitive.mode != Checked::Valid(Mode::Triangles) {
        return Err(MeshError::Unsupported {
            what: "the glTF file has points, lines, strips or fans".into(),
            remedy: "export separate triangles only",
        });
    }
    let vertices = vertices(buffers, primitive, to_scene)?;
    let face = face_name(root, primitive)?;
    let indices = match primitive.indices {
        Some(accessor) => Some(buffers.elements(accessor, Type::Scalar)?),
        None => None,
    };
    let count = indices.map_or(vertices.positions.count(), |(elements, _)| elements.count());
    if !count.is_multiple_of(3) {
        return Err(broken(format!("a primitive has {count} corners, not three per triangle")));
    }
    let mirrored = to_scene.matrix3.determinant() < 0.0;
    for first in (0..count).step_by(3) {
        // Mirroring reverses the orientation.
        let corners = if mirrored { [0, 2, 1] } else { [0, 1, 2] }.map(|corner| {
            let index = match indices {
                Some((elements, component)) => unsigned(elements.get(first + corner)?, component)?,
                None => first + corner,
            };
            Some((vertices.position(index)?, vertices.normal(index)))
        });
        let [Some(a), Some(b), Some(c)] = corners else {
            return Err(broken("an index names a vertex that does not exist".into()));
        };
        let normals = match (a.1, b.1, c.1) {
            (Some(a), Some(b), Some(c)) => Some([a, b, c]),
            _ => None,
        };
        builder.add([a.0, b.0, c.0], normals, &face)?;
    }
    Ok(())
}

fn vertices<'a>(
    buffers: &'a Buffers<'_>,
    primitive: &Primitive,
    to_scene: &DAffine3,
) -> Result<Vertices<'a>, MeshError> {
    let attribute = |semantic: Semantic| match primitive.attributes.get(&Checked::Valid(semantic)) {
        Some(accessor) => match buffers.elements(*accessor, Type::Vec3)? {
            (elements, ComponentType::F32) => Ok(Some(elements)),
            _ => Err(MeshError::Unsupported {
                what: "the glTF file has quantised positions or normals".into(),
                remedy: "export without mesh quantisation",
            }),
        },
        None => Ok(None),
    };
    let positions = attribute(Semantic::Positions)?;
    let positions = positions.ok_or_else(|| broken("a primitive has no positions".into()))?;
    let normals = attribute(Semantic::Normals)?;
    if normals.is_some_and(|normals| normals.count() != positions.count()) {
        return Err(broken("a primitive has not as many normals as positions".into()));
    }
    Ok(Vertices {
        positions,
        normals,
        to_scene: *to_scene,
        normal_to_scene: cofactors(to_scene.matrix3),
    })
}

fn face_name(root: &Root, primitive: &Primitive) -> Result<String, MeshError> {
    let Some(index) = primitive.material else { return Ok(UNNAMED_FACE.to_owned()) };
    let number = index.value();
    let material = root.get(index);
    let material = material.ok_or_else(|| broken(format!("material {number} does not exist")))?;
    Ok(material.name.clone().unwrap_or_else(|| format!("material_{number}")))
}

fn vector3(bytes: &[u8]) -> Option<DVec3> {
    match bytes.as_chunks::<4>().0 {
        [x, y, z] => Some(DVec3::from_array([x, y, z].map(|c| f64::from(f32::from_le_bytes(*c))))),
        _ => None,
    }
}

fn unsigned(bytes: &[u8], component: ComponentType) -> Option<usize> {
    match component {
        ComponentType::U8 => Some(usize::from(*bytes.first()?)),
        ComponentType::U16 => Some(usize::from(u16::from_le_bytes(bytes.try_into().ok()?))),
        ComponentType::U32 => Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize),
        ComponentType::I8 | ComponentType::I16 | ComponentType::F32 => None,
    }
}
