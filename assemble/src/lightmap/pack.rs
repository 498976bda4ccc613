//! Rectangles → as few and as small images as hold them. Sizes are in texels.

use guillotiere::{AtlasAllocator, size2};

/// Where a rectangle went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spot {
    /// The image.
    pub image: usize,
    /// The rectangle's first column and row in it.
    pub at: [u32; 2],
}

/// Rectangles in images.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packed {
    /// Where each rectangle went.
    pub spots: Vec<Spot>,
    /// The sizes of the images.
    pub images: Vec<[u32; 2]>,
}

/// Images grow by this much when they turn out too small.
const GROWTH: f64 = 1.03;

/// Put `rectangles` into images whose sides have at most `limit` texels, which no side of a rectangle may exceed.
pub fn pack(rectangles: &[[u32; 2]], limit: u32) -> Packed {
    let mut order: Vec<usize> = (0..rectangles.len()).collect();
    order.sort_by_key(|&i| {
        let [width, height] = rectangles[i];
        std::cmp::Reverse((width.max(height), width.min(height)))
    });
    let mut packed = Packed { spots: vec![Spot { image: 0, at: [0, 0] }; rectangles.len()], images: vec![] };
    while !order.is_empty() {
        let mut left = Vec::new();
        let filled = fill(rectangles, &order, limit, &mut left);
        let image = packed.images.len();
        packed.images.push(used(rectangles, &filled));
        filled.into_iter().for_each(|(i, at)| packed.spots[i] = Spot { image, at });
        order = left;
    }
    packed
}

/// One image of the rectangles named by `order`, small if it can hold all; what it cannot hold is `left`.
fn fill(
    rectangles: &[[u32; 2]],
    order: &[usize],
    limit: u32,
    left: &mut Vec<usize>,
) -> Vec<(usize, [u32; 2])> {
    let area: f64 = order.iter().map(|&i| f64::from(rectangles[i][0]) * f64::from(rectangles[i][1])).sum();
    let largest = |side: usize| order.iter().map(|&i| rectangles[i][side]).max().unwrap_or(0);
    let mut side = area.sqrt();
    loop {
        left.clear();
        let whole = [largest(0), largest(1)].map(|least| (side.ceil() as u32).max(least).min(limit) as i32);
        let mut allocator = AtlasAllocator::new(size2(whole[0], whole[1]));
        let mut filled = Vec::new();
        for &i in order {
            let [width, height] = rectangles[i].map(|length| length as i32);
            match allocator.allocate(size2(width, height)) {
                Some(got) => filled.push((i, [got.rectangle.min.x as u32, got.rectangle.min.y as u32])),
                None => left.push(i),
            }
        }
        if left.is_empty() || whole == [limit as i32; 2] {
            return filled;
        }
        side *= GROWTH;
    }
}

fn used(rectangles: &[[u32; 2]], filled: &[(usize, [u32; 2])]) -> [u32; 2] {
    let end = |side: usize| filled.iter().map(|(i, at)| at[side] + rectangles[*i][side]).max().unwrap_or(0);
    [end(0), end(1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rectangles_lie_in_their_image_and_never_overlap(
            rectangles in prop::collection::vec([1..40u32, 1..40u32], 1..60), limit in 40..90u32,
        ) {
            let packed = pack(&rectangles, limit);
            let mut taken = vec![vec![false; (limit * limit) as usize]; packed.images.len()];
            for (&[width, height], spot) in rectangles.iter().zip(&packed.spots) {
                let end = [spot.at[0] + width, spot.at[1] + height];
                let image = packed.images[spot.image];
                prop_assert!(image.iter().all(|&side| side <= limit), "an image of {image:?}, limit {limit}");
                prop_assert!(end[0] <= image[0] && end[1] <= image[1], "{end:?} in an image of {image:?}");
                for (x, y) in (spot.at[0]..end[0]).flat_map(|x| (spot.at[1]..end[1]).map(move |y| (x, y))) {
                    let texel = &mut taken[spot.image][(y * limit + x) as usize];
                    prop_assert!(!std::mem::replace(texel, true), "texel {x}, {y} is taken twice");
                }
            }
        }
    }
}
