//! Lights without extent: points, spots and parallel light. The irradiance of a convex polygon is exact: every
//! occluder hides a pyramid from the light, the remainder of the polygon outside all pyramids is lit, and a point of
//! intensity I sends I·Ω into a polygon of solid angle Ω (van Oosterom & Strackee 1983).

use crate::gather::cone::Cone;
use crate::gather::receiver::receiver;
use crate::gather::surface_piece::{SurfacePiece, centre};
use equilux_bake::form_factor::plain::hidden_pyramid;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::geometry::outline::Plane;
use equilux_bake::geometry::polygon::{Polygon, Pyramid};
use equilux_bake::geometry::shaft::Shaft;
use equilux_bake::geometry::solid_angle::solid_angle;
use equilux_bake::world::World;
use equilux_formats::{Element, FaceId, LightKind, PunctualLight, Rgb};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// A light without extent.
#[derive(Debug, Clone)]
pub struct Lamp {
    /// Its name.
    pub name: String,
    /// Maximum power that can arrive at the scene, W.
    pub power: Rgb,
    /// Position, metres; parallel light is placed very far away.
    pub position: DVec3,
    /// Intensity, W/sr, linear RGB.
    pub intensity: Rgb,
    /// The cone and its direction, for a spot.
    pub cone: Option<Cone>,
}

/// Distance of parallel light, in sizes of the scene: directions differ by less than 1e-6.
const PARALLEL_LIGHT_DISTANCE: f64 = 1e6;

impl Lamp {
    /// The lamp for a light of a scene around `centre` with this `size`, metres.
    pub fn of(light: &PunctualLight, centre: DVec3, size: f64) -> Self {
        let far = PARALLEL_LIGHT_DISTANCE * size;
        let (position, intensity) = match light.kind {
            LightKind::Directional => {
                (centre - light.direction * far, light.intensity.map(|lux| lux * far * far))
            }
            LightKind::Point | LightKind::Spot { .. } => (light.position, light.intensity),
        };
        let cone = match light.kind {
            LightKind::Spot { inner, outer } => Some(Cone::new(light.direction, inner, outer)),
            LightKind::Point | LightKind::Directional => None,
        };
        // The solid angle of a sphere around the scene.
        let distance = (position - centre).length();
        let angle = if distance <= size { 4.0 * PI } else { PI * (size / distance).powi(2) };
        Self { name: light.name.clone(), power: intensity * angle, position, intensity, cone }
    }

    /// The average irradiance of pieces, W/m².
    pub fn irradiance(&self, world: &World, pieces: &[SurfacePiece]) -> Vec<Rgb> {
        pieces.par_iter().map(|piece| self.over(world, piece)).collect()
    }

    /// The irradiance at a point, W/m².
    pub fn at(&self, world: &World, point: &Element) -> Rgb {
        let arriving = self.unoccluded(point.centroid, point.normal);
        if arriving == Rgb::BLACK {
            return arriving;
        }
        let to = point.centroid - self.position;
        let plane = Plane { normal: point.normal, point: point.centroid };
        let mut hidden = false;
        self.pyramids(world, &[point.centroid], plane, point.face, |pyramid| {
            hidden |= pyramid.corners_inside(&[to]) == 1;
        });
        if hidden { Rgb::BLACK } else { arriving }
    }

    /// The irradiance at a place with this normal, W/m², nothing being in the way.
    pub fn unoccluded(&self, place: DVec3, normal: DVec3) -> Rgb {
        self.intensity * self.arriving(place, normal)
    }

    /// The same for a lamp of unit intensity, 1/m².
    pub fn arriving(&self, place: DVec3, normal: DVec3) -> f64 {
        let to = place - self.position;
        let cosine = -normal.dot(to) / to.length();
        if cosine.is_nan() || cosine <= 0.0 {
            return 0.0;
        }
        let sent = self.cone.as_ref().map_or(1.0, |cone| cone.falloff(to));
        sent * cosine / to.length_squared()
    }

    fn over(&self, world: &World, piece: &SurfacePiece) -> Rgb {
        let dark = Rgb::BLACK;
        if piece.normal.dot(self.position - piece.corners[0]) <= 0.0 {
            return dark;
        }
        let (middle, area) = centre(piece.corners, piece.normal);
        let Some(face) = piece.plane.face_at(middle) else { return dark };
        if area == 0.0 {
            return self.at(world, &receiver(middle, piece.normal, face));
        }
        let mut lit: Vec<Polygon> = vec![piece.corners.iter().map(|&p| p - self.position).collect()];
        let plane = Plane { normal: piece.normal, point: piece.corners[0] };
        self.pyramids(world, piece.corners, plane, face, |pyramid| {
            let mut outside = Vec::with_capacity(lit.len());
            lit.drain(..).for_each(|left| pyramid.subtract_from(left, &mut outside));
            lit = outside;
        });
        let sent: f64 = lit.iter().map(|polygon| self.share(polygon, piece.normal)).sum();
        self.intensity.map(|i| i * sent / area)
    }

    /// Call `visit` with the pyramid that each face hides of `plane`, for all faces that may occlude the polygon.
    /// `own`: the polygon's face.
    fn pyramids(
        &self,
        world: &World,
        polygon: &[DVec3],
        plane: Plane,
        own: FaceId,
        mut visit: impl FnMut(Pyramid),
    ) {
        let mut shaft = Shaft::between(Aabb::around([self.position]), Aabb::around(polygon));
        shaft.bound(plane.point, -plane.normal);
        world.occluders().any(
            |bounds| shaft.misses_box(bounds),
            |occluder| {
                let others = occluder.faces.iter().filter(|&&face| !world.coplanar(own, FaceId(face)));
                others
                    .filter_map(|&face| hidden_pyramid(self.position, &world.faces[face as usize], plane))
                    .for_each(&mut visit);
                false
            },
        );
    }

    /// ∫ I(ω)/I dω over a polygon, relative to the light's position, sr.
    fn share(&self, polygon: &[DVec3], normal: DVec3) -> f64 {
        self.cone.as_ref().map_or_else(|| solid_angle(polygon).abs(), |cone| cone.share(polygon, normal))
    }
}
