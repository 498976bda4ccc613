//! Folders that cannot be written are reported before anything is computed.

use equilux_tests::rooms::square;
use equilux_tests::workshop::Workshop;

#[test]
fn a_file_where_a_folder_should_be_is_named_and_left_alone() {
    for (program, arguments, remedy) in [
        ("bake", &["--cache", "taken"][..], "--cache DIR"),
        ("assemble", &["--cache", "taken"], "--cache DIR"),
        ("assemble", &["--out", "taken"], "--out DIR"),
        ("assemble", &["--out", "taken/below"], "--out DIR"),
        ("assemble", &["--elements", "taken/table.csv"], "--elements FILE.csv"),
        ("assemble", &["--elements", "nowhere/table.csv"], "--elements FILE.csv"),
    ] {
        let workshop = Workshop::with(&square());
        std::fs::write(workshop.path("taken"), "mine").expect("a written file");
        let before = workshop.files("");
        let ended = workshop.run(program, &[&["scene.glb"], arguments].concat());
        let what = format!("{program} {arguments:?}: {}", ended.stderr);
        assert_eq!(ended.code, Some(1), "{what}");
        let named = arguments[1].split('/').next().expect("a name");
        assert!(ended.stderr.starts_with(&format!("error: {named}")), "{what}");
        assert!(ended.stderr.contains(remedy), "no '{remedy}' in {what}");
        assert_eq!(workshop.files(""), before, "files after {what}");
        println!("{what}");
    }
}
