//! The classic methods find the same light as parts.

use super::workshop;
use equilux_tests::workshop::Workshop;

/// He of every point of points.csv, one channel after the other.
fn light(workshop: &Workshop, out: &str, arguments: &[&str]) -> Vec<f64> {
    let all =
        [arguments, &["--points", "points.csv", "--out", out, "--element-size", "0.5", "--json"]].concat();
    let ended = workshop.run("assemble", &all);
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
    let table = std::fs::read_to_string(workshop.path(out).join("scene/points.csv")).expect("points");
    let numbers =
        |line: &str| -> Vec<f64> { line.split(',').skip(10).map(|h| h.parse().expect("light")).collect() };
    table.lines().skip(1).flat_map(numbers).collect()
}

/// Root of the mean square difference over the mean.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (square / a.len() as f64).sqrt() / (b.iter().sum::<f64>() / b.len() as f64)
}

#[test]
fn classic_ways_find_the_light_that_parts_find() {
    let workshop = workshop();
    // The middles of some elements are points on all surfaces.
    let ended = workshop.run("assemble", &["scene.glb", "--element-size", "0.4", "--elements", "points.csv"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);

    let parts = light(&workshop, "parts", &["scene.glb", "--tolerance", "0", "--pictures", "none"]);
    let dense = light(&workshop, "dense", &["classic", "scene.glb"]);
    // Both stop at a relative residual of 1e-6.
    assert!(apart(&dense, &parts) < 1e-5, "dense differs by {}", apart(&dense, &parts));

    let rays = [1, 64].map(|rays| {
        let light = light(&workshop, "rays", &["classic", "scene.glb", "--rays", &rays.to_string()]);
        apart(&light, &parts)
    });
    assert!(rays[1] < rays[0] / 2.0, "64 rays err by {}, 1 ray by {}", rays[1], rays[0]);

    let progressive = ["0.5", "0.001"].map(|unshot| {
        let arguments = ["classic", "scene.glb", "--solver", "progressive", "--unshot", unshot];
        apart(&light(&workshop, "progressive", &arguments), &parts)
    });
    assert!(
        progressive[1] < progressive[0] / 2.0,
        "half unshot errs by {}, 0.001 by {}",
        progressive[0],
        progressive[1]
    );
}
