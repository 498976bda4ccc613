//! One chart as inline SVG: points and lines over two axes, the vertical one logarithmic, the horizontal one too unless it
//! counts. Colours come from the page's style, so that they follow its light or dark scheme.

use maud::{Markup, html};

/// Width and height in units of the drawing, and what labels take of it on the left, right, top and below.
const SIZE: (f64, f64) = (560.0, 400.0);
const MARGIN: (f64, f64, f64, f64) = (56.0, 24.0, 12.0, 46.0);

/// A floor is shown if something lies below so many times it.
const NEAR_FLOOR: f64 = 5.0;

/// Many points that belong together.
pub struct Series {
    /// For the legend.
    pub name: String,
    /// Number of its colour.
    pub colour: usize,
    /// Shape of its points.
    pub mark: Mark,
    /// Whether points are joined, in their order.
    pub line: bool,
    /// Whether the line is dashed.
    pub dashed: bool,
    /// Place and what it says when pointed at.
    pub points: Vec<(f64, f64, String)>,
}

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

/// A chart.
pub struct Chart<'a> {
    /// Above it.
    pub title: &'a str,
    /// Below the horizontal axis.
    pub across: &'a str,
    /// Whether the horizontal axis counts 1, 2, 3.
    pub counts: bool,
    /// How numbers across are written.
    pub across_text: fn(f64) -> String,
    /// How numbers upwards are written.
    pub up_text: fn(f64) -> String,
    /// What is drawn.
    pub series: &'a [Series],
    /// Below this nothing can be told.
    pub floor: f64,
}

/// A range of values on a stretch of the drawing.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    counts: bool,
}

impl Axis {
    fn at(&self, value: f64) -> f64 {
        let share = if self.counts {
            (value - self.low) / (self.high - self.low)
        } else {
            (value / self.low).ln() / (self.high / self.low).ln()
        };
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Values to mark: whole numbers, or 1, 2, 5 times powers of ten, or those powers alone where they are many.
    fn ticks(&self) -> Vec<f64> {
        if self.counts {
            let step = ((self.high - self.low) / 8.0).ceil().max(1.0);
            let count = ((self.high - self.low) / step) as usize;
            return (0..=count).map(|k| (self.low + step * k as f64).round()).collect();
        }
        let decades = (self.high / self.low).log10();
        let digits: &[f64] = if decades > 3.2 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let every = (decades / 8.0).ceil().max(1.0) as usize;
        let powers = (self.low.log10().floor() as i32..=self.high.log10().ceil() as i32).step_by(every);
        let all = powers.flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)));
        all.filter(|&value| value >= self.low * 0.999 && value <= self.high * 1.001).collect()
    }
}

impl Chart<'_> {
    /// The drawing with its legend below it; a sentence if there is nothing to draw.
    pub fn draw(&self) -> Markup {
        let shown = || self.series.iter().flat_map(|s| &s.points).map(|p| (p.0, p.1));
        let Some((across, up)) = self.axes(shown) else {
            return html! { figure { figcaption { (self.title) } p.quiet { "Nothing was run that this could show." } } };
        };
        html! {
            figure {
                figcaption { (self.title) }
                svg viewBox={ "0 0 " (SIZE.0) " " (SIZE.1) } role="img" aria-label=(self.title) {
                    (self.frame(&across, &up))
                    @for series in self.series { (lines(series, &across, &up)) }
                    @for series in self.series { (marks(series, &across, &up)) }
                }
                (self.legend())
            }
        }
    }

    /// The axes that hold all points; none if there are none.
    fn axes<I: Iterator<Item = (f64, f64)>>(&self, shown: impl Fn() -> I) -> Option<(Axis, Axis)> {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let range = values
                .filter(|v| *v > 0.0 && v.is_finite())
                .fold((f64::INFINITY, 0.0), |(l, h), v| (f64::min(l, v), f64::max(h, v)));
            (range.0 <= range.1).then_some(range)
        };
        let (left, right, top, bottom) = MARGIN;
        let (x, y) = (range(&mut shown().map(|p| p.0))?, range(&mut shown().map(|p| p.1))?);
        // Room for the floor only where something comes near it.
        let low = if y.0 < NEAR_FLOOR * self.floor { y.0.min(self.floor * 0.8) } else { y.0 };
        let wide = |(low, high): (f64, f64)| (low / 1.25, high * 1.25);
        let (x, y) =
            (if self.counts { (x.0.min(1.0), x.1.max(x.0 + 1.0)) } else { wide(x) }, wide((low, y.1)));
        let across = Axis { low: x.0, high: x.1, from: left, to: SIZE.0 - right, counts: self.counts };
        let up = Axis { low: y.0, high: y.1, from: SIZE.1 - bottom, to: top, counts: false };
        Some((across, up))
    }

    fn frame(&self, across: &Axis, up: &Axis) -> Markup {
        let (left, right, top, bottom) = MARGIN;
        let (x_end, y_end) = (SIZE.0 - right, SIZE.1 - bottom);
        html! {
            @if self.floor > up.low {
                rect.floor x=(left) y=(px(up.at(self.floor))) width=(x_end - left) height=(px(y_end - up.at(self.floor))) {}
            }
            @for value in across.ticks() {
                line.grid x1=(px(across.at(value))) x2=(px(across.at(value))) y1=(top) y2=(y_end) {}
                text.tick x=(px(across.at(value))) y=(y_end + 17.0) text-anchor="middle" { ((self.across_text)(value)) }
            }
            @for value in up.ticks() {
                line.grid x1=(left) x2=(x_end) y1=(px(up.at(value))) y2=(px(up.at(value))) {}
                text.tick x=(left - 7.0) y=(px(up.at(value) + 4.0)) text-anchor="end" { ((self.up_text)(value)) }
            }
            rect.frame x=(left) y=(top) width=(x_end - left) height=(y_end - top) {}
            text.axis x=((left + x_end) / 2.0) y=(SIZE.1 - 8.0) text-anchor="middle" { (self.across) }
        }
    }

    fn comes_near_floor(&self) -> bool {
        self.series.iter().flat_map(|series| &series.points).any(|point| point.1 < NEAR_FLOOR * self.floor)
    }

    fn legend(&self) -> Markup {
        html! {
            ul.legend {
                @for series in self.series.iter().filter(|series| !series.points.is_empty()) {
                    li {
                        svg viewBox="0 0 30 14" class={ "c" (series.colour) } {
                            @if series.line {
                                line.joined.dashed[series.dashed] x1="1" x2="29" y1="7" y2="7" {}
                            }
                            (shape(series.mark, 15.0, 7.0))
                        }
                        (series.name)
                    }
                }
                @if self.floor > 0.0 && self.comes_near_floor() {
                    li { svg viewBox="0 0 30 14" { rect.floor x="1" y="1" width="28" height="12" {} } "below what the reference can tell" }
                }
            }
        }
    }
}

fn lines(series: &Series, across: &Axis, up: &Axis) -> Markup {
    let place = |p: &(f64, f64, String)| format!("{},{}", px(across.at(p.0)), px(up.at(p.1)));
    let places: Vec<String> = series.points.iter().map(place).collect();
    html! {
        @if series.line && places.len() > 1 {
            g class={ "c" (series.colour) } {
                polyline.joined.dashed[series.dashed] points=(places.join(" ")) {}
            }
        }
    }
}

fn marks(series: &Series, across: &Axis, up: &Axis) -> Markup {
    html! {
        g class={ "c" (series.colour) } {
            @for (x, y, text) in &series.points {
                g { title { (text) } (shape(series.mark, across.at(*x), up.at(*y))) }
            }
        }
    }
}

fn shape(mark: Mark, x: f64, y: f64) -> Markup {
    let polygon = |corners: &[(f64, f64)]| {
        let corners: Vec<String> =
            corners.iter().map(|(dx, dy)| format!("{},{}", px(x + dx), px(y + dy))).collect();
        html! { polygon.mark points=(corners.join(" ")) {} }
    };
    let strokes = |d: String| html! { path.stroke d=(d) {} };
    let (left, right, top, bottom) = (px(x - 4.0), px(x + 4.0), px(y - 4.0), px(y + 4.0));
    match mark {
        Mark::Disc => html! { circle.mark cx=(px(x)) cy=(px(y)) r="4" {} },
        Mark::Ring => html! { circle.stroke cx=(px(x)) cy=(px(y)) r="6.2" {} },
        Mark::Square => polygon(&[(-3.6, -3.6), (3.6, -3.6), (3.6, 3.6), (-3.6, 3.6)]),
        Mark::Triangle => polygon(&[(0.0, -4.8), (4.6, 3.6), (-4.6, 3.6)]),
        Mark::Diamond => polygon(&[(0.0, -5.2), (5.2, 0.0), (0.0, 5.2), (-5.2, 0.0)]),
        Mark::Cross => strokes(format!("M{left},{top}L{right},{bottom}M{left},{bottom}L{right},{top}")),
        Mark::Plus => strokes(format!("M{left},{0}L{right},{0}M{1},{top}L{1},{bottom}", px(y), px(x))),
        Mark::Nothing => html! {},
    }
}

/// A tenth of a unit is finer than anybody sees.
fn px(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}
