//! Cells of a divided scene count the same rays as the whole, in whole numbers: a ray follows from where its element lies.

use equilux_assemble::equation::Equation;
use equilux_assemble::equation::environment::Environment;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::placed_parts::PlacedParts;
use equilux_bake::elements::ElementSize;
use equilux_bake::elements::bisect::Cut;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod, prepare};
use equilux_formats::{Element, Store};
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use proptest::prelude::*;
use std::collections::BTreeMap;

/// An element, by the bits of its centroid and normal.
type Place = [u64; 6];

fn place(element: &Element) -> Place {
    let [a, b] = [element.centroid, element.normal].map(|v| v.to_array().map(f64::to_bits));
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// What the rays of each element end on, elements and cells of the sky, and the number of them.
type Counts = BTreeMap<Place, (BTreeMap<Place, f64>, BTreeMap<usize, f64>)>;

/// The rows of the furnished room in elements of at most a quarter of a metre, whose planes are at multiples of it.
fn counts(workshop: &Workshop, division: Division) -> Counts {
    let wanted = Preparation {
        element_size: Some(ElementSize::Metres(0.25)),
        division,
        rows: RowMethod::Rays,
        rays: 64,
        ..Preparation::default()
    };
    let folder = tempfile::tempdir().expect("a folder");
    let (store, monitor) = (Store::open(folder.path()).expect("a cache"), Monitor::default());
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    let prepared = prepare(&scene, &wanted).expect("elements");
    let oven = Oven { store: &store, file: &scene.file, resolution: prepared.resolution, monitor: &monitor };
    let environment = Environment::read(None, None).expect("no sky");
    let equation = Equation::new(&oven, &scene, prepared, &environment, &Unobserved).expect("blocks");
    let placed = &equation.placed;
    let places = unknowns(placed);
    let mut all = Counts::new();
    for (k, blocks) in equation.coupled.iter().enumerate() {
        let own = placed.columns_of(k);
        let self_block = blocks.self_block(&placed.part_of(k).part.self_block);
        for (i, place) in places[own.clone()].iter().enumerate() {
            let Some(place) = *place else { continue };
            let inside = self_block.row(i).map(|(column, f)| (own.start + column, f));
            let row = inside.chain(blocks.coupling.row(i));
            let row = row.filter_map(|(column, f)| Some((places[column]?, f)));
            let sky = blocks.sky.as_ref().expect("by rays").row(i);
            let known = all.insert(place, (row.collect(), sky.collect()));
            assert!(known.is_none(), "every element has a place of its own");
        }
    }
    all
}

/// The places of the unknowns that are one element; pieces that planes cut off may be joined to patches.
fn unknowns(placed: &PlacedParts) -> Vec<Option<Place>> {
    let mut members: Vec<Vec<Place>> = vec![vec![]; placed.columns()];
    for k in 0..placed.instances.len() {
        let (first, own) = (placed.columns_of(k).start, placed.world.elements_of(k));
        for (i, element) in placed.world.elements[own].iter().enumerate() {
            members[first + placed.unknown_of(k, i)].push(place(element));
        }
    }
    members.into_iter().map(|own| if let [one] = own[..] { Some(one) } else { None }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, max_shrink_iters: 0, failure_persistence: None, ..ProptestConfig::default() })]

    /// Planes along the edges of elements, in walls and through furniture, so that both have the same elements.
    #[test]
    fn cells_count_the_rays_of_the_whole(
        planes in proptest::collection::vec((0..3usize, 1..12), 1..4),
    ) {
        let workshop = Workshop::with(&furnished());
        let whole = counts(&workshop, Division::Bisect(1));
        let planes = planes.into_iter().map(|(axis, quarters)| Cut { axis, offset: f64::from(quarters) / 4.0 });
        let cells = counts(&workshop, Division::Cuts(planes.clone().collect()));
        let common = cells.keys().filter(|place| whole.contains_key(*place)).count();
        // Planes cut some elements of the thin things between, whose pieces are elements of their own.
        prop_assert!(common * 10 > whole.len() * 9, "{common} of {} elements are in both", whole.len());
        for (place, (row, sky)) in cells.iter().filter(|(place, _)| whole.contains_key(*place)) {
            let (row_of_whole, sky_of_whole) = &whole[place];
            prop_assert_eq!(sky, sky_of_whole);
            for (column, count) in row.iter().filter(|(column, _)| whole.contains_key(*column)) {
                prop_assert_eq!(Some(count), row_of_whole.get(column), "{:?} from {:?}", column, place);
            }
            for (column, count) in row_of_whole.iter().filter(|(column, _)| cells.contains_key(*column)) {
                prop_assert_eq!(Some(count), row.get(column), "{:?} from {:?}", column, place);
            }
        }
    }
}
