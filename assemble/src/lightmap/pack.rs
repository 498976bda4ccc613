//! Packs rectangles into as few and as small images as possible. Sizes are in texels.

use guillotiere::{AtlasAllocator, size2};

/// The position of a rectangle.
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
    /// The position of each rectangle.
    pub spots: Vec<Spot>,
    /// The sizes of the images.
    pub images: Vec<[u32; 2]>,
}

/// Factor by which an image grows when it is too small.
const GROWTH_FACTOR: f64 = 1.03;
/// Aspect ratios that are tried, width over height; the smallest image wins. A single ratio may leave 45 % empty; all
/// of these together left at most 11 % in trials with equal, mixed and random sizes.
const ASPECT_RATIOS: [f64; 9] = [1.0, 0.5, 0.6, 0.7, 0.85, 1.2, 1.4, 1.7, 2.0];

/// Rectangles of one image, by index, with their positions.
type Filled = Vec<(usize, [u32; 2])>;

/// Pack `rectangles` into images with sides of at most `limit` texels, which no side of a rectangle may exceed.
pub fn pack(rectangles: &[[u32; 2]], limit: u32) -> Packed {
    let mut order: Vec<usize> = (0..rectangles.len()).collect();
    order.sort_by_key(|&i| {
        let [width, height] = rectangles[i];
        std::cmp::Reverse((width.max(height), width.min(height)))
    });
    let mut packed = Packed { spots: vec![Spot { image: 0, at: [0, 0] }; rectangles.len()], images: vec![] };
    while !order.is_empty() {
        let (filled, left) = match smallest(rectangles, &order, limit) {
            Some(filled) => (filled, vec![]),
            None => fill(rectangles, &order, [limit; 2]),
        };
        let image = packed.images.len();
        packed.images.push(used(rectangles, &filled));
        filled.into_iter().for_each(|(i, at)| packed.spots[i] = Spot { image, at });
        order = left;
    }
    packed
}

/// The smallest image found that holds all rectangles listed in `order`, if the limit allows one.
fn smallest(rectangles: &[[u32; 2]], order: &[usize], limit: u32) -> Option<Filled> {
    let area: f64 = order.iter().map(|&i| f64::from(rectangles[i][0]) * f64::from(rectangles[i][1])).sum();
    let largest = [0, 1].map(|side| order.iter().map(|&i| rectangles[i][side]).max().unwrap_or(0));
    let of_shape = |shape: f64| {
        let mut scale = area.sqrt();
        loop {
            let wanted = [scale * shape.sqrt(), scale / shape.sqrt()];
            let size = [0, 1].map(|side| (wanted[side].ceil() as u32).max(largest[side]));
            if size.iter().any(|&side| side > limit) {
                return None;
            }
            let (filled, left) = fill(rectangles, order, size);
            if left.is_empty() {
                return Some(filled);
            }
            scale *= GROWTH_FACTOR;
        }
    };
    let texels =
        |filled: &Filled| used(rectangles, filled).iter().map(|&side| u64::from(side)).product::<u64>();
    ASPECT_RATIOS.into_iter().filter_map(of_shape).min_by_key(texels)
}

/// Fill an image of this size with the rectangles listed in `order`; returns their positions, and the rectangles that
/// do not fit.
fn fill(rectangles: &[[u32; 2]], order: &[usize], size: [u32; 2]) -> (Filled, Vec<usize>) {
    let mut allocator = AtlasAllocator::new(size2(size[0] as i32, size[1] as i32));
    let (mut filled, mut left) = (Vec::new(), Vec::new());
    for &i in order {
        let [width, height] = rectangles[i].map(|length| length as i32);
        match allocator.allocate(size2(width, height)) {
            Some(got) => filled.push((i, [got.rectangle.min.x as u32, got.rectangle.min.y as u32])),
            None => left.push(i),
        }
    }
    (filled, left)
}

/// The size of the used region of an image.
fn used(rectangles: &[[u32; 2]], filled: &Filled) -> [u32; 2] {
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
