//! The average colour of each element, in linear light, from textures and vertex colours of the triangles of its surface.
//!
//! Elements are matched with triangles by position and material. Elements, and with them form factors, therefore do not
//! depend on textures.

mod mean;
mod sums;

use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::polygon::{Clipped, Polygon, clip};
use crate::geometry::tolerance::{BENT, JOINED};
use equilux_formats::texture::{Texture, TexturedTriangle};
use equilux_formats::{Element, Geometry, Material, MaterialId, Rgb, Tints};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;
use sums::Sums;

/// Cosine of the angle up to which an element and a triangle face the same way.
const SAME_SIDE: f64 = 0.5;

/// The tints of all elements.
pub fn tints(geometry: &Geometry, materials: &[Material], textured: &[TexturedTriangle]) -> Tints {
    if textured.is_empty() {
        return Tints::plain(geometry.elements.len());
    }
    let coat = Coat::new(materials, textured);
    let of = |e: &Element| coat.tint(e.corners.as_slice(), e.normal, e.material);
    let (reflectance, emission) = geometry.elements.par_iter().map(of).unzip();
    Tints { reflectance, emission }
}

/// Textured triangles with an index, for colour queries.
#[derive(Debug)]
pub struct Coat<'a> {
    materials: &'a [Material],
    triangles: Vec<Sheet<'a>>,
    tree: BoxTree,
    /// By the address of the texture.
    sums: HashMap<usize, Sums<'a>>,
    /// Largest distance between a polygon and its triangle, metres, without the bend of a quad.
    slack: f64,
}

#[derive(Debug)]
struct Sheet<'a> {
    triangle: &'a TexturedTriangle,
    /// (b − a) × (c − a).
    across: DVec3,
    normal: DVec3,
    longest: f64,
}

/// The part of a polygon that lies on a triangle.
struct Share<'a> {
    sheet: &'a Sheet<'a>,
    piece: Polygon,
    distance: f64,
}

impl<'a> Coat<'a> {
    /// The coat of surfaces of these materials.
    pub fn new(materials: &'a [Material], textured: &'a [TexturedTriangle]) -> Self {
        let triangles: Vec<Sheet> =
            textured.iter().map(Sheet::new).filter(|sheet| sheet.normal.is_finite()).collect();
        let corners = || triangles.iter().flat_map(|sheet| sheet.triangle.corners);
        let slack = JOINED * corners().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let boxes: Vec<Aabb> = triangles.iter().map(|sheet| sheet.bounds(slack)).collect();
        let textures = materials.iter().flat_map(|m| [&m.textures.reflectance, &m.textures.emission]);
        let mut sums = HashMap::new();
        for texture in textures.flatten() {
            sums.entry(Arc::as_ptr(texture).addr()).or_insert_with(|| Sums::new(texture));
        }
        Self { materials, tree: BoxTree::new(&boxes), triangles, sums, slack }
    }

    /// The factors on the reflectance and emission of a planar convex polygon: averages over it.
    pub fn tint(&self, corners: &[DVec3], normal: DVec3, material: MaterialId) -> (Rgb, Rgb) {
        let mut shares = self.shares(corners, normal, material);
        let nearest = shares.iter().map(|share| share.distance).fold(f64::INFINITY, f64::min);
        shares.retain(|share| share.distance <= nearest + self.slack);
        let textures = &self.materials[material.index()].textures;
        let (mut covered, mut reflectance, mut emission) = (0.0, Rgb::BLACK, Rgb::BLACK);
        for Share { sheet, piece, .. } in &shares {
            let (area, middle) = area_and_middle(piece);
            // Polygons without an area beyond rounding have a colour too.
            let area = area.max(f64::MIN_POSITIVE);
            let tint = |texture: &Option<Arc<Texture>>, places: Option<[DVec2; 3]>| {
                let (Some(texture), Some(places)) = (texture, places) else { return Rgb::WHITE };
                self.sums[&Arc::as_ptr(texture).addr()].mean(piece, |p| sheet.at(p, places))
            };
            let colour = sheet.colour(middle);
            let painted = tint(&textures.reflectance, sheet.triangle.reflectance_at);
            let shining = tint(&textures.emission, sheet.triangle.emission_at);
            covered += area;
            for c in 0..3 {
                reflectance[c] += area * (painted[c] * colour[c]);
                emission[c] += area * shining[c];
            }
        }
        // Parts that no triangle covers are not tinted, except gaps beside a bent quad.
        let area = area_and_middle(corners).0;
        let plain = if area - covered > BENT * area { area - covered } else { 0.0 };
        let average = |sums: Rgb| sums.map(|sum| ((sum + plain) / (covered + plain)).clamp(0.0, 1.0));
        if shares.is_empty() { (Rgb::WHITE, Rgb::WHITE) } else { (average(reflectance), average(emission)) }
    }

    fn shares(&self, corners: &[DVec3], normal: DVec3, material: MaterialId) -> Vec<Share<'_>> {
        let either_side = self.materials[material.index()].double_sided;
        let (middle, mut shares) = (area_and_middle(corners).1, Vec::new());
        for sheet in self.near(corners) {
            let facing = sheet.normal.dot(normal);
            let fits = facing > SAME_SIDE || (either_side && facing < -SAME_SIDE);
            let distance = sheet.normal.dot(middle - sheet.triangle.corners[0]).abs();
            if sheet.triangle.material == material
                && fits
                && distance <= sheet.slack(self.slack)
                && let Some(piece) = sheet.over(corners)
            {
                shares.push(Share { sheet, piece, distance });
            }
        }
        shares
    }

    fn near(&self, corners: &[DVec3]) -> Vec<&Sheet<'_>> {
        self.tree.meeting(Aabb::around(corners)).into_iter().map(|i| &self.triangles[i as usize]).collect()
    }
}

impl<'a> Sheet<'a> {
    fn new(triangle: &'a TexturedTriangle) -> Self {
        let [a, b, c] = triangle.corners;
        let across = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        Self { triangle, across, normal: across.normalize(), longest }
    }

    fn slack(&self, joined: f64) -> f64 {
        joined + BENT * self.longest
    }

    fn bounds(&self, joined: f64) -> Aabb {
        Aabb::around(self.triangle.corners).grown(self.slack(joined))
    }

    /// The part of a polygon over the triangle.
    fn over(&self, corners: &[DVec3]) -> Option<Polygon> {
        let mut rest = Polygon::from_slice(corners);
        for side in 0..3 {
            let (from, to) = (self.triangle.corners[side], self.triangle.corners[(side + 1) % 3]);
            let inwards = self.normal.cross(to - from);
            match clip(&rest, |p| inwards.dot(p - from)) {
                Clipped::All => {}
                Clipped::None => return None,
                Clipped::Piece(piece) => rest = piece,
            }
        }
        Some(rest)
    }

    /// Barycentric coordinates of a point.
    fn weights(&self, p: DVec3) -> [f64; 3] {
        let [a, b, c] = self.triangle.corners;
        let share = |u: DVec3, v: DVec3| u.cross(v).dot(self.across) / self.across.length_squared();
        let (second, third) = (share(p - a, c - a), share(b - a, p - a));
        [1.0 - second - third, second, third]
    }

    /// By differences, so that coincident corners, and corners on one line along the image, map exactly.
    fn at(&self, p: DVec3, [a, b, c]: [DVec2; 3]) -> DVec2 {
        let [_, second, third] = self.weights(p);
        a + (b - a) * second + (c - a) * third
    }

    fn colour(&self, p: DVec3) -> Rgb {
        let (weights, colours) = (self.weights(p), &self.triangle.colours);
        Rgb::from_fn(|c| (0..3).map(|corner| weights[corner] * colours[corner][c]).sum())
    }
}

/// Area and centre of area of a planar convex polygon.
fn area_and_middle(corners: &[DVec3]) -> (f64, DVec3) {
    let from = corners[0];
    let (mut area, mut moment) = (0.0, DVec3::ZERO);
    for edge in corners.windows(2).skip(1) {
        let triangle = (edge[0] - from).cross(edge[1] - from).length() / 2.0;
        area += triangle;
        moment += triangle * ((edge[0] - from) + (edge[1] - from)) / 3.0;
    }
    (area, if area > 0.0 { from + moment / area } else { from })
}
