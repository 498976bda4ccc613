//! One chart as inline SVG: points and lines over two axes, the vertical one logarithmic. Each chart is drawn twice, for
//! wide and for narrow windows; the page's style shows one of them. Colours come from the style too, so that they follow
//! its light or dark scheme.

use super::axis::{Axis, Scale, Tick};
use super::mark::{Mark, px, shape};
use maud::{Markup, html};

/// A floor is shown if a point lies below this many times it.
const NEAR_FLOOR: f64 = 5.0;

/// The width of a character of a label, and the gap between labels, units of the drawing.
const CHARACTER: f64 = 6.6;
const GAP: f64 = 9.0;

/// The distance between labels of the vertical axis, units of the drawing.
const LINE: f64 = 20.0;

/// The size of a drawing, in units that are about a pixel.
struct Layout {
    class: &'static str,
    width: f64,
    height: f64,
}

const LAYOUTS: [Layout; 2] = [
    Layout { class: "roomy", width: 560.0, height: 400.0 },
    Layout { class: "narrow", width: 360.0, height: 320.0 },
];

/// What labels take of a drawing on the left, right, top and below.
const MARGIN: (f64, f64, f64, f64) = (52.0, 14.0, 26.0, 46.0);

/// Points that belong together.
pub struct Series {
    /// For the legend.
    pub name: String,
    /// Number of its colour in the style.
    pub colour: usize,
    /// Shape of its points.
    pub mark: Mark,
    /// Whether a line joins the points, in their order.
    pub line: bool,
    /// Whether the line is dashed.
    pub dashed: bool,
    /// Place of each point, and the text that is shown when it is pointed at.
    pub points: Vec<(f64, f64, String)>,
}

/// A chart.
pub struct Chart<'a> {
    /// Above it.
    pub title: &'a str,
    /// Below the horizontal axis.
    pub across: &'a str,
    /// Above the vertical axis.
    pub up: &'a str,
    /// The horizontal axis.
    pub across_scale: Scale,
    /// How numbers across are written.
    pub across_text: fn(f64) -> String,
    /// How numbers upwards are written.
    pub up_text: fn(f64) -> String,
    /// What is drawn.
    pub series: &'a [Series],
    /// Values below this cannot be told from zero.
    pub floor: f64,
}

impl Chart<'_> {
    /// The drawings with the legend below; none if there is no point to draw.
    pub fn draw(&self) -> Option<Markup> {
        let ranges = self.ranges()?;
        Some(html! {
            figure {
                figcaption { (self.title) }
                @for layout in &LAYOUTS { (self.drawing(layout, ranges)) }
                (self.legend())
            }
        })
    }

    /// The ranges across and upwards that hold all points, with some room around them; none if there are no points.
    fn ranges(&self) -> Option<[(f64, f64); 2]> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = range(points().map(|point| point.0))?;
        let y = range(points().map(|point| point.1))?;
        let low = if self.is_near_floor() { y.0.min(self.floor * 0.8) } else { y.0 };
        let wide = |(low, high): (f64, f64)| (low / 1.25, high * 1.25);
        let across = match self.across_scale {
            Scale::Counting => (x.0.min(1.0), x.1.max(x.0 + 1.0)),
            Scale::Logarithmic => wide(x),
        };
        Some([across, wide((low, y.1))])
    }

    fn drawing(&self, layout: &Layout, [across, up]: [(f64, f64); 2]) -> Markup {
        let (left, right, top, bottom) = MARGIN;
        let x = Axis { range: across, places: (left, layout.width - right), scale: self.across_scale };
        let y = Axis { range: up, places: (layout.height - bottom, top), scale: Scale::Logarithmic };
        html! {
            svg class=(layout.class) viewBox={ "0 0 " (layout.width) " " (layout.height) } role="img" aria-label=(self.title) {
                (self.frame(&x, &y))
                @for series in self.series { (lines(series, &x, &y)) }
                @for series in self.series { (marks(series, &x, &y)) }
            }
        }
    }

    fn frame(&self, x: &Axis, y: &Axis) -> Markup {
        let ((left, right), (bottom, top)) = (x.places, y.places);
        let width = |value: f64| (self.across_text)(value).chars().count() as f64 * CHARACTER + GAP;
        html! {
            @if self.is_near_floor() {
                rect.floor x=(left) y=(px(y.at(self.floor))) width=(right - left) height=(px(bottom - y.at(self.floor))) {}
            }
            @for tick in x.ticks(width) {
                line class=(grid(&tick)) x1=(px(x.at(tick.value))) x2=(px(x.at(tick.value))) y1=(top) y2=(bottom + tail(&tick)) {}
                @if tick.is_labelled {
                    text.tick x=(px(x.at(tick.value))) y=(bottom + 18.0) text-anchor="middle" { ((self.across_text)(tick.value)) }
                }
            }
            @for tick in y.ticks(|_| LINE) {
                line class=(grid(&tick)) x1=(left - tail(&tick)) x2=(right) y1=(px(y.at(tick.value))) y2=(px(y.at(tick.value))) {}
                @if tick.is_labelled {
                    text.tick x=(left - 8.0) y=(px(y.at(tick.value) + 4.0)) text-anchor="end" { ((self.up_text)(tick.value)) }
                }
            }
            rect.frame x=(left) y=(top) width=(right - left) height=(bottom - top) {}
            text.axis x=(right) y=(bottom + 38.0) text-anchor="end" { (self.across) " →" }
            text.axis x="2" y=(top - 11.0) { "↑ " (self.up) }
        }
    }

    fn is_near_floor(&self) -> bool {
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
                @if self.is_near_floor() {
                    li { svg viewBox="0 0 30 14" { rect.floor x="1" y="1" width="28" height="12" {} } "within the reference's own error" }
                }
            }
        }
    }
}

/// The least and the largest of the positive numbers, if there are any.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values
        .filter(|value| *value > 0.0 && value.is_finite())
        .fold((f64::INFINITY, 0.0), |(low, high), value| (f64::min(low, value), f64::max(high, value)));
    (low <= high).then_some((low, high))
}

/// The class of a tick's grid line.
fn grid(tick: &Tick) -> &'static str {
    if tick.is_major { "grid" } else { "grid fine" }
}

/// How far a tick reaches out of the frame, units of the drawing.
fn tail(tick: &Tick) -> f64 {
    if tick.is_major || tick.is_labelled { 5.0 } else { 3.0 }
}

fn lines(series: &Series, x: &Axis, y: &Axis) -> Markup {
    let place = |p: &(f64, f64, String)| format!("{},{}", px(x.at(p.0)), px(y.at(p.1)));
    let places: Vec<String> = series.points.iter().map(place).collect();
    html! {
        @if series.line && places.len() > 1 {
            g class={ "c" (series.colour) } {
                polyline.joined.dashed[series.dashed] points=(places.join(" ")) {}
            }
        }
    }
}

fn marks(series: &Series, x: &Axis, y: &Axis) -> Markup {
    html! {
        g class={ "c" (series.colour) } {
            @for (across, up, text) in &series.points {
                g { title { (text) } (shape(series.mark, x.at(*across), y.at(*up))) }
            }
        }
    }
}
