//! Vertex attributes of a primitive besides positions: texture coordinates, transformed by KHR_texture_transform, vertex colours
//! and normals.

use super::accessors::{check_type, components};
use super::document::Document;
use equilux_formats::{Result, Rgb};
use glam::{DAffine2, DMat2, DVec2, DVec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::{Primitive, Semantic, texture};

/// How a material uses a texture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Use {
    set: u32,
    transform: DAffine2,
}

impl Use {
    /// The use that `info` describes. The extension's example, which selects a quadrant of an image, defines the sense
    /// of its rotation: with v pointing down, coordinates turn counter-clockwise.
    pub(super) fn of(info: &texture::Info) -> Self {
        let Some(transform) = info.texture_transform() else {
            return Self { set: info.tex_coord(), transform: DAffine2::IDENTITY };
        };
        let vector = |v: [f32; 2]| DVec2::from_array(v.map(f64::from));
        let turn = DMat2::from_angle(-f64::from(transform.rotation()));
        let matrix = turn * DMat2::from_diagonal(vector(transform.scale()));
        Self {
            set: transform.tex_coord().unwrap_or(info.tex_coord()),
            transform: DAffine2::from_mat2_translation(matrix, vector(transform.offset())),
        }
    }

    /// Whether `primitive` has the coordinates.
    pub(super) fn is_served_by(&self, primitive: &Primitive) -> bool {
        primitive.get(&Semantic::TexCoords(self.set)).is_some()
    }

    /// The texture coordinates of the vertices of `primitive`; none if it has no such attribute.
    pub(super) fn places(
        &self,
        document: &Document,
        primitive: &Primitive,
        vertices: usize,
        mesh: &str,
    ) -> Result<Option<Vec<DVec2>>> {
        let places = texture_coordinates(document, primitive, self.set, vertices, mesh)?;
        let Some(mut places) = places else { return Ok(None) };
        for place in &mut places {
            *place = self.transform.transform_point2(*place);
        }
        match places.iter().all(|place| place.is_finite()) {
            true => Ok(Some(places)),
            false => Err(document.error(
                format!("TEXCOORD_{} of mesh {mesh} with coordinates that are not finite", self.set),
                "finite numbers",
                "unwrap the mesh again",
            )),
        }
    }
}

/// TEXCOORD_`set`, if the primitive has it.
pub(super) fn texture_coordinates(
    document: &Document,
    primitive: &Primitive,
    set: u32,
    vertices: usize,
    mesh: &str,
) -> Result<Option<Vec<DVec2>>> {
    let what = format!("TEXCOORD_{set} of mesh {mesh}");
    let Some(accessor) = primitive.get(&Semantic::TexCoords(set)) else { return Ok(None) };
    // Signed integers are allowed by KHR_mesh_quantization.
    let types = [DataType::F32, DataType::I8, DataType::U8, DataType::I16, DataType::U16];
    check_type(document, &accessor, &what, Dimensions::Vec2, &types)?;
    check_count(document, &accessor, &what, vertices)?;
    Ok(Some(components(document, &accessor, &what)?.chunks_exact(2).map(DVec2::from_slice).collect()))
}

/// NORMAL, if the primitive has it.
pub(super) fn normals(
    document: &Document,
    primitive: &Primitive,
    vertices: usize,
    mesh: &str,
) -> Result<Option<Vec<DVec3>>> {
    let what = format!("NORMAL of mesh {mesh}");
    let Some(accessor) = primitive.get(&Semantic::Normals) else { return Ok(None) };
    // Integers are allowed by KHR_mesh_quantization.
    check_type(document, &accessor, &what, Dimensions::Vec3, &[DataType::F32, DataType::I8, DataType::I16])?;
    check_count(document, &accessor, &what, vertices)?;
    Ok(Some(components(document, &accessor, &what)?.chunks_exact(3).map(DVec3::from_slice).collect()))
}

/// COLOR_0, if the primitive has it, clamped to 0..1 as glTF requires, without alpha.
pub(super) fn vertex_colours(
    document: &Document,
    primitive: &Primitive,
    vertices: usize,
    mesh: &str,
) -> Result<Option<Vec<Rgb>>> {
    let what = format!("COLOR_0 of mesh {mesh}");
    let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(None) };
    let types = [DataType::F32, DataType::U8, DataType::U16];
    let dimensions = match check_type(document, &accessor, &what, Dimensions::Vec3, &types) {
        Ok(()) => Dimensions::Vec3,
        Err(_) => Dimensions::Vec4,
    };
    check_type(document, &accessor, &what, dimensions, &types)?;
    check_count(document, &accessor, &what, vertices)?;
    let values = components(document, &accessor, &what)?;
    if values.iter().any(|value| value.is_nan()) {
        return Err(document.error(
            format!("{what} in accessor {} with values that are no numbers", accessor.index()),
            "numbers, 0 to 1",
            "paint the mesh again, or remove its vertex colours",
        ));
    }
    let colour = |values: &[f64]| Rgb::from_fn(|c| values[c].clamp(0.0, 1.0));
    Ok(Some(values.chunks_exact(dimensions.multiplicity()).map(colour).collect()))
}

fn check_count(document: &Document, accessor: &gltf::Accessor, what: &str, vertices: usize) -> Result<()> {
    match accessor.count() == vertices {
        true => Ok(()),
        false => Err(document.error(
            format!("{what} in accessor {} with {} elements", accessor.index(), accessor.count()),
            format!("{vertices}, one for each position"),
            "export the file again, it contradicts itself",
        )),
    }
}
