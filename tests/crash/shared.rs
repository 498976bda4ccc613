//! Of two processes that share a cache, one waits for the results of the other.

use super::{assert_same, contents, start};
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::oven::keys::keys_of;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod, prepare};
use equilux_bake::treecode::Resolution;
use equilux_formats::Store;
use equilux_formats::store::Turn;
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use serde_json::Value;
use std::process::{Child, Output};
use std::time::Duration;

fn arguments(out: &str) -> [&str; 10] {
    ["scene.glb", "--element-size", "0.25", "--rounds", "2", "--cache", "cache", "--out", out, "--json"]
}

fn report(running: Child) -> Value {
    let Output { status, stdout, stderr } = running.wait_with_output().expect("the program ends");
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    serde_json::from_slice(&stdout).expect("a report")
}

#[test]
fn two_at_once_compute_each_form_factor_once_and_agree() {
    let alone = Workshop::with(&furnished());
    let expected = report(start(&alone, "assemble", &arguments("out")));
    let shared = Workshop::with(&furnished());
    let running = ["one", "two"].map(|out| start(&shared, "assemble", &arguments(out)));
    let [one, two] = running.map(report);

    let computed = |report: &Value| report["form_factors_computed"].as_u64().expect("a number");
    assert!(computed(&expected) > 0, "nothing was computed alone");
    assert_eq!(
        computed(&one) + computed(&two),
        computed(&expected),
        "form factors: {} and {} together",
        computed(&one),
        computed(&two)
    );
    for (out, report) in [("one", &one), ("two", &two)] {
        assert_eq!(report["energy"], expected["energy"], "light of {out}");
        assert_same(&contents(&shared, out), &contents(&alone, "out"), out);
    }
    assert_same(&contents(&shared, "cache"), &contents(&alone, "cache"), "cache");
}

/// All turns that baking scene.glb in elements of a metre needs.
fn turns(workshop: &Workshop) -> Vec<Turn> {
    let wanted = Preparation {
        element_size: Some(ElementSize::Metres(1.0)),
        division: Division::Authored,
        resolution: Resolution::for_tolerance(0.01),
        rows: RowMethod::Auto,
        rays: 256,
        local_solver: None,
    };
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    let prepared = prepare(&scene, &wanted).expect("parts");
    let store = Store::open(workshop.path("cache")).expect("a cache");
    // Keys may share a turn.
    keys_of(&prepared, &store, &workshop.path("scene.glb"))
        .iter()
        .filter_map(|key| store.try_turn(key))
        .collect()
}

/// Long enough for all four parts several times over.
const A_WHILE: Duration = Duration::from_secs(2);

fn waiting(workshop: &Workshop) -> Child {
    let mut running = start(workshop, "bake", &["scene.glb", "--element-size", "1", "--cache", "cache"]);
    std::thread::sleep(A_WHILE);
    assert_eq!(running.try_wait().expect("a process"), None, "it went on although another has the turn");
    let made = workshop.files("cache").into_keys().find(|path| path.extension().is_some_and(|e| e == "eqx"));
    assert_eq!(made, None, "it made something although another has the turn");
    running
}

#[test]
fn a_process_goes_on_when_the_other_is_done_or_dead() {
    let workshop = Workshop::with(&furnished());
    let turns = turns(&workshop);
    let running = waiting(&workshop);
    drop(turns);
    let output = running.wait_with_output().expect("the program ends");
    assert!(String::from_utf8_lossy(&output.stdout).contains("4 baked, 0 reused"), "{output:?}");
}

#[cfg(unix)]
#[test]
fn a_process_that_waits_can_be_interrupted() {
    let workshop = Workshop::with(&furnished());
    let turns = turns(&workshop);
    let running = waiting(&workshop);
    let kill = std::process::Command::new("kill").args(["-INT", &running.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    let output = running.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("stopped while baking part"), "{output:?}");
    drop(turns);
}
