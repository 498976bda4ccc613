//! A four-dimensional Sobol sequence with Owen's scrambling (Owen 1995), by hashing as in Burley 2020, "Practical
//! hash-based Owen scrambling". Each coordinate of each power of two of points is stratified.

/// Number of coordinates.
pub const DIMENSIONS: usize = 4;

/// Direction numbers of the first four dimensions (Joe & Kuo 2008): primitive polynomials of degree 0, 1, 2 and 3 with initial
/// numbers 1; 1; 1, 3; 1, 3, 1.
const DIRECTIONS: [[u32; 32]; DIMENSIONS] = [
    van_der_corput(),
    recurrence([1 << 31, 0, 0], 1, 0),
    recurrence([1 << 31, 3 << 30, 0], 2, 0b1),
    recurrence([1 << 31, 3 << 30, 1 << 29], 3, 0b01),
];

const fn van_der_corput() -> [u32; 32] {
    let mut numbers = [0; 32];
    let mut bit = 0;
    while bit < 32 {
        numbers[bit] = 1 << (31 - bit);
        bit += 1;
    }
    numbers
}

/// The direction numbers of a primitive polynomial of this degree, whose inner coefficients are the bits of `inner`.
const fn recurrence(first: [u32; 3], degree: usize, inner: u32) -> [u32; 32] {
    let mut numbers = [0; 32];
    let mut bit = 0;
    while bit < 32 {
        if bit < degree {
            numbers[bit] = first[bit];
        } else {
            let mut next = numbers[bit - degree] ^ (numbers[bit - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if inner >> (degree - 1 - k) & 1 == 1 {
                    next ^= numbers[bit - k];
                }
                k += 1;
            }
            numbers[bit] = next;
        }
        bit += 1;
    }
    numbers
}

/// Point `index` of the sequence scrambled by `seed`, in [0, 1)⁴.
pub fn point(index: u32, seed: u32) -> [f64; DIMENSIONS] {
    std::array::from_fn(|k| {
        let bits = (0..32).filter(|bit| index >> bit & 1 == 1);
        let plain = bits.fold(0, |sum, bit| sum ^ DIRECTIONS[k][bit]);
        let seed = hash(seed ^ (k as u32).wrapping_mul(0x9e37_79b9));
        f64::from(scrambled(plain, seed)) / 4_294_967_296.0
    })
}

/// Every bit of `x` is flipped or not, depending on `seed` and on the bits above it.
fn scrambled(x: u32, seed: u32) -> u32 {
    // On reversed bits, each multiplication by an even number plus one carries only upwards (Laine & Karras 2011).
    let mut x = x.reverse_bits().wrapping_add(seed);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6_u32] {
        x ^= x.wrapping_mul(factor);
    }
    x.reverse_bits()
}

/// A bijective hash of 32 bits (multipliers: Wellons 2018).
#[inline(always)]
pub fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The property that makes rows converge faster than random rays: in each pair of coordinates used together
        /// (direction, origin), and in each alone, every elementary interval of 2^m points holds what it should.
        #[test]
        fn powers_of_two_are_stratified(seed in 0u32.., order in 1u32..9) {
            let count = 1 << order;
            let points: Vec<_> = (0..count).map(|i| point(i, seed)).collect();
            for k in 0..DIMENSIONS {
                let mut cells: Vec<u32> = points.iter().map(|p| (p[k] * f64::from(count)) as u32).collect();
                cells.sort_unstable();
                prop_assert_eq!(cells, (0..count).collect::<Vec<_>>(), "coordinate {}", k);
            }
            for first in 0..=order {
                let (wide, high) = (1u32 << first, 1u32 << (order - first));
                let cell = |p: &[f64; 4]| (p[0] * f64::from(wide)) as u32 * high + (p[1] * f64::from(high)) as u32;
                let mut cells: Vec<u32> = points.iter().map(cell).collect();
                cells.sort_unstable();
                prop_assert_eq!(cells, (0..count).collect::<Vec<_>>(), "{} x {}", wide, high);
            }
        }
    }
}
