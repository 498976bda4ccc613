//! Reads primitives as triangles: corner positions in the order of the file, from triangle lists, strips and fans,
//! indexed or not. Points and lines have no triangles.

use super::accessors::{check_type, components};
use super::coordinates::{Use, normals, texture_coordinates, vertex_colours};
use super::document::Document;
use super::materials::Uses;
use equilux_formats::texture::TexturedTriangle;
use equilux_formats::{MaterialId, Result, Rgb};
use glam::{DVec2, DVec3};
use gltf::Primitive;
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;

/// The triangles of one primitive.
pub(super) struct Triangles {
    /// Corners, counter-clockwise seen from the front, in mesh coordinates.
    pub(super) corners: Vec<[DVec3; 3]>,
    /// The lightmap coordinates of the corners, if there are any.
    pub(super) lightmap: Option<Vec<[DVec2; 3]>>,
    /// The normals of the corners, if there are any, as the file has them.
    pub(super) normals: Option<Vec<[DVec3; 3]>>,
    /// The same triangles with textures and vertex colours, if there are any. All of material 0.
    pub(super) textured: Option<Vec<TexturedTriangle>>,
    /// Whether positions were rounded to f32.
    pub(super) rounded: bool,
    /// Corners at the end of a list that are too few for a triangle.
    pub(super) left_over: usize,
}

/// The triangles of `primitive`, whose material uses the textures `uses`; none for primitives of points or lines.
/// `mesh` names it in errors.
pub(super) fn triangles(
    document: &Document,
    primitive: &Primitive,
    uses: &Uses,
    mesh: &str,
) -> Result<Option<Triangles>> {
    let Some(corners_of) = assembly(primitive.mode()) else { return Ok(None) };
    let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else { return Ok(None) };
    let positions = positions(document, &accessor, mesh)?;
    let order = match primitive.indices() {
        Some(indices) => indexed(document, &indices, positions.len(), mesh)?,
        None => (0..positions.len()).collect(),
    };
    let left_over = if primitive.mode() == Mode::Triangles { order.len() % 3 } else { 0 };
    let lightmap = texture_coordinates(document, primitive, 1, positions.len(), mesh)?;
    let normals = normals(document, primitive, positions.len(), mesh)?;
    let colouring = Colouring::of(document, primitive, uses, positions.len(), mesh)?;
    let vertices_of = || corners_of(order.len()).map(|corners| corners.map(|corner| order[corner]));
    let lightmap =
        lightmap.map(|places| vertices_of().map(|vertices| vertices.map(|vertex| places[vertex])).collect());
    let normals =
        normals.map(|normals| vertices_of().map(|vertices| vertices.map(|vertex| normals[vertex])).collect());
    let corners: Vec<[DVec3; 3]> = vertices_of()
        .map(|vertices| finite(document, &accessor, mesh, &positions, vertices))
        .collect::<Result<_>>()?;
    let textured = colouring.map(|colouring| {
        let triangles = corners.iter().zip(vertices_of());
        triangles.map(|(&corners, vertices)| colouring.triangle(corners, vertices)).collect()
    });
    Ok(Some(Triangles {
        corners,
        lightmap,
        normals,
        textured,
        rounded: accessor.data_type() == DataType::F32,
        left_over,
    }))
}

type Assembly = fn(usize) -> Box<dyn Iterator<Item = [usize; 3]>>;

/// Which of `n` corners make triangles (glTF 2.0 specification, §3.7.2.1); an odd triangle of a strip is turned over.
fn assembly(mode: Mode) -> Option<Assembly> {
    match mode {
        Mode::Triangles => Some(|n| Box::new((0..n / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]))),
        Mode::TriangleStrip => {
            Some(|n| Box::new((0..n.saturating_sub(2)).map(|i| [i, i + 1 + i % 2, i + 2 - i % 2])))
        }
        Mode::TriangleFan => Some(|n| Box::new((1..n.saturating_sub(1)).map(|i| [i, i + 1, 0]))),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
    }
}

fn positions(document: &Document, accessor: &gltf::Accessor, mesh: &str) -> Result<Vec<DVec3>> {
    let what = format!("POSITION of mesh {mesh}");
    let types = [DataType::F32, DataType::I8, DataType::U8, DataType::I16, DataType::U16];
    check_type(document, accessor, &what, Dimensions::Vec3, &types)?;
    Ok(components(document, accessor, &what)?.chunks_exact(3).map(DVec3::from_slice).collect())
}

/// The colours and texture coordinates of `vertices` vertices of `primitive`; none if colours do not vary.
struct Colouring {
    colours: Option<Vec<Rgb>>,
    reflectance_at: Option<Vec<DVec2>>,
    emission_at: Option<Vec<DVec2>>,
}

impl Colouring {
    fn of(
        document: &Document,
        primitive: &Primitive,
        uses: &Uses,
        vertices: usize,
        mesh: &str,
    ) -> Result<Option<Self>> {
        let places = |of: Option<Use>| match of {
            Some(of) => of.places(document, primitive, vertices, mesh),
            None => Ok(None),
        };
        let (reflectance_at, emission_at) = (places(uses.reflectance)?, places(uses.emission)?);
        let colours = vertex_colours(document, primitive, vertices, mesh)?;
        let any = colours.is_some() || reflectance_at.is_some() || emission_at.is_some();
        Ok(any.then_some(Self { colours, reflectance_at, emission_at }))
    }

    fn triangle(&self, corners: [DVec3; 3], vertices: [usize; 3]) -> TexturedTriangle {
        let at =
            |places: &Option<Vec<DVec2>>| places.as_ref().map(|places| vertices.map(|vertex| places[vertex]));
        TexturedTriangle {
            material: MaterialId(0),
            corners,
            colours: self
                .colours
                .as_ref()
                .map_or([Rgb::WHITE; 3], |colours| vertices.map(|vertex| colours[vertex])),
            reflectance_at: at(&self.reflectance_at),
            emission_at: at(&self.emission_at),
        }
    }
}

fn indexed(
    document: &Document,
    accessor: &gltf::Accessor,
    vertices: usize,
    mesh: &str,
) -> Result<Vec<usize>> {
    let what = format!("indices of mesh {mesh}");
    let types = [DataType::U8, DataType::U16, DataType::U32];
    check_type(document, accessor, &what, Dimensions::Scalar, &types)?;
    let indices: Vec<usize> =
        components(document, accessor, &what)?.into_iter().map(|index| index as usize).collect();
    match indices.iter().find(|&&index| index >= vertices) {
        None => Ok(indices),
        Some(index) => Err(document.error(
            format!("{what} in accessor {} with the index {index}", accessor.index()),
            format!("an index below {vertices}, its number of vertices"),
            "export the file again, it contradicts itself",
        )),
    }
}

fn finite(
    document: &Document,
    accessor: &gltf::Accessor,
    mesh: &str,
    positions: &[DVec3],
    vertices: [usize; 3],
) -> Result<[DVec3; 3]> {
    match vertices.into_iter().find(|&vertex| !positions[vertex].is_finite()) {
        None => Ok(vertices.map(|vertex| positions[vertex])),
        Some(vertex) => Err(document.error(
            format!(
                "POSITION of mesh {mesh} in accessor {} with vertex {vertex} at {}",
                accessor.index(),
                positions[vertex]
            ),
            "finite coordinates",
            "correct the mesh, it holds NaN or infinite positions",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        let of = |mode, n| assembly(mode).expect("has triangles")(n).collect::<Vec<_>>();
        assert_eq!(of(Mode::TriangleStrip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(of(Mode::TriangleFan, 4), [[1, 2, 0], [2, 3, 0]]);
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            assert!(
                (0..3).all(|n| of(mode, n).is_empty()),
                "{mode:?} of fewer than three corners has triangles"
            );
        }
    }
}
