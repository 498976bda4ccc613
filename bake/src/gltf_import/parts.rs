//! Turns drafts into parts and instances. Placements become similarities, under which form factors do not change: the
//! rest of the root's transform is applied to the part. Of a rotation with a stretch, only the stretch is applied, so
//! that rotated copies share a part. Parts are then moved so that their coordinates start at zero, and parts with equal
//! contents are merged.

use super::drafts::{Draft, Paints, Settings};
use super::materials::{Paint, same_material};
use super::surfaces::{Dropped, FaceSet, f64_spacing, has_area};
use crate::geometry::tolerance::SIMILARITY;
use equilux_formats::texture::TexturedTriangle;
use equilux_formats::{Part, PartId, Surface};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Splits a root's transform into the linear map that is applied to the part, and its placement.
pub(super) fn split(transform: DAffine3) -> (DMat3, DAffine3) {
    let linear = transform.matrix3;
    if is_similarity(linear) {
        return (DMat3::IDENTITY, transform);
    }
    // Rounded to f32, the precision of files, so that it is bit-identical for all rotations of the node.
    let lengths = [linear.x_axis, linear.y_axis, linear.z_axis].map(|axis| f64::from(axis.length() as f32));
    let stretch = DMat3::from_diagonal(DVec3::from_array(lengths));
    let turn = linear * DMat3::from_diagonal(DVec3::from_array(lengths.map(f64::recip)));
    match turn.is_finite() && is_similarity(turn) {
        true => (stretch, DAffine3 { matrix3: turn, translation: transform.translation }),
        false => (linear, DAffine3::from_translation(transform.translation)),
    }
}

/// Whether `linear` is a rotation or reflection times a scale: LᵀL = s²·1. The square doubles the tolerance.
fn is_similarity(linear: DMat3) -> bool {
    let gram = linear.transpose() * linear;
    let square = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
    let off = gram - DMat3::from_diagonal(DVec3::splat(square));
    let off = off.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    square > 0.0 && off <= 2.0 * SIMILARITY * square
}

/// A part, with its origin in its draft.
pub(super) struct Settled {
    pub(super) part: Part,
    /// The paints of its materials, in order.
    pub(super) paints: Vec<Paint>,
    /// Its origin in the draft's coordinates.
    pub(super) start: DVec3,
    /// The dropped faces.
    pub(super) dropped: Dropped,
}

/// The part made of `draft` after `linear`.
pub(super) fn settle(draft: &Draft, linear: DMat3, settings: Settings, name: String) -> Settled {
    let linear = DAffine3::from_mat3(linear);
    let placed = draft.surfaces.iter().map(|surface| surface.placed(linear));
    let placed: Vec<Surface> = placed.filter(|surface| has_area(&surface.corners, rounding)).collect();
    let start = lowest_corner(&placed);

    let mut dropped = draft.dropped;
    dropped.without_area += draft.surfaces.len() - placed.len();
    let (mut surfaces, mut seen, mut paints) = (Vec::new(), FaceSet::default(), Paints::default());
    let mut renumbered = vec![None; draft.paints.0.len()];
    for surface in placed {
        // Adding 0 turns −0 into 0, so that equal parts are equal bit by bit.
        let corners = surface.corners.map(|corner| corner - start + 0.0);
        // Tested again: beside a corner at 1e30 m, this subtraction cancels all digits of a wall.
        if !has_area(&corners, rounding) {
            dropped.without_area += 1;
        } else if !seen.first_time(&corners) {
            dropped.duplicates += 1;
        } else {
            let old = surface.material.index();
            let material = *renumbered[old].get_or_insert_with(|| paints.id(draft.paints.0[old].clone()));
            surfaces.push(Surface { corners, material, ..surface });
        }
    }
    let textured = draft.textured.iter().filter_map(|triangle| {
        let (material, placed) = (renumbered[triangle.material.index()]?, triangle.placed(linear));
        let corners = placed.corners.map(|corner| corner - start + 0.0);
        Some(TexturedTriangle { material, corners, ..placed })
    });
    let textured = textured.collect();
    let Settings { element_size, local_solver } = settings;
    let materials = paints.0.iter().map(Paint::material).collect();
    let part = Part { name, surfaces, materials, textured, element_size, local_solver };
    Settled { part, paints: paints.0, start, dropped }
}

/// Rounding of a transformed coordinate of this magnitude: sums of a few rounded products.
fn rounding(magnitude: f64) -> f64 {
    16.0 * f64_spacing(magnitude)
}

fn lowest_corner(surfaces: &[Surface]) -> DVec3 {
    let corners = surfaces.iter().flat_map(|surface| surface.corners.as_slice());
    corners.copied().reduce(DVec3::min).unwrap_or(DVec3::ZERO)
}

/// The distinct parts of a scene.
#[derive(Default)]
pub(super) struct Catalogue {
    pub(super) parts: Vec<Part>,
    by_content: HashMap<u64, Vec<PartId>>,
    /// The number of parts with each name.
    named: HashMap<String, usize>,
}

impl Catalogue {
    /// The id of the part with the contents of `part`. Parts of the same name, such as a crate and a stretched crate,
    /// are numbered, because the cache finds older versions of a part by its name.
    pub(super) fn id(&mut self, mut part: Part) -> PartId {
        let alike = self.by_content.entry(content_hash(&part)).or_default();
        if let Some(&known) = alike.iter().find(|id| same_content(&self.parts[id.index()], &part)) {
            return known;
        }
        let id = PartId::from_index(self.parts.len());
        alike.push(id);
        let count = self.named.entry(part.name.clone()).or_default();
        *count += 1;
        if *count > 1 {
            part.name = format!("{} ({count})", part.name);
        }
        self.parts.push(part);
        id
    }
}

fn content_hash(part: &Part) -> u64 {
    let mut hasher = DefaultHasher::new();
    part.element_size.map(f64::to_bits).hash(&mut hasher);
    part.local_solver.hash(&mut hasher);
    for surface in &part.surfaces {
        surface.material.hash(&mut hasher);
        surface
            .corners
            .as_slice()
            .iter()
            .for_each(|corner| corner.to_array().map(f64::to_bits).hash(&mut hasher));
    }
    hasher.finish()
}

/// Whether two parts are equal except for names.
fn same_content(left: &Part, right: &Part) -> bool {
    (left.element_size, left.local_solver) == (right.element_size, right.local_solver)
        && left.surfaces == right.surfaces
        && left.textured == right.textured
        && left.materials.len() == right.materials.len()
        && left.materials.iter().zip(&right.materials).all(|(left, right)| same_material(left, right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_similarity_places_and_anything_else_is_worked_in() {
        let turn = DMat3::from_quat(DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(2.0));
        let rounded = DMat3::from_cols_array(&turn.to_cols_array().map(|x| f64::from(x as f32)));
        for (case, linear, placed) in [
            ("a turn", turn, true),
            ("a turn that was rounded to f32", rounded, true),
            ("a scaled mirror", turn * DMat3::from_diagonal(DVec3::new(-3.0, 3.0, 3.0)), true),
            ("a stretch", turn * DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.001)), false),
            ("a flattening", DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)), false),
            ("nothing", DMat3::ZERO, false),
        ] {
            let transform = DAffine3 { matrix3: linear, translation: DVec3::X };
            let (worked_in, placement) = split(transform);
            assert_eq!(worked_in == DMat3::IDENTITY, placed, "{case}");
            assert_eq!(placement * DAffine3::from_mat3(worked_in), transform, "{case}");
        }
    }
}
