//! Form factors to sources from pieces of surface that are no unknowns, such as texels. All have the same places and shadow
//! rays, so that their shadows have no grain.

use super::{Effort, Hull, Neighbours, Rows, Source};
use crate::rays::hemisphere::Emitters;
use crate::rays::scenery::Scenery;
use crate::rays::wide_tree::Ray;
use glam::{DAffine3, DVec3};

/// The form factors from each of some neighbouring pieces of an instance, in its coordinates, to those of `sources` that it
/// sees, with their places among them. `number` chooses the places.
pub fn form_factors_of_areas(
    scenery: &Scenery,
    instance: usize,
    (areas, number): (&[&Emitters], u32),
    sources: &[(u32, &Source)],
    effort: Effort,
) -> Rows {
    let receivers = super::Receivers::Areas { areas, number };
    pulp::Arch::new().dispatch(Neighbours { scenery, instance, receivers, sources, effort })
}

/// Those of some sources that pieces of an instance within the hull of `areas` may see.
pub fn in_view<'a>(
    scenery: &Scenery,
    instance: usize,
    areas: impl Iterator<Item = &'a Emitters> + Clone,
    sources: &[(u32, &Source)],
) -> Vec<u32> {
    let here = Hull::around(areas);
    let to_here: DAffine3 = scenery.placement_of(instance).inverse();
    let may_see = |(_, source): &&(u32, &Source)| {
        let moved = source.moved(to_here);
        let hull = Hull::around(std::iter::once(&moved.places));
        !matches!(super::between(scenery, instance, &here, &hull), super::Between::Hidden)
    };
    sources.iter().filter(may_see).map(|&(number, _)| number).collect()
}

/// Places on a piece from which a point is looked at: at first, and where these do not agree.
const POINT_PLACES: [u32; 2] = [16, 64];

/// The mean over a piece of an instance of what a point sends there. `towards`: the point, in coordinates of the instance.
/// `arriving`: of a place and a normal in these coordinates, where nothing is in the way.
pub fn mean_of_point(
    scenery: &Scenery,
    instance: usize,
    (area, number): (&Emitters, u32),
    towards: DVec3,
    arriving: impl Fn(DVec3, DVec3) -> f64,
) -> f64 {
    let look = |k: u32| {
        let [u, v, ..] = super::places(k, super::sobol::hash(number));
        let (place, normal) = area.place(u, v);
        let sent = arriving(place, normal);
        let is_lit =
            sent > 0.0 && !scenery.is_blocked(instance, &Ray { origin: place, direction: towards - place });
        (if is_lit { sent } else { 0.0 }, is_lit)
    };
    let [few, all] = POINT_PLACES;
    let first: Vec<(f64, bool)> = (0..few).map(look).collect();
    let lit = first.iter().filter(|(_, is_lit)| *is_lit).count();
    let sum: f64 = first.iter().map(|(light, _)| light).sum();
    if lit == 0 || lit == first.len() {
        return sum / f64::from(few);
    }
    (sum + (few..all).map(|k| look(k).0).sum::<f64>()) / f64::from(all)
}
