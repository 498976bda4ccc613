//! The shapes of a chart's points, as SVG.

use maud::{Markup, html};

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    /// ●
    Disc,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ◆
    Diamond,
    /// ×
    Cross,
    /// +
    Plus,
    /// ○, large, around another.
    Ring,
    /// None.
    Nothing,
}

/// The shape around a place, units of the drawing.
pub fn shape(mark: Mark, x: f64, y: f64) -> Markup {
    let polygon = |corners: &[(f64, f64)]| {
        let corners: Vec<String> =
            corners.iter().map(|(dx, dy)| format!("{},{}", px(x + dx), px(y + dy))).collect();
        html! { polygon.mark points=(corners.join(" ")) {} }
    };
    let strokes = |d: String| html! { path.stroke d=(d) {} };
    let (left, right, top, bottom) = (px(x - 4.0), px(x + 4.0), px(y - 4.0), px(y + 4.0));
    match mark {
        Mark::Disc => html! { circle.mark cx=(px(x)) cy=(px(y)) r="4" {} },
        Mark::Ring => html! { circle.stroke cx=(px(x)) cy=(px(y)) r="7" {} },
        Mark::Square => polygon(&[(-3.6, -3.6), (3.6, -3.6), (3.6, 3.6), (-3.6, 3.6)]),
        Mark::Triangle => polygon(&[(0.0, -4.8), (4.6, 3.6), (-4.6, 3.6)]),
        Mark::Diamond => polygon(&[(0.0, -5.2), (5.2, 0.0), (0.0, 5.2), (-5.2, 0.0)]),
        Mark::Cross => strokes(format!("M{left},{top}L{right},{bottom}M{left},{bottom}L{right},{top}")),
        Mark::Plus => strokes(format!("M{left},{0}L{right},{0}M{1},{top}L{1},{bottom}", px(y), px(x))),
        Mark::Nothing => html! {},
    }
}

/// A coordinate rounded to a tenth of a unit, which is finer than a pixel.
pub fn px(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}
