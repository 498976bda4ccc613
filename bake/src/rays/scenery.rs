//! Placed parts for rays: a tree of the boxes around instances, above the trees of their parts.
//!
//! A ray is defined in the coordinates of the instance that it leaves. It meets its own part there, so that what it hits is what
//! it hits when the part is alone, to the bit; other instances are met in their own coordinates. A ray that starts and ends in
//! the box of its part can meet only instances whose boxes meet that box, which are few.

use super::face_tree::FaceHit;
use super::plates::Plate;
use super::surfaces::{End, Surfaces};
use super::wide_tree::{Ray, Ray32, Visitor, WideTree};
use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::tolerance::SAME_HIT;
use glam::DAffine3;
use std::sync::Arc;

/// Instances and a tree over them.
#[derive(Debug)]
pub struct Scenery {
    places: Vec<Place>,
    /// All instances that have faces, in the coordinates of the scene.
    all: Group,
    /// The same boxes, to ask which meet another.
    tree: BoxTree,
    /// By instance: the others that stand in its box or touch it.
    near: Vec<Near>,
}

/// An instance.
#[derive(Debug)]
struct Place {
    surfaces: Arc<Surfaces>,
    placement: DAffine3,
    inverse: DAffine3,
    bounds: Aabb,
}

/// Some instances.
#[derive(Debug)]
struct Group {
    instances: Vec<u32>,
    /// A tree over their boxes.
    tree: WideTree,
}

/// The instances that a ray inside the box of a part may meet, in the coordinates of that part.
#[derive(Debug)]
struct Near {
    /// The box.
    bounds: Aabb,
    others: Group,
}

/// How much larger the box is than the part, in its diagonals: rays start in front of elements.
const AROUND: f64 = 1e-5;

/// What a ray ends on, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landing {
    /// The instance.
    pub instance: usize,
    /// What it is.
    pub end: End,
    /// Where on the ray.
    pub t: f64,
}

impl Scenery {
    /// These surfaces at their placements, which are similarities.
    pub fn new(placed: impl IntoIterator<Item = (Arc<Surfaces>, DAffine3)>) -> Self {
        let place = |(surfaces, placement): (Arc<Surfaces>, DAffine3)| {
            let around = surfaces.tree.bounds();
            let corners = around.corners().into_iter().map(|corner| placement.transform_point3(corner));
            let mut bounds = around;
            if !around.is_empty() {
                bounds = Aabb::around(corners);
                // What rounding adds where a flat box is placed.
                bounds = bounds.grown(1e-9 * (bounds.low.abs().max(bounds.high.abs())).max_element());
            }
            Place { surfaces, placement, inverse: placement.inverse(), bounds }
        };
        let places: Vec<Place> = placed.into_iter().map(place).collect();
        let instances: Vec<u32> =
            (0..places.len() as u32).filter(|&number| !places[number as usize].bounds.is_empty()).collect();
        let boxes: Vec<Aabb> = instances.iter().map(|&number| places[number as usize].bounds).collect();
        let (all, tree) = (Group::new(instances, &boxes), BoxTree::new(&boxes));
        let near = (0..places.len()).map(|own| Near::new(&places, own, &all, &tree)).collect();
        Self { places, all, tree, near }
    }

    /// The surfaces of an instance.
    pub fn surfaces_of(&self, instance: usize) -> &Surfaces {
        &self.places[instance].surfaces
    }

    /// The surfaces of an instance, to be placed elsewhere too.
    pub fn shared_surfaces_of(&self, instance: usize) -> Arc<Surfaces> {
        Arc::clone(&self.places[instance].surfaces)
    }

    /// Number of unknowns of each instance.
    #[cfg(test)]
    pub fn unknowns(&self) -> Vec<usize> {
        self.places.iter().map(|place| place.surfaces.unknowns()).collect()
    }

    /// The placement of an instance.
    pub fn placement_of(&self, instance: usize) -> DAffine3 {
        self.places[instance].placement
    }

    /// The box around everything.
    pub fn bounds(&self) -> Aabb {
        self.places.iter().map(|place| place.bounds).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The box around an instance.
    pub fn bounds_of(&self, instance: usize) -> Aabb {
        self.places[instance].bounds
    }

    /// Boxes around the other instances that meet `around`, both in the coordinates of an instance.
    pub fn boxes_near(&self, instance: usize, around: Aabb) -> Vec<Aabb> {
        let Place { placement, inverse, .. } = &self.places[instance];
        let met = self.tree.meeting(moved(around, placement)).into_iter();
        let others = met.map(|k| self.all.instances[k as usize] as usize).filter(|&other| other != instance);
        others.map(|other| moved(self.places[other].bounds, inverse)).collect()
    }

    /// What a ray of an instance ends on; none if it leaves the scene. `ray`: in the coordinates of the instance. `near`: as for
    /// [`Surfaces::end`].
    #[inline(always)]
    pub fn land(&self, instance: usize, ray: &Ray, near: f64) -> Option<Landing> {
        let own = self.places[instance].surfaces.tree.first(ray, f64::INFINITY);
        self.land_after(instance, ray, own, near)
    }

    /// The same, for a ray of which it is known where it first meets its own part.
    #[inline(always)]
    pub fn land_after(&self, instance: usize, ray: &Ray, own: Option<FaceHit>, near: f64) -> Option<Landing> {
        let nearest = own.map(|hit| (instance, hit, *ray));
        let most = own.map_or(f64::INFINITY, |hit| hit.t);
        let (number, hit, there) = self.others::<false>(instance, ray, most, nearest)?;
        let end = self.places[number].surfaces.end(&there, &hit, near);
        Some(Landing { instance: number, end, t: hit.t })
    }

    /// What a ray in scene coordinates ends on; none if it leaves the scene.
    pub fn land_from(&self, ray: &Ray) -> Option<Landing> {
        let mut search = Search::<false> { scenery: self, own: None, ray, among: &self.all, nearest: None };
        self.all.tree.along(ray, f64::INFINITY, &mut search);
        let (instance, hit, there) = search.nearest?;
        let end = self.places[instance].surfaces.end(&there, &hit, 0.0);
        Some(Landing { instance, end, t: hit.t })
    }

    /// Whether anything stands between the start of a ray, in scene coordinates, and the place at t = 1.
    #[inline(always)]
    pub fn is_between(&self, ray: &Ray) -> bool {
        let mut search = Search::<true> { scenery: self, own: None, ray, among: &self.all, nearest: None };
        self.all.tree.along(ray, 1.0, &mut search);
        search.nearest.is_some()
    }

    /// The same for a ray in the coordinates of an instance.
    #[inline(always)]
    pub fn is_blocked(&self, instance: usize, ray: &Ray) -> bool {
        self.places[instance].surfaces.tree.is_met(ray, 1.0)
            || self.others::<true>(instance, ray, 1.0, None).is_some()
    }

    /// Plates in the coordinates of an instance, all that meet `around` among them; none if they are in more than `most` leaves
    /// of the tree of a part.
    pub fn plates_in(&self, instance: usize, around: Aabb, most: usize) -> Option<Vec<Plate>> {
        let Place { surfaces, placement, inverse, .. } = &self.places[instance];
        let mut plates = surfaces.tree.plates_in(&around, most)?;
        let in_scene = moved(around, placement);
        for other in self.tree.meeting(in_scene) {
            let other = self.all.instances[other as usize] as usize;
            let there = &self.places[other];
            if other != instance && there.bounds.meets(&in_scene) {
                let to_here = *inverse * there.placement;
                let found = there.surfaces.tree.plates_in(&moved(in_scene, &there.inverse), most)?;
                plates.extend(found.into_iter().map(|plate| plate.moved(&to_here)));
            }
        }
        Some(plates)
    }

    /// The nearest hit with t up to `most` in the other instances, or any; `nearest` if there is none.
    #[inline(always)]
    fn others<const ANY: bool>(
        &self,
        instance: usize,
        ray: &Ray,
        most: f64,
        nearest: Option<Nearest>,
    ) -> Option<Nearest> {
        let near = &self.near[instance];
        let own = Some(instance);
        let mut search = Search::<ANY> { scenery: self, own, ray, among: &near.others, nearest };
        if most.is_finite() && near.bounds.holds(ray.origin) && near.bounds.holds(ray.at(most)) {
            near.others.tree.along(ray, most, &mut search);
        } else if self.places.len() > 1 {
            search.among = &self.all;
            self.all.tree.along(&self.in_scene(instance, ray), most, &mut search);
        }
        search.nearest
    }

    /// A ray of an instance in the coordinates of the scene.
    #[inline(always)]
    fn in_scene(&self, instance: usize, ray: &Ray) -> Ray {
        let here = &self.places[instance].placement;
        Ray { origin: here.transform_point3(ray.origin), direction: here.transform_vector3(ray.direction) }
    }
}

impl Group {
    /// These instances, which have these boxes.
    fn new(instances: Vec<u32>, boxes: &[Aabb]) -> Self {
        Self { instances, tree: WideTree::new(boxes, 1) }
    }
}

impl Near {
    /// What is near an instance. `tree`: the boxes of `all`.
    fn new(places: &[Place], own: usize, all: &Group, tree: &BoxTree) -> Self {
        let Place { surfaces, placement, inverse, .. } = &places[own];
        let bounds = surfaces.tree.bounds();
        if bounds.is_empty() {
            return Self { bounds, others: Group::new(vec![], &[]) };
        }
        let bounds = bounds.grown(AROUND * bounds.diagonal());
        let met = tree.meeting(moved(bounds, placement)).into_iter().map(|k| all.instances[k as usize]);
        let instances: Vec<u32> = met.filter(|&number| number as usize != own).collect();
        let boxes: Vec<Aabb> =
            instances.iter().map(|&number| moved(places[number as usize].bounds, inverse)).collect();
        Self { bounds, others: Group::new(instances, &boxes) }
    }
}

/// The box around a moved one.
pub(super) fn moved(bounds: Aabb, by: &DAffine3) -> Aabb {
    Aabb::around(bounds.corners().into_iter().map(|corner| by.transform_point3(corner)))
}

/// A hit: the instance, the face, and the ray in the coordinates of that instance.
type Nearest = (usize, FaceHit, Ray);

/// Looks for the nearest hit in other instances, or for any.
struct Search<'a, const ANY: bool> {
    scenery: &'a Scenery,
    /// The instance that the ray leaves, if that is not looked at.
    own: Option<usize>,
    /// In the coordinates of that instance, or of the scene.
    ray: &'a Ray,
    /// Where to look.
    among: &'a Group,
    nearest: Option<Nearest>,
}

impl<const ANY: bool> Visitor for Search<'_, ANY> {
    #[inline(always)]
    fn leaf(&mut self, leaf: usize, _: &Ray32, _: f32, most: f64) -> f64 {
        let Group { instances, tree } = self.among;
        let number = instances[tree.leaves()[leaf][0] as usize] as usize;
        if Some(number) == self.own {
            return most;
        }
        let Place { surfaces, inverse, .. } = &self.scenery.places[number];
        let Ray { origin, direction } =
            self.own.map_or(*self.ray, |own| self.scenery.in_scene(own, self.ray));
        let ray =
            Ray { origin: inverse.transform_point3(origin), direction: inverse.transform_vector3(direction) };
        if ANY {
            if !surfaces.tree.is_met(&ray, most) {
                return most;
            }
            self.nearest = Some((number, FaceHit { t: 0.0, face: 0, front: false }, ray));
            return -1.0;
        }
        let Some(hit) = surfaces.tree.first(&ray, most * (1.0 + 2.0 * SAME_HIT)) else { return most };
        if self.nearest.as_ref().is_none_or(|nearest| is_before((number, &hit), nearest)) {
            self.nearest = Some((number, hit, ray));
        }
        self.nearest.as_ref().map_or(most, |(_, hit, _)| hit.t)
    }
}

/// Whether a hit comes before the nearest so far; of hits at the same place as [`FaceHit::is_before`] says, by instance first.
#[inline(always)]
fn is_before((instance, hit): (usize, &FaceHit), nearest: &Nearest) -> bool {
    let (other, than, _) = nearest;
    let is_tie = (hit.t - than.t).abs() <= SAME_HIT * than.t;
    if !is_tie {
        return hit.t < than.t;
    }
    if hit.front == than.front { instance < *other } else { hit.front }
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{aim, part, point, room, similarity, soup};
    use super::*;
    use equilux_formats::Face;
    use glam::DVec3;
    use proptest::prelude::*;
    use proptest::sample::Index;

    /// The nearest of the first hits in each instance, found by looking at every face.
    fn nearest_of_all(scenery: &Scenery, instance: usize, ray: &Ray) -> Option<Landing> {
        let scene = &scenery.places[instance].placement;
        let hits = scenery.places.iter().enumerate().filter_map(|(number, place)| {
            let mut there = *ray;
            if number != instance {
                there.origin = place.inverse.transform_point3(scene.transform_point3(ray.origin));
                there.direction = place.inverse.transform_vector3(scene.transform_vector3(ray.direction));
            }
            let hit = place.surfaces.tree.first_of_all(&there, f64::INFINITY)?;
            Some((number, hit, there))
        });
        let nearest = hits.reduce(|best, next| if is_before((next.0, &next.1), &best) { next } else { best });
        let (number, hit, there) = nearest?;
        Some(Landing {
            instance: number,
            end: scenery.places[number].surfaces.end(&there, &hit, 0.0),
            t: hit.t,
        })
    }

    proptest! {
        #[test]
        fn a_ray_lands_on_the_nearest_of_all_instances(
            parts in prop::collection::vec(prop_oneof![4 => soup(), 4 => room(), 1 => Just(vec![])], 1..4),
            placed in prop::collection::vec((any::<Index>(), similarity()), 1..7),
            (from, origin, to, at) in (any::<Index>(), point(), any::<Index>(), aim()),
        ) {
            let surface = |faces: &Vec<Face>| Arc::new(Surfaces::new(&part(faces)));
            let surfaces: Vec<Arc<Surfaces>> = parts.iter().map(surface).collect();
            let of = |index: &Index| index.index(parts.len());
            let scenery = Scenery::new(placed.iter().map(|(part, placement)| (surfaces[of(part)].clone(), *placement)));
            let [from, to] = [from, to].map(|index| index.index(placed.len()));
            let target = &parts[of(&placed[to].0)];
            let target = if target.is_empty() { DVec3::ZERO } else { at.at(target) };
            let here = |p: DVec3| scenery.places[from].inverse.transform_point3(p);
            let origin = here(origin * 4.0);
            let ray = Ray { origin, direction: here(placed[to].1.transform_point3(target)) - origin };
            let landing = scenery.land(from, &ray, 0.0);
            prop_assert_eq!(landing, nearest_of_all(&scenery, from, &ray));
            // A thousandth before and after the hit: well clear of what counts as the same place.
            let most = landing.map_or(1e3, |landing| landing.t);
            let Ray { origin, direction } = scenery.in_scene(from, &ray);
            let is_between = |t: f64| scenery.is_between(&Ray { origin, direction: direction * t });
            prop_assert_eq!(is_between(most * 1.001), landing.is_some());
            prop_assert_eq!(is_between(most * 0.999), false);
            let is_blocked = |t: f64| scenery.is_blocked(from, &Ray { direction: ray.direction * t, ..ray });
            prop_assert_eq!(is_blocked(most * 1.001), landing.is_some());
            prop_assert_eq!(is_blocked(most * 0.999), false);
        }
    }
}
