//! The mean direction of arriving light. Input: pieces of surface. Output: for each piece the mean direction of its
//! light, weighted by the luminance of the irradiance from each direction.

use crate::gather::Gather;
use crate::gather::receiver::receiver;
use crate::gather::surface_piece::{SurfacePiece, centre};
use equilux_bake::treecode::{EXACT, Resolution};
use equilux_formats::{Element, Rgb};
use glam::DVec3;

impl Gather {
    /// Σ_j Y_j ω_j / Σ_j Y_j at the centre of each piece, with the luminance Y_j of F_ij B_j and the direction ω_j to
    /// the centre of sender j; zero where there is no light.
    pub fn directions(&self, pieces: &[SurfacePiece]) -> Vec<DVec3> {
        let points: Vec<Option<Element>> = pieces.iter().map(middle).collect();
        let known: Vec<Element> = points.iter().flatten().copied().collect();
        let mut sums = vec![(DVec3::ZERO, 0.0); known.len()];
        self.add_senders(&known, &self.glowing, &self.shining, EXACT, &mut sums);
        self.add_senders(&known, self.sky.as_slice(), &self.shining, EXACT, &mut sums);
        self.add_senders(&known, &self.scene, &self.reflected, self.resolution, &mut sums);
        let mut sums = sums.into_iter();
        let mut sums: Vec<(DVec3, f64)> =
            points.iter().map(|p| p.and_then(|_| sums.next()).unwrap_or_default()).collect();
        for lamp in self.lamps() {
            for ((piece, sum), light) in
                pieces.iter().zip(&mut sums).zip(lamp.irradiance(self.world(), pieces))
            {
                let to = lamp.position - centre(piece.corners, piece.normal).0;
                add(sum, light.luminance(), to);
            }
        }
        sums.into_iter().map(|(sum, total)| if total > 0.0 { sum / total } else { DVec3::ZERO }).collect()
    }

    fn add_senders(
        &self,
        points: &[Element],
        senders: &[usize],
        sent: &[Rgb],
        resolution: Resolution,
        sums: &mut [(DVec3, f64)],
    ) {
        if senders.is_empty() {
            return;
        }
        let rows = self.rows(points, senders, resolution);
        for ((number, point), sum) in points.iter().enumerate().zip(sums) {
            for (node, form_factor) in rows.row(number) {
                let sender = &self.world.nodes[node];
                let to = sender.bounds.centre() - point.centroid;
                add(sum, form_factor * sent[node].luminance(), to);
            }
        }
    }
}

fn add(sum: &mut (DVec3, f64), weight: f64, to: DVec3) {
    sum.0 += to.normalize_or_zero() * weight;
    sum.1 += weight;
}

fn middle(piece: &SurfacePiece) -> Option<Element> {
    let (middle, _) = centre(piece.corners, piece.normal);
    Some(receiver(middle, piece.normal, piece.plane.face_at(middle)?))
}
