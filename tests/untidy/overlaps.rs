//! Coplanar faces that overlap count once, within a part, between parts, and between instances of a part.

use equilux_formats::{Part, Rgb};
use equilux_tests::cases::solve::{Lit, Setting, Solved, solved_file};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, joined, part, rectangle, room};
use glam::{DVec3, dvec3};
use proptest::prelude::*;
use serde_json::json;

/// Rugs lie on a grid of this width, metres: a power of two, so that areas add up exactly.
const CELL: f64 = 0.125;

/// Where a rug begins and ends, in cells, in a room of 16 × 16 cells.
type Rug = [usize; 4];

fn rugs() -> impl Strategy<Value = Vec<Rug>> {
    let rug = (1usize..10, 1usize..10, 1usize..6, 1usize..6)
        .prop_map(|(x, z, width, length)| [x, z, x + width, z + length]);
    prop::collection::vec(rug, 2..9)
}

/// A rug that looks up, on the plane y = 0.5, at reflectance `rho` and emission 1 − `rho`: with light of 1 from everywhere
/// all of it has a radiosity of 1.
fn laid(rug: Rug, rho: f64) -> Part {
    let [x, z, to_x, to_z] = rug.map(|cells| cells as f64 * CELL);
    rectangle(part(grey(rho, 1.0 - rho)), dvec3(x, 0.5, z), DVec3::Z * (to_z - z), DVec3::X * (to_x - x))
}

/// A furnace around these nodes: everything has a radiosity of 1.
fn furnace(rugs: Vec<Node>) -> Vec<Node> {
    let walls = room(grey(0.5, 0.5), DVec3::ZERO, dvec3(2.0, 1.0, 2.0));
    // What the rugs' black backs hide from the floor does not matter here.
    std::iter::once(Node::new("room", walls)).chain(rugs).collect()
}

fn solve(nodes: &[Node]) -> Solved {
    solved_file(&Model::of(nodes), &Setting::metres(0.5)).unwrap_or_else(|error| panic!("{error}"))
}

fn is_rug(lit: &Lit) -> bool {
    lit.centroid.y == 0.5
}

/// The number of cells that any rug covers.
fn covered(rugs: &[Rug]) -> usize {
    let is_in =
        |x: usize, z: usize| rugs.iter().any(|r| (r[0]..r[2]).contains(&x) && (r[1]..r[3]).contains(&z));
    (0..16).flat_map(|x| (0..16).map(move |z| (x, z))).filter(|&(x, z)| is_in(x, z)).count()
}

/// Checks a room with rugs, of which the `kept`th alone has a reflectance of a quarter.
fn check(found: &Solved, rugs: &[Rug], kept: usize, how: &str) -> Result<(), TestCaseError> {
    // Sums of a few hundred clipped polygons.
    let excess = found.report.row_sum_defect.excess;
    prop_assert!(excess <= 1e-9, "{how}: a row exceeds 1 by {excess}");
    let area: f64 = found.elements.iter().filter(|lit| is_rug(lit)).map(|lit| lit.area).sum();
    let expected = covered(rugs) as f64 * CELL * CELL;
    prop_assert!((area - expected).abs() <= 1e-9, "{how}: {area} m² of rugs for {expected}");
    // One rug keeps all of its area; reflectances tell rugs apart.
    let of_kept = |lit: &&Lit| is_rug(lit) && (lit.reflectance[0] - 0.25).abs() < 1e-6;
    let area: f64 = found.elements.iter().filter(of_kept).map(|lit| lit.area).sum();
    let [x, z, to_x, to_z] = rugs[kept];
    let expected = ((to_x - x) * (to_z - z)) as f64 * CELL * CELL;
    prop_assert!((area - expected).abs() <= 1e-9, "{how}: {area} m² of the kept rug for {expected}");
    let is_noted = found.report.notes.iter().any(|note| note.contains("in one plane"));
    let whole: usize = rugs.iter().map(|r| (r[2] - r[0]) * (r[3] - r[1])).sum();
    prop_assert_eq!(is_noted, whole > covered(rugs), "{}: {:?}", how, &found.report.notes);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    #[test]
    fn rugs_on_rugs_count_once(rugs in rugs()) {
        let parts = |kept: usize| {
            let rho = move |number: usize| if number == kept { 0.25 } else { 0.5 };
            rugs.iter().enumerate().map(move |(k, &rug)| laid(rug, rho(k)))
        };
        let one = Node::new("rugs", joined(parts(0)));
        check(&solve(&furnace(vec![one])), &rugs, 0, "one part")?;
        // The largest, and of equal ones the first.
        let size = |rug: &Rug| (rug[2] - rug[0]).pow(2) + (rug[3] - rug[1]).pow(2);
        let largest = (0..rugs.len()).max_by_key(|&k| (size(&rugs[k]), rugs.len() - k)).expect("some rugs");
        let each = parts(largest).enumerate().map(|(k, part)| Node::new(&format!("rug {k}"), part));
        check(&solve(&furnace(each.collect())), &rugs, largest, "a part each")?;
    }

    /// Copies of a rug that are turned and mirrored, each by its node.
    #[test]
    fn copies_on_copies_count_once(places in prop::collection::vec((3usize..9, 3usize..9, 0usize..4), 2..6)) {
        let size = [3, 2];
        let copy = |&(x, z, turn): &(usize, usize, usize)| {
            let swapped = turn % 2 == 1;
            let [width, length] = if swapped { [size[1], size[0]] } else { size };
            [x, z, x + width, z + length]
        };
        let rugs: Vec<Rug> = places.iter().map(copy).collect();
        let rug = laid([0, 0, size[0], size[1]], 0.25);
        let nodes = (0..rugs.len()).map(|k| Node::new(&format!("copy {k}"), rug.clone()));
        let mut model = Model::of(&furnace(nodes.collect()));
        for (k, &(x, z, turn)) in places.iter().enumerate() {
            // A turn about y takes (x, z) to (z, −x); where it goes below zero the node moves it back.
            let angle = std::f64::consts::FRAC_PI_2 * turn as f64;
            let (sin, cos) = ((angle / 2.0).sin(), (angle / 2.0).cos());
            let [width, length] = size.map(|cells| cells as f64);
            let [dx, dz] = [[0.0, 0.0], [0.0, width], [width, length], [length, 0.0]][turn];
            let node = format!("/nodes/{}", k + 1);
            model = model.with(&format!("{node}/rotation"), json!([0.0, sin, 0.0, cos]));
            let at = [(x as f64 + dx) * CELL, 0.0, (z as f64 + dz) * CELL];
            model = model.with(&format!("{node}/translation"), json!(at));
        }
        let found = solved_file(&model, &Setting::metres(0.5)).unwrap_or_else(|error| panic!("{error}"));
        let excess = found.report.row_sum_defect.excess;
        prop_assert!(excess <= 1e-9, "a row exceeds 1 by {excess}");
        let area: f64 = found.elements.iter().filter(|lit| (lit.centroid.y - 0.5).abs() < 1e-6).map(|lit| lit.area).sum();
        let expected = covered(&rugs) as f64 * CELL * CELL;
        // Turns have the digits of f32.
        prop_assert!((area - expected).abs() <= 1e-6, "{area} m² of rugs for {expected}");
    }
}

#[test]
fn a_two_sided_sheet_keeps_the_side_that_nothing_lies_on() {
    let mut sheet = rectangle(part(grey(0.5, 0.5)), dvec3(0.5, 0.5, 0.5), DVec3::Z, DVec3::X);
    sheet.materials[0].double_sided = true;
    // A one-sided rug of the same size, before it and after it.
    let rug = rectangle(part(grey(0.25, 0.75)), dvec3(0.5, 0.5, 0.5), DVec3::Z, DVec3::X);
    for (order, nodes) in [
        ("sheet first", vec![Node::new("sheet", sheet.clone()), Node::new("rug", rug.clone())]),
        ("rug first", vec![Node::new("rug", rug), Node::new("sheet", sheet)]),
    ] {
        let found = solve(&furnace(nodes));
        let area = |up: f64| {
            let on_side = |lit: &&Lit| is_rug(lit) && lit.normal.y * up > 0.5;
            found.elements.iter().filter(on_side).map(|lit| lit.area).sum::<f64>()
        };
        // Both sides are lit, each once.
        assert!(
            (area(1.0) - 1.0).abs() < 1e-9 && (area(-1.0) - 1.0).abs() < 1e-9,
            "{order}: {} and {} m²",
            area(1.0),
            area(-1.0)
        );
        let worst = found.worst(|_| Rgb([1.0; 3]));
        assert!(worst.error < 1e-6, "{order}: {} in a furnace of {}", worst.got, worst.expected);
    }
}
