//! Finds two-sided closed shells without light inside: their inner sides are dark and never seen, so they get no elements.
//!
//! Modelling programs make materials two-sided by default. Half of the elements of a crate then lie inside it. A shell
//! keeps its inner sides if light or a camera may be inside: it emits itself, or a lamp, an emitting surface or a
//! camera is not clearly outside of it in one of its instances. Reflecting surfaces do not matter: inside a closed
//! opaque shell they are as dark as the shell.

use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::shells::{Shell, closed_shells, winding_number};
use crate::geometry::tolerance::IN_FRONT;
use equilux_formats::{Instance, LightKind, Part, Scene, Surface};
use glam::DVec3;

/// How far corners of emitting surfaces are moved towards the middle, so that a corner in the corner of a room is
/// inside the room.
const DRAWN_IN: f64 = 0.01;

/// Winding numbers below this are clearly outside; on an edge of a box it is ¼, at its corner ⅛.
const OUTSIDE: f64 = 0.01;

/// Hides the backs of all surfaces of shells without light inside; inward-facing surfaces are flipped first. Returns
/// the number of shells.
pub(super) fn hide_backs(scene: &mut Scene) -> usize {
    let shells: Vec<Vec<Shell>> = scene.parts.iter().map(two_sided_shells).collect();
    if shells.iter().all(Vec::is_empty) {
        return 0;
    }
    let sources = Sources::of(scene);
    let mut hidden = 0;
    for (number, shells) in shells.iter().enumerate() {
        let own = |(_, instance): &(usize, &Instance)| instance.part.index() == number;
        let places: Vec<(usize, &Instance)> = scene.instances.iter().enumerate().filter(own).collect();
        for shell in shells {
            let part = &scene.parts[number];
            if shines(shell, part, &places) || places.iter().any(|place| sources.any_in(shell, part, *place))
            {
                continue;
            }
            hidden += 1;
            let Part { surfaces, materials, .. } = &mut scene.parts[number];
            for (&surface, &inward) in shell.polygons.iter().zip(&shell.inward) {
                let surface = &mut surfaces[surface as usize];
                if materials[surface.material.index()].double_sided {
                    let outward = if inward { surface.flipped() } else { *surface };
                    *surface = Surface { back_hidden: true, ..outward };
                }
            }
        }
    }
    hidden
}

/// The shells of a part with two-sided surfaces, and without one-sided ones that face inwards.
fn two_sided_shells(part: &Part) -> Vec<Shell> {
    if !part.materials.iter().any(|material| material.double_sided) {
        return vec![];
    }
    let is_two_sided = |surface: usize| part.is_two_sided(&part.surfaces[surface]);
    let polygons: Vec<&[DVec3]> = part.surfaces.iter().map(|s| s.corners.as_slice()).collect();
    let mut shells = closed_shells(&polygons, is_two_sided);
    shells.retain(|shell| {
        let members = || shell.polygons.iter().map(|&surface| surface as usize);
        let looks_in = |(surface, &inward): (usize, &bool)| inward && !is_two_sided(surface);
        members().any(is_two_sided) && !members().zip(&shell.inward).any(looks_in)
    });
    shells
}

/// Whether a shell's inner sides emit, in any of its instances.
fn shines(shell: &Shell, part: &Part, places: &[(usize, &Instance)]) -> bool {
    let materials = shell.polygons.iter().map(|&surface| part.surfaces[surface as usize].material);
    let mut two_sided = materials.filter(|material| part.materials[material.index()].double_sided);
    two_sided.any(|material| {
        let repainted = places.iter().flat_map(|(_, instance)| &instance.repainted);
        let here = repainted.filter(|new| new.material == material).map(|new| new.emission);
        here.chain([part.materials[material.index()].emission]).flatten().any(|e| e > 0.0)
    })
}

/// Lamps, emitting surfaces and cameras.
struct Sources {
    all: Vec<Source>,
    tree: BoxTree,
}

/// A point of a lamp, emitting surface or camera.
struct Source {
    /// Scene coordinates.
    point: DVec3,
    /// The normal of an emitting surface; zero for lamps and cameras.
    normal: DVec3,
    /// The instance and the surface of its part, unless it is a lamp or a camera.
    surface: Option<(usize, u32)>,
}

impl Sources {
    fn of(scene: &Scene) -> Self {
        let lamps = scene.lights.iter().filter(|light| light.kind != LightKind::Directional);
        let places = lamps.map(|light| light.position);
        let places = places.chain(scene.cameras.iter().map(|camera| camera.placement.translation));
        let mut all: Vec<Source> =
            places.map(|point| Source { point, normal: DVec3::ZERO, surface: None }).collect();
        for (number, instance) in scene.instances.iter().enumerate() {
            all.extend(shining(&scene.parts[instance.part.index()], number, instance));
        }
        let boxes: Vec<Aabb> = all.iter().map(|source| Aabb::around([source.point])).collect();
        Self { tree: BoxTree::new(&boxes), all }
    }

    /// Whether any source is not clearly outside a shell of a part with this placement.
    fn any_in(&self, shell: &Shell, part: &Part, (number, instance): (usize, &Instance)) -> bool {
        let outwards: Vec<Surface> = shell
            .polygons
            .iter()
            .zip(&shell.inward)
            .map(|(&surface, &inward)| {
                let surface = part.surfaces[surface as usize];
                if inward { surface.flipped() } else { surface }
            })
            .collect();
        let corners = outwards.iter().flat_map(|surface| surface.corners.as_slice());
        let bounds = Aabb::around(corners.map(|&corner| instance.placement.transform_point3(corner)));
        let step = IN_FRONT * bounds.diagonal();
        let to_part = instance.placement.inverse();
        let is_in = |source: &Source| {
            let own = source.surface.is_some_and(|(instance, surface)| {
                instance == number && shell.polygons.binary_search(&surface).is_ok()
            });
            let point = to_part.transform_point3(source.point + source.normal * step);
            !own && winding_number(point, outwards.iter().map(|s| s.corners.as_slice())) > OUTSIDE
        };
        self.tree.meeting(bounds.grown(step)).into_iter().any(|source| is_in(&self.all[source as usize]))
    }
}

/// Points of the emitting surfaces of an instance, near their corners and at their middles, for two-sided ones once for
/// each side.
fn shining<'a>(part: &'a Part, number: usize, instance: &'a Instance) -> impl Iterator<Item = Source> + 'a {
    let shines = move |surface: &Surface| {
        let repainted = instance.repainted.iter().find(|new| new.material == surface.material);
        let emission = part.materials[surface.material.index()].emission;
        repainted.map_or(emission, |new| new.emission).iter().any(|&e| e > 0.0)
    };
    let surfaces = part.surfaces.iter().enumerate().filter(move |(_, surface)| shines(surface));
    surfaces.flat_map(move |(at, surface)| {
        let placed = surface.placed(instance.placement);
        let middle = placed.corners.centroid();
        let points: Vec<DVec3> = placed
            .corners
            .as_slice()
            .iter()
            .map(|corner| corner.lerp(middle, DRAWN_IN))
            .chain([middle])
            .collect();
        let normal = placed.corners.double_area_vector().normalize();
        let back = part.is_two_sided(surface).then_some(-normal);
        let source = move |point, normal| Source { point, normal, surface: Some((number, at as u32)) };
        [Some(normal), back]
            .into_iter()
            .flatten()
            .flat_map(move |n| points.clone().into_iter().map(move |p| source(p, n)))
    })
}
