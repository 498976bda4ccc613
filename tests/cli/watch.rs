//! `assemble --watch` runs again when a file of the scene has changed, and only then, through errors and until Ctrl-C.

use equilux_tests::model::{Model, Node};
use equilux_tests::program::program;
use equilux_tests::rooms::{half, lamp, paint};
use equilux_tests::shapes::{joined, solid};
use equilux_tests::workshop::Workshop;
use glam::dvec3;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Far more than a run takes, and the second within which a broken scene is tried again.
const PATIENCE: Duration = Duration::from_secs(60);

/// Waiting time for the absence of a run: several times the delay of noticing a change.
const SILENCE: Duration = Duration::from_secs(2);

/// The program while it watches; it is ended whatever happens.
struct Watching {
    child: Child,
    lines: Receiver<String>,
}

impl Drop for Watching {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Watching {
    fn scene_of(workshop: &Workshop, more: &[&str]) -> Self {
        let mut child = Command::new(program("assemble"))
            .args(["scene.gltf", "--watch", "--element-size", "1"])
            .args(more)
            .current_dir(workshop.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let (sender, lines) = channel();
        let outs: [Box<dyn Read + Send>; 2] =
            [Box::new(child.stdout.take().expect("a pipe")), Box::new(child.stderr.take().expect("a pipe"))];
        for out in outs {
            let sender = sender.clone();
            std::thread::spawn(move || {
                let lines = BufReader::new(out).lines().map_while(Result::ok);
                // The test may be over.
                lines.for_each(|line| drop(sender.send(line)));
            });
        }
        Self { child, lines }
    }

    fn says(&self, words: &[&str]) {
        let line =
            self.lines.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("nothing said, not {words:?}"));
        words.iter().for_each(|word| assert!(line.contains(word), "no '{word}' in '{line}'"));
    }

    fn is_silent(&self) {
        assert_eq!(self.lines.recv_timeout(SILENCE).ok(), None);
    }
}

/// A scene that stands in two files, with a lamp of this emission in the part.
fn write(workshop: &Workshop, emission: f64) {
    let light = solid(lamp([emission; 3]), dvec3(0.5, 0.5, 0.5), dvec3(1.0, 1.0, 1.0));
    let part = joined([half(paint([0.5; 3]), 0.0), light]);
    std::fs::create_dir_all(workshop.path("parts")).expect("a folder");
    Model::of(&[Node::new("room", part)]).write(&workshop.path("parts/room.glb"));
    let scene = Model::of(&[Node::of_file("one", "parts/room.glb")]);
    std::fs::write(workshop.path("scene.gltf"), text(scene)).expect("a file");
}

/// The JSON of a model without a buffer.
fn text(mut model: Model) -> String {
    for list in ["meshes", "materials", "accessors", "bufferViews", "buffers"] {
        model.json.as_object_mut().expect("an object").remove(list);
    }
    model.json.to_string()
}

#[test]
fn a_saved_file_is_assembled_again_and_an_error_does_not_end_the_watch() {
    let workshop = Workshop::new();
    write(&workshop, 4.0);
    let mut watching = Watching::scene_of(&workshop, &[]);
    watching.says(&["first run: 1 part baked, "]);
    // The pictures that it writes beside the scene are no change, nor is a file saved as it was.
    write(&workshop, 4.0);
    watching.is_silent();

    write(&workshop, 8.0);
    watching.says(&["room.glb changed: 0 parts baked, 0 form factors computed, "]);

    std::fs::write(workshop.path("scene.gltf"), "nonsense").expect("a file");
    watching.says(&["error: scene.gltf: not glTF"]);
    let two = Model::of(&[Node::of_file("one", "parts/room.glb"), Node::of_file("two", "parts/new.glb")]);
    std::fs::write(workshop.path("scene.gltf"), text(two)).expect("a file");
    watching.says(&["error: scene.gltf: node two with the reference 'parts/new.glb'"]);
    std::fs::copy(workshop.path("parts/room.glb"), workshop.path("parts/new.glb")).expect("a copy");
    watching.says(&["scene.gltf changed: 0 parts baked, "]);

    let sent = Command::new("kill").args(["-INT", &watching.child.id().to_string()]).status();
    assert!(sent.expect("kill runs").success());
    let ended = watching.child.wait().expect("it ends");
    assert_eq!(ended.code(), Some(0), "exit code after Ctrl-C");
}

#[test]
fn a_saved_sky_is_a_change_that_computes_nothing() {
    let workshop = Workshop::new();
    write(&workshop, 4.0);
    let sky = |radiance: f32| {
        let picture = image::Rgb32FImage::from_pixel(8, 4, image::Rgb([radiance; 3]));
        picture.save(workshop.path("sky.exr")).expect("a picture");
    };
    sky(1.0);
    let mut watching = Watching::scene_of(&workshop, &["--sky", "sky.exr"]);
    watching.says(&["first run: 1 part baked, "]);
    sky(2.0);
    watching.says(&["sky.exr changed: 0 parts baked, 0 form factors computed, "]);
    watching.child.kill().expect("it runs until then");
    watching.child.wait().expect("it ends");
}
