//! Pieces of surface that are no unknowns, such as texels: what the rays of each end on, and which of them something covers.
//!
//! All pieces of a chart have the same rays, only from other places. The errors of neighbours are then alike, and light that
//! changes slowly from one to the next has no grain.

use super::hemisphere::{Emitters, frame};
use super::samples::Samples;
use super::scenery::{Landing, Scenery};
use super::surfaces::End;
use super::tracing::tallied;
use super::wide_tree::Ray;
use glam::DVec3;

/// What the rays of a piece of surface end on.
#[derive(Debug, Clone, Default)]
pub struct AreaRow {
    /// Columns, and rays that end on each.
    pub counts: Vec<(u32, u16)>,
    /// Rays that nothing covers.
    pub rays: u32,
    /// The mean of 1/t over these rays, 1/m in the coordinates of the instance; rays that leave the scene count as 0.
    pub nearness: f64,
}

/// The column of a ray that ends here; none where it ends on black.
pub type ColumnOf<'a> = dyn Fn(&Ray, Option<Landing>) -> Option<u32> + Sync + 'a;

/// Traces the rays of a piece of an instance, in its coordinates. `number` chooses the rays.
pub fn area_row(
    scenery: &Scenery,
    samples: &Samples,
    instance: usize,
    (area, number): (&Emitters, u32),
    column: &ColumnOf,
) -> AreaRow {
    pulp::Arch::new().dispatch(Traced { scenery, samples, instance, area, number, column })
}

struct Traced<'a> {
    scenery: &'a Scenery,
    samples: &'a Samples,
    instance: usize,
    area: &'a Emitters,
    number: u32,
    column: &'a ColumnOf<'a>,
}

impl pulp::NullaryFnOnce for Traced<'_> {
    type Output = AreaRow;

    #[inline(always)]
    fn call(self) -> AreaRow {
        let (mut rays, mut ends) = (vec![], vec![]);
        self.area.rays(self.samples, self.number, &mut rays);
        let mut row = AreaRow::default();
        for ray in &rays {
            let landing = self.scenery.land(self.instance, ray, 0.0);
            if matches!(landing, Some(Landing { end: End::Covered, .. })) {
                continue;
            }
            row.rays += 1;
            row.nearness += landing.map_or(0.0, |landing| 1.0 / landing.t.max(f64::MIN_POSITIVE));
            ends.extend((self.column)(ray, landing));
        }
        row.nearness /= f64::from(row.rays.max(1));
        row.counts = tallied(&mut ends);
        row
    }
}

/// Cosines of the angles between the normal and the rays that find out what covers a place.
const STEEP: [f64; 2] = [0.9, 0.45];

/// Rays at each of these angles.
const AROUND: usize = 4;

/// What covers places on a surface of an instance, in its coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Cover<'a> {
    /// All surfaces.
    pub scenery: &'a Scenery,
    /// The instance.
    pub instance: usize,
    /// A black back up to this distance covers a place, metres.
    pub near: f64,
    /// Anything that is straight ahead up to this distance covers a place, metres.
    pub gap: f64,
}

impl Cover<'_> {
    /// Whether something touches a place with this normal, or at least half of what is seen from there are insides of solids
    /// and near black backs.
    pub fn is_covered(self, place: DVec3, normal: DVec3) -> bool {
        let all = STEEP.len() * AROUND;
        let hidden = (0..all).filter(|k| self.hides(place, slanted(normal, STEEP[k / AROUND], k % AROUND)));
        self.touches(place, normal) || 2 * hidden.count() >= all
    }

    /// Whether that is possible, from a look straight ahead and one that is slanted towards `inside`: where the border of what
    /// covers a piece cuts off this place, the border is there.
    pub fn may_be_covered(self, place: DVec3, normal: DVec3, inside: DVec3) -> bool {
        let across = (inside - place).reject_from_normalized(normal).normalize_or_zero();
        let direction = match across == DVec3::ZERO {
            true => slanted(normal, STEEP[1], 0),
            false => normal * STEEP[1] + across * (1.0 - STEEP[1] * STEEP[1]).sqrt(),
        };
        self.touches(place, normal) || self.hides(place, direction)
    }

    fn hides(self, place: DVec3, direction: DVec3) -> bool {
        let landing = self.scenery.land(self.instance, &Ray { origin: place, direction }, self.near);
        matches!(landing, Some(Landing { end: End::Covered, .. }))
    }

    fn touches(self, place: DVec3, normal: DVec3) -> bool {
        let landing = self.scenery.land(self.instance, &Ray { origin: place, direction: normal }, self.near);
        landing.is_some_and(|landing| landing.end == End::Covered || landing.t <= self.gap)
    }
}

/// A unit vector with this cosine to the normal, in one of four directions around it, which are not those of axes: of a box that
/// is sunk into a floor, as many look up as down.
fn slanted(normal: DVec3, cosine: f64, number: usize) -> DVec3 {
    let [x, y, z] = frame(normal);
    let sine = (1.0 - cosine * cosine).sqrt();
    let across = [x + y, y - x, -x - y, x - y][number % AROUND] * std::f64::consts::FRAC_1_SQRT_2;
    z * cosine + across * sine
}
