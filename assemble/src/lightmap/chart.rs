//! Charts: connected sides of one material, and of one choice of texels, that can be laid out in a plane together. Input: a part. Output: its
//! charts; each side belongs to exactly one of them.
//!
//! A chart grows from its largest side over smooth contacts, as long as sides face the chart's direction to within
//! [`MAX_SMOOTH_ANGLE`], so that no texel is stretched by more than 1/cos 30° = 1.15. It is therefore a height field over a
//! plane, unless it winds around and covers itself; in that case each of its flat regions becomes a chart of its own.

use super::contacts::{MAX_SMOOTH_ANGLE, smooth_contacts};
use super::overlap::any_overlap;
use super::side::{SurfaceSide, are_alike, sides};
use equilux_bake::geometry::planes;
use equilux_formats::{Face, MaterialId, Part, TexelChoice};
use glam::DVec3;

/// Sides that share a region of the lightmap.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Unit vector of projection: each point of the chart has a distinct projection along it.
    pub direction: DVec3,
    /// The material of all sides.
    pub material: MaterialId,
    /// The author's choice about the texels of all sides.
    pub texels: TexelChoice,
    /// The sides.
    pub sides: Vec<SurfaceSide>,
    /// For each side the index of its plane, counted from 0 without gaps.
    pub planes: Vec<usize>,
}

impl Chart {
    /// Number of planes.
    pub fn plane_count(&self) -> usize {
        self.planes.iter().max().map_or(0, |&last| last + 1)
    }

    /// The largest side in a plane, which determines the plane most accurately.
    pub fn largest_in(&self, plane: usize) -> &SurfaceSide {
        let sides = self.sides.iter().zip(&self.planes).filter(|(_, of)| **of == plane);
        sides.map(|(side, _)| side).max_by(|a, b| a.area.total_cmp(&b.area)).expect("a plane has a side")
    }
}

/// The charts of a part.
pub fn charts(part: &Part) -> Vec<Chart> {
    let growth = Growth::new(sides(part));
    let mut charts = Vec::new();
    for members in growth.groups(&growth.all(), |seed, side| growth.faces(seed, side)) {
        if growth.covers_itself(&members) {
            let flat = growth.groups(&members, |seed, side| growth.plane[seed] == growth.plane[side]);
            charts.extend(flat.iter().map(|members| growth.chart(members)));
        } else {
            charts.push(growth.chart(&members));
        }
    }
    charts
}

struct Growth {
    sides: Vec<SurfaceSide>,
    plane: Vec<u32>,
    neighbours: Vec<Vec<usize>>,
}

impl Growth {
    fn new(sides: Vec<SurfaceSide>) -> Self {
        let mut neighbours = vec![Vec::new(); sides.len()];
        for contact in smooth_contacts(&sides) {
            let [a, b] = contact.sides;
            if are_alike(&sides[a], &sides[b]) {
                neighbours[a].push(b);
                neighbours[b].push(a);
            }
        }
        let faces: Vec<Face> = sides.iter().map(|s| Face::new(s.corners.as_slice().to_vec())).collect();
        Self { plane: planes::group(&faces), sides, neighbours }
    }

    fn all(&self) -> Vec<usize> {
        (0..self.sides.len()).collect()
    }

    fn faces(&self, seed: usize, side: usize) -> bool {
        self.sides[seed].normal.dot(self.sides[side].normal) >= MAX_SMOOTH_ANGLE.cos()
    }

    /// Divide `members` into connected groups, each grown from its largest side over sides for which `fit` holds.
    fn groups(&self, members: &[usize], fit: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
        let mut free = vec![false; self.sides.len()];
        members.iter().for_each(|&side| free[side] = true);
        let mut seeds = members.to_vec();
        seeds.sort_by(|&a, &b| self.sides[b].area.total_cmp(&self.sides[a].area).then(a.cmp(&b)));
        let mut groups = Vec::new();
        for seed in seeds {
            if !std::mem::take(&mut free[seed]) {
                continue;
            }
            let (mut group, mut next) = (vec![seed], 0);
            while next < group.len() {
                for &side in &self.neighbours[group[next]] {
                    if free[side] && fit(seed, side) {
                        free[side] = false;
                        group.push(side);
                    }
                }
                next += 1;
            }
            groups.push(group);
        }
        groups
    }

    /// Whether two points of a curved group lie behind one another. In a flat group, overlapping sides are the same
    /// points with the same light.
    fn covers_itself(&self, members: &[usize]) -> bool {
        let direction = self.sides[members[0]].normal;
        members.iter().any(|&side| self.plane[side] != self.plane[members[0]])
            && any_overlap(members.iter().map(|&side| self.sides[side].corners), direction)
    }

    fn chart(&self, members: &[usize]) -> Chart {
        let first = self.sides[members[0]];
        let mut planes: Vec<u32> = members.iter().map(|&side| self.plane[side]).collect();
        planes.sort_unstable();
        planes.dedup();
        let number = |&side: &usize| planes.binary_search(&self.plane[side]).expect("it was put there");
        Chart {
            direction: first.normal,
            material: first.material,
            texels: first.texels,
            sides: members.iter().map(|&side| self.sides[side]).collect(),
            planes: members.iter().map(number).collect(),
        }
    }
}
