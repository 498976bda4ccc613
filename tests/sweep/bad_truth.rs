//! A table that is not a reference of the scene is refused with an error that names it.

use super::{FOLDER, workshop};

const HEADER: &str = "x,y,z,nx,ny,nz,area,Hc_r,Hc_g,Hc_b";

#[test]
fn a_table_that_is_no_truth_is_a_named_error() {
    let workshop = workshop();
    let cases = [
        ("missing", None, "cannot be read"),
        ("empty", Some(String::new()), "no line"),
        ("columns", Some("x,y,z,area\n1,2,3,4\n".into()), "no column nx"),
        ("lines", Some(format!("{HEADER}\n")), "no line"),
        ("words", Some(format!("{HEADER}\n0,0,0,0,1,0,1,red,1,1\n")), "line 2 has `red` for Hc_r"),
        ("nan", Some(format!("{HEADER}\n0,0,0,0,1,0,1,NaN,1,1\n")), "line 2 has `NaN`"),
        ("area", Some(format!("{HEADER}\n0,0,0,0,1,0,-1,1,1,1\n")), "area of -1"),
        ("ragged", Some(format!("{HEADER}\n0,0,0\n")), "cannot be read"),
        (
            "elsewhere",
            Some(format!("{HEADER}\n900,900,900,0,1,0,1,1,1,1\n")),
            "none of its points lies on a surface",
        ),
    ];
    for (name, text, found) in cases {
        let file = format!("{name}.csv");
        if let Some(text) = text {
            std::fs::write(workshop.path(&file), text).expect("a file");
        }
        let ended = workshop.run("assemble", &["sweep", "scene.glb", "--truth", &file, "--budget", "20"]);
        assert_eq!(ended.code, Some(1), "{name}: {}", ended.stderr);
        assert!(ended.stderr.contains(&file), "{name} is not named: {}", ended.stderr);
        assert!(ended.stderr.contains(found), "{name}: no `{found}` in: {}", ended.stderr);
        assert!(!workshop.path(FOLDER).join("report.html").exists(), "{name}: a report of nothing");
    }
}
