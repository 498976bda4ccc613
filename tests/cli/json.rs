//! `--json`: one object on stdout and nothing else.

use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use serde_json::Value;

/// Keys that other programs rely on, as JSON pointers.
const KEYS: [&str; 58] = [
    "/scene",
    "/elements",
    "/parts/0/name",
    "/parts/0/elements",
    "/parts/0/form_factors",
    "/parts/0/reason",
    "/instances",
    "/blocks/self_baked",
    "/blocks/self_reused",
    "/blocks/coupling_computed",
    "/blocks/coupling_reused",
    "/blocks/coupling_left_out",
    "/form_factors_computed",
    "/rays_traced",
    "/seconds/step1",
    "/seconds/step2",
    "/seconds/step3",
    "/seconds/step4",
    "/seconds/step5",
    "/seconds/step6",
    "/seconds/step7",
    "/seconds/step8",
    "/seconds/t1",
    "/seconds/t2",
    "/seconds/t3",
    "/seconds/total",
    "/rounds/0/round",
    "/rounds/0/residual",
    "/rounds/0/error_bound",
    "/rounds/0/seconds",
    "/converged",
    "/bytes/dense",
    "/bytes/stored",
    "/bytes/peak_rss",
    "/energy/emitted/2",
    "/energy/absorbed/2",
    "/energy/escaped/2",
    "/row_sum_defect/max",
    "/row_sum_defect/mean",
    "/row_sum_defect/excess",
    "/verify",
    "/notes",
    "/outputs",
    "/element_size",
    "/parts/3/local_solver",
    "/parts/3/stored",
    "/blocks/self_corrected",
    "/bytes/largest_block",
    "/rounds/0/relative_bound",
    "/error/proved",
    "/error/proved_rms",
    "/error/proved_from",
    "/error/spread",
    "/error/exact_rows/rows",
    "/error/exact_rows/residual_max",
    "/error/exact_rows/residual_max_rel",
    "/error/exact_rows/residual_rms_rel",
    "/error/exact_rows/estimated_rms_rel",
];

fn object(arguments: &[&str], program: &str) -> Value {
    let ended = Workshop::with(&furnished()).run(program, arguments);
    assert_eq!(ended.code, Some(0), "{program} {arguments:?}: {}", ended.stderr);
    assert_eq!(ended.stderr, "", "{program} {arguments:?} prints on stderr");
    let parsed: Value = serde_json::from_str(&ended.stdout).unwrap_or_else(|error| {
        panic!("{program}: stdout is not one JSON value ({error}): {}", ended.stdout)
    });
    assert!(parsed.is_object(), "{program}: stdout is no object: {parsed}");
    parsed
}

#[test]
fn assemble_prints_one_object_with_every_key() {
    let arguments = ["scene.glb", "--element-size", "1", "--tolerance", "0.01", "--json"];
    let noise = object(&arguments, "assemble")["error"]["noise"].clone();
    assert!(noise["rms_rel"].as_f64() > Some(0.0) && noise["rays"] == 256, "rows by rays: {noise}");
    let audit =
        object(&[&arguments[..], &["--exact-rows", "9"]].concat(), "assemble")["error"]["audit"].clone();
    assert!(
        audit["rows"] == 9 && audit["rms_rel"].as_f64() > Some(0.0),
        "rows by rays beside exact ones: {audit}"
    );
    let unmeasured = object(&[&arguments[..], &["--exact-rows", "0"]].concat(), "assemble")["error"].clone();
    assert!(
        unmeasured["audit"].is_null() && unmeasured["noise"].is_null(),
        "nothing was to be measured: {unmeasured}"
    );
    let report = object(&[&arguments[..], &["--rows", "exact"]].concat(), "assemble");
    let missing: Vec<_> = KEYS.iter().filter(|key| report.pointer(key).is_none()).collect();
    assert!(missing.is_empty(), "missing {missing:?} in {report}");
    assert_eq!(report["scene"], "scene");
    assert_eq!(report["instances"], 4);
    assert_eq!(report["verify"], Value::Null, "nobody asked for the comparison");
    let sum: u64 =
        report["parts"].as_array().expect("a list").iter().filter_map(|p| p["elements"].as_u64()).sum();
    assert_eq!(report["elements"], sum, "each part stands once: their elements are the scene's");
    let dense = report["elements"].as_u64().expect("a number").pow(2) * 8;
    assert_eq!(report["bytes"]["dense"], dense, "a row and a column an element, eight bytes each");
}

#[test]
fn verify_adds_the_difference_to_the_object() {
    let exact = ["scene.glb", "--element-size", "1", "--tolerance", "0", "--verify", "--json"];
    let report = object(&exact, "assemble");
    let difference = report["verify"]["max_rel_diff"].as_f64();
    // How small it must be is asked elsewhere.
    assert!(difference.is_some_and(|d| d < 1e-6), "verify is {}", report["verify"]);
    assert_eq!(report["error"]["proved_from"], "rounds", "an exact matrix has no clusters");
}

#[test]
fn by_default_radiosity_is_off_by_a_hundredth_of_its_mean_at_most() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/shadow/shadow.glb");
    let report = object(&[scene, "--element-size", "mesh", "--verify", "--json"], "assemble");
    let off = report["verify"]["rms_rel_diff"].as_f64().expect("a number");
    assert!(off > 0.0 && off <= 0.01, "off by {off} of the mean");
}

#[test]
fn bake_prints_one_object() {
    let batch = object(&["scene.glb", "--element-size", "1", "--json"], "bake");
    let parts = batch["files"][0]["parts"].as_array().expect("a list");
    assert_eq!(parts.len(), 4, "{batch}");
    for key in ["name", "elements", "baked", "form_factors_reason", "stored", "row_sum_defect", "seconds"] {
        assert!(parts[0].get(key).is_some(), "no {key} in {}", parts[0]);
    }
}
