//! Impossible and untidy scenes are refused or repaired with a message, never silently wrong.

use super::solve::{Setting, light, solved, uniform};
use super::{Case, Finding};
use crate::model::Node;
use crate::rooms::{half, lamp};
use crate::shapes::{grey, joined, moved, part, rectangle, room, solid, triangle};
use equilux_formats::{Material, Part, Rgb};
use glam::{DAffine3, DVec3, dvec3};

/// The cases.
pub fn cases() -> Vec<Case> {
    let said = "it is said or it is not";
    let sums = "hundreds of edge terms of 1e-16";
    vec![
        Case::new("closed, ρ = 1, a lamp", 0.0, said, || refused(&[furnace([1.0; 3])], 1)),
        Case::new("closed, ρ = 1, a lamp, in 8 parts", 0.0, said, || refused(&[furnace([1.0; 3])], 8)),
        Case::new("closed, ρ = 1 in blue alone", 0.0, said, || refused(&[furnace([0.5, 0.5, 1.0])], 1)),
        Case::new("a closed ρ = 1 box in an open scene", 0.0, said, || {
            let open = half(grey(0.5, 1.0), 0.0);
            let open = moved(open, DAffine3::from_translation(DVec3::splat(9.0)));
            refused(&[Node::new("open", open), furnace([1.0; 3])], 1)
        }),
        Case::new("closed, ρ = 1, no lamp", 0.0, "no light is exactly none", || dark(1)),
        Case::new("closed, ρ = 1, no lamp, in 8 parts", 0.0, "no light is exactly none", || dark(8)),
        Case::new("faces without area are counted", 0.0, said, || noted(&[spoilt()], "3 faces without area")),
        Case::new("faces without area change no row", 1e-12, sums, || {
            light(&[spoilt()], &Setting::metres(0.5)).row_sums()
        }),
        Case::new("duplicate faces are named", 0.0, said, || noted(&[twice()], "6 duplicate faces")),
        Case::new("duplicate faces add up to nothing more", 1e-12, sums, || {
            light(&[twice()], &Setting::metres(0.5)).row_sums()
        }),
        Case::new("a part placed twice in one place is named", 0.0, said, || {
            noted(&placed_twice(), "in one plane")
        }),
        Case::new("a part placed twice adds up to nothing more", 1e-12, sums, || {
            no_more_than_all(&placed_twice())
        }),
        Case::new("a rug in the plane of its floor is named", 0.0, said, || {
            noted(&[Node::new("room", joined([cube(), rug()]))], "in one plane")
        }),
        Case::new("a rug of another part in the plane of its floor", 1e-12, sums, || {
            no_more_than_all(&[Node::new("room", cube()), Node::new("rug", rug())])
        }),
        Case::new("an instance without area is named", 0.0, said, || {
            noted(&[Node::new("room", cube()), nothing()], "none of its faces has an area")
        }),
        Case::new("an instance without area changes nothing", 1e-12, sums, || {
            light(&[Node::new("room", cube()), nothing()], &Setting::metres(0.5)).worst(uniform)
        }),
        Case::new("digits that f32 lost are named", 0.0, said, || {
            let far = moved(
                solid(grey(0.5, 1.0), DVec3::ZERO, DVec3::splat(0.5)),
                DAffine3::from_translation(DVec3::splat(1e6)),
            );
            noted(&[Node::new("far", far)], "places are rounded")
        }),
    ]
}

fn cube() -> Part {
    room(grey(0.5, 1.0), DVec3::ZERO, DVec3::ONE)
}

/// A closed room that emits.
fn furnace(reflectance: [f64; 3]) -> Node {
    let paint = Material { reflectance: Rgb(reflectance), ..lamp([1.0; 3]) };
    Node::new("furnace", room(paint, DVec3::ZERO, DVec3::ONE))
}

fn refused(nodes: &[Node], cells: usize) -> Finding {
    let said = match solved(nodes, &Setting::metres(0.5).cut(cells)) {
        Ok(solved) => format!("an answer after {} rounds", solved.report.rounds.len()),
        Err(error) => error.to_string(),
    };
    let holds = said.contains("grows without end");
    Finding::statement("refused: light grows without end", said, holds)
}

fn dark(cells: usize) -> Finding {
    let paint = Material { emission: Rgb::BLACK, ..grey(1.0, 0.0) };
    let room = Node::new("room", room(paint, DVec3::ZERO, DVec3::ONE));
    let solved = light(&[room], &Setting::metres(0.5).cut(cells));
    let all = solved.elements.iter().flat_map(|lit| lit.radiosity);
    Finding::worst_absolute(all.map(|b| (0.0, b))).after(solved.rounds())
}

fn noted(nodes: &[Node], words: &str) -> Finding {
    let notes = light(nodes, &Setting::metres(0.5)).report.notes;
    let found = notes.iter().find(|note| note.contains(words));
    Finding::statement(words, found.map_or_else(|| format!("{notes:?}"), String::clone), found.is_some())
}

/// A room with faces that repeat a corner, or have all corners on a line.
fn spoilt() -> Node {
    let (a, b, c) = (DVec3::splat(0.25), DVec3::splat(0.5), DVec3::splat(0.75));
    let spoilt = [[a, a, b], [a, b, c], [c, c, c]].into_iter().fold(part(grey(0.5, 1.0)), triangle);
    Node::new("room", joined([cube(), spoilt]))
}

fn twice() -> Node {
    Node::new("room", joined([cube(), cube()]))
}

fn placed_twice() -> [Node; 3] {
    let crate_ = solid(grey(0.5, 1.0), DVec3::splat(0.25), DVec3::splat(0.5));
    [Node::new("room", cube()), Node::new("crate", crate_.clone()), Node::new("crate again", crate_)]
}

fn nothing() -> Node {
    Node::new("nothing", triangle(part(grey(0.5, 1.0)), [DVec3::ZERO, DVec3::X, DVec3::X * 2.0]))
}

/// On the floor, not above it.
fn rug() -> Part {
    rectangle(part(grey(0.3, 1.0)), dvec3(0.25, 0.25, 0.), DVec3::X * 0.5, DVec3::Y * 0.5)
}

/// Σ F ≤ 1 in every row.
fn no_more_than_all(nodes: &[Node]) -> Finding {
    light(nodes, &Setting::metres(0.25)).row_sums()
}
