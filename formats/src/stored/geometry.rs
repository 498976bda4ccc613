//! The part file: elements and faces by their corners, and the self block. Normals, centroids and areas are computed
//! again from the corners by the same code, so they are bit-identical.

use super::rows::{Meta, read_rows, write_rows};
use super::{Stored, array_of, check, finite_array, finite_rows};
use crate::baked::{BakedGeometry, Escapes};
use crate::clusters::ClusterTree;
use crate::container::{Kind, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::geometry::{Corners, Element, Face, Geometry, Patches};
use crate::ids::{FaceId, MaterialId};
use glam::DVec3;

impl Stored for BakedGeometry {
    const KIND: Kind = Kind::Part;

    fn write(&self, manifest: &Manifest) -> Writer {
        let mut writer = Writer::new(Self::KIND, manifest, &Meta::of(&self.self_block));
        write_elements(&self.geometry.elements, &mut writer);
        write_faces(&self.geometry.faces, &mut writer);
        writer.array("cluster children", self.geometry.clusters.children().as_flattened());
        let patches = self.geometry.patches.as_ref();
        writer.array("patches", patches.map_or(&[][..], |patches| &patches.of));
        writer.array("rays", &patches.map_or(vec![], |patches| vec![patches.rays]));
        write_escapes(&self.escapes, &mut writer);
        write_rows(&self.self_block, &mut writer);
        writer
    }

    fn read(reader: &mut Reader) -> Result<Self> {
        let faces = read_faces(reader)?;
        let elements = read_elements(reader, faces.len())?;
        let clusters = read_clusters(reader, &elements)?;
        let patches = read_patches(reader, &elements)?;
        let meta = reader.meta()?;
        let self_block = read_rows(reader, meta)?;
        let geometry = Geometry { elements, faces, clusters, patches };
        let (nodes, unknowns) = (geometry.unknowns().nodes(), geometry.unknowns().elements());
        check(reader, self_block.senders() == nodes, || {
            format!("{} columns for {nodes} senders", self_block.senders())
        })?;
        check(reader, self_block.receivers() == unknowns, || {
            format!("{} rows for {unknowns} unknowns", self_block.receivers())
        })?;
        let escapes = read_escapes(reader, &geometry)?;
        Ok(Self { geometry, self_block, escapes })
    }
}

fn read_patches(reader: &mut Reader, elements: &[Element]) -> Result<Option<Patches>> {
    let of: Vec<u32> = reader.array("patches")?;
    match reader.array::<u32>("rays")?[..] {
        [] => Ok(None),
        [rays] => Patches::new(of, elements, rays).map(Some).map_err(|problem| reader.damaged(problem)),
        _ => Err(reader.damaged("several numbers of rays")),
    }
}

fn write_escapes(escapes: &Escapes, writer: &mut Writer) {
    writer.array("escaped rays", &escapes.escaped);
    writer.array("covered rays", &escapes.covered);
    writer.array("reach of rays", escapes.reach.as_flattened());
}

fn read_escapes(reader: &mut Reader, geometry: &Geometry) -> Result<Escapes> {
    let (rows, rays) = geometry.patches.as_ref().map_or((0, 0), |p| (p.tree.elements(), p.rays as usize));
    let escaped = array_of::<u64>(reader, "escaped rays", rows * rays.div_ceil(64))?;
    let covered = array_of::<u16>(reader, "covered rays", rows)?;
    let reach = finite_array::<f32>(reader, "reach of rays")?;
    let (boxes, rest) = reach.as_chunks::<6>();
    check(reader, boxes.len() == rows && rest.is_empty(), || {
        format!("{} boxes for {rows} rows", boxes.len())
    })?;
    Ok(Escapes { escaped, covered, reach: boxes.to_vec() })
}

fn write_elements(elements: &[Element], writer: &mut Writer) {
    let column = |value: fn(&Element) -> u32| elements.iter().map(value).collect::<Vec<_>>();
    let corners: Vec<f64> = elements.iter().flat_map(|element| element.corners.padded()).collect();
    writer.array("element corners", &corners);
    writer.array("element corner counts", &column(|element| element.corners.as_slice().len() as u32));
    writer.array("element materials", &column(|element| element.material.0));
    writer.array("element faces", &column(|element| element.face.0));
}

fn read_elements(reader: &mut Reader, face_count: usize) -> Result<Vec<Element>> {
    let corners = finite_rows::<12>(reader, "element corners")?;
    let counts = array_of::<u32>(reader, "element corner counts", corners.len())?;
    let materials = array_of::<u32>(reader, "element materials", corners.len())?;
    let faces = array_of::<u32>(reader, "element faces", corners.len())?;

    let mut elements = Vec::with_capacity(corners.len());
    for (i, coordinates) in corners.iter().enumerate() {
        let corners = Corners::from_padded(coordinates, counts[i])
            .ok_or_else(|| reader.damaged(format!("element {i} with {} corners", counts[i])))?;
        let element = Element::new(corners, MaterialId(materials[i]), FaceId(faces[i]));
        check(reader, element.normal.is_finite(), || format!("element {i} without an area"))?;
        check(reader, element.face.index() < face_count, || {
            format!("element {i} in face {} of {face_count}", faces[i])
        })?;
        elements.push(element);
    }
    Ok(elements)
}

fn read_clusters(reader: &mut Reader, elements: &[Element]) -> Result<ClusterTree> {
    let children = reader.array::<u32>("cluster children")?;
    let (pairs, rest) = children.as_chunks::<2>();
    check(reader, rest.is_empty(), || "half a cluster".into())?;
    let areas: Vec<f64> = elements.iter().map(|element| element.area).collect();
    ClusterTree::new(&areas, pairs.to_vec()).map_err(|problem| reader.damaged(problem))
}

fn write_faces(faces: &[Face], writer: &mut Writer) {
    let counts: Vec<u32> = faces.iter().map(|face| face.corners.len() as u32).collect();
    let corners: Vec<f64> = faces.iter().flat_map(|face| &face.corners).flat_map(DVec3::to_array).collect();
    writer.array("face corner counts", &counts);
    writer.array("face corners", &corners);
}

fn read_faces(reader: &mut Reader) -> Result<Vec<Face>> {
    let counts = reader.array::<u32>("face corner counts")?;
    let corners = finite_rows::<3>(reader, "face corners")?;
    let mut rest = corners.iter().copied().map(DVec3::from_array);
    let mut faces = Vec::with_capacity(counts.len());
    for (i, &count) in counts.iter().enumerate() {
        check(reader, count >= 3 && count as usize <= rest.len(), || {
            format!("face {i} with {count} corners, {} being left", rest.len())
        })?;
        let face = Face::new(rest.by_ref().take(count as usize).collect());
        check(reader, face.normal.is_finite(), || format!("face {i} without an area"))?;
        faces.push(face);
    }
    check(reader, rest.len() == 0, || format!("{} corners without a face", rest.len()))?;
    Ok(faces)
}
