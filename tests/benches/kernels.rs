//! One form factor of one pair: the plain contour, lanes of receivers, and rays. Nanoseconds a pair.
//!
//! `cargo bench -p equilux-tests --bench kernels`

use equilux_bake::form_factor::contour;
use equilux_bake::form_factor::wide::{LANES, Points, contours, towards, vectorised};
use equilux_bake::rays::RayIndex;
use equilux_tests::measure::Level;
use glam::DVec3;
use std::hint::black_box;
use std::time::Instant;

fn main() {
    let level = Level::furnished(1, 0.25);
    let elements = &level.world.elements;
    let floor = elements.iter().filter(|e| e.normal.y > 0.99 && e.centroid.y < 0.01).take(64);
    let points: Vec<DVec3> = floor.map(|e| e.centroid).collect();
    let senders: Vec<_> = elements.iter().filter(|e| e.centroid.y > 1.0).collect();
    let pairs = (points.len() * senders.len()) as f64;

    time("plain contour", pairs, || {
        let of = |x: DVec3| {
            let corners = |i: usize| senders[i].corners.as_slice().iter().map(|&p| p - x).collect::<Vec<_>>();
            (0..senders.len()).map(|i| contour::contour(&corners(i), DVec3::Y)).sum::<f64>()
        };
        points.iter().map(|&x| of(x)).sum()
    });
    let receivers = Points::new(points.clone(), DVec3::Y);
    time("lanes", pairs, || {
        vectorised(
            #[inline(always)]
            || {
                let mut sum = 0.0;
                for sender in &senders {
                    for lanes in receivers.lanes() {
                        let mut corners = [*lanes; 4];
                        for (to, &corner) in corners.iter_mut().zip(sender.corners.as_slice()) {
                            *to = towards(corner, lanes);
                        }
                        sum += contours(&corners, DVec3::Y).0[0];
                    }
                }
                sum
            },
        )
    });
    let index = RayIndex::new(elements);
    time("a ray", pairs, || {
        let seen = |x: DVec3| senders.iter().filter(|s| index.sees(x, s.centroid)).count() as f64;
        points.iter().map(|&x| seen(x)).sum()
    });
    println!("{} receivers, {LANES} a time, {} senders", points.len(), senders.len());
}

/// The median of eleven runs.
fn time(name: &str, pairs: f64, run: impl Fn() -> f64) {
    let once = |_| {
        let start = Instant::now();
        black_box(run());
        start.elapsed().as_secs_f64()
    };
    let mut seconds: Vec<f64> = (0..11).map(once).collect();
    seconds.sort_by(f64::total_cmp);
    println!("{name:>14} {:>8.1} ns a pair", seconds[5] * 1e9 / pairs);
}
