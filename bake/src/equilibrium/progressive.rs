//! Progressive refinement: the element with the largest unshot radiosity shoots first (Southwell relaxation). Cohen,
//! Chen, Wallace & Greenberg 1988; Gortler & Cohen 1993 for the equivalence with Southwell.

use super::channels::largest;
use super::columns::Columns;
use super::system::{LocalSystem, ROUNDING};
use equilux_formats::Rgb;

/// Shoots until the unshot radiosity is rounding.
pub fn solve(system: &LocalSystem, columns: &Columns, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
    let mut b = guess.to_vec();
    // Rounding accumulates over many shots: the residual is computed again until it is small at the start.
    loop {
        let irradiance = system.irradiance(&b);
        let mut unshot: Vec<Rgb> =
            (0..b.len()).map(|i| sources[i] + system.reflectance[i] * irradiance[i] - b[i]).collect();
        let shots = shoot(system, columns, &mut b, &mut unshot);
        if shots == 0 {
            return b;
        }
    }
}

/// Shoots until no channel has more than rounding left, and returns the number of shots.
fn shoot(system: &LocalSystem, columns: &Columns, b: &mut [Rgb], unshot: &mut [Rgb]) -> usize {
    let start = largest(b);
    let scale: Rgb = Rgb::from_fn(|c| start[c].max(largest(unshot)[c]).max(f64::MIN_POSITIVE));
    let share = |r: &Rgb| (0..3).map(|c| r[c].abs() / scale[c]).fold(0.0, f64::max);
    for shots in 0.. {
        let (brightest, most) = unshot
            .iter()
            .map(share)
            .enumerate()
            .fold((0, 0.0), |best, (i, s)| if s > best.1 { (i, s) } else { best });
        if most <= 4.0 * ROUNDING {
            return shots;
        }
        let shot = std::mem::take(&mut unshot[brightest]);
        b[brightest] += shot;
        shoot_one(system, columns, brightest, shot, unshot);
    }
    unreachable!("the loop above ends only by returning")
}

/// Adds the shot to all receivers that see the element or a cluster around it.
fn shoot_one(system: &LocalSystem, columns: &Columns, element: usize, shot: Rgb, unshot: &mut [Rgb]) {
    let area = system.clusters.area_of(element);
    let mut node = Some(element);
    while let Some(sender) = node {
        let share = shot.map(|s| s * area / system.clusters.area_of(sender));
        for &(receiver, value) in columns.column(sender) {
            let i = receiver as usize;
            unshot[i] += system.reflectance[i] * share * value;
        }
        node = system.clusters.parent_of(sender);
    }
}
