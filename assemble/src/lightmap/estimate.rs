//! The charts of parts, and an estimate of the texels that they need. Input: a scene's parts. Output: their charts,
//! and a suitable texel size.

use super::authored::AuthoredLayout;
use super::bounds::Bounds;
use super::chart::{Chart, charts};
use super::grid::MARGIN;
use equilux_formats::{Part, Scene, TexelChoice};
use std::sync::Arc;

/// Default number of texels of an atlas.
const DEFAULT_TEXELS: f64 = 1024.0 * 1024.0;
/// The share of an image that rectangles typically fill.
const FILLED_SHARE: f64 = 0.85;

/// A part's charts, by its author or generated.
#[derive(Debug)]
pub struct PartCharts {
    /// The author's charts.
    pub authored: Option<AuthoredLayout>,
    /// Generated charts, made when needed.
    pub own: Option<Arc<[Chart]>>,
    /// The reason why the author's layout is not used for at least one scale.
    pub refused: Option<&'static str>,
}

impl PartCharts {
    /// The charts of `part`.
    pub fn of(part: &Part) -> Self {
        let (authored, refused) = match AuthoredLayout::of(part) {
            Some(Ok(authored)) => (Some(authored), None),
            Some(Err(why)) => (None, Some(why)),
            None => (None, None),
        };
        let own = authored.is_none().then(|| charts(part).into());
        Self { authored, own, refused }
    }
}

/// The rectangle of a chart, or of an author's layout.
struct Rectangle {
    /// Metres in the part's units.
    extent: [f64; 2],
    /// Texels beyond its extent.
    beyond: f64,
    texels: TexelChoice,
}

impl Rectangle {
    fn of_part(part: &PartCharts) -> Vec<Self> {
        let margins = f64::from(2 * MARGIN);
        match (&part.authored, &part.own) {
            (Some(authored), _) => {
                let sheet = || Self {
                    extent: [authored.stretch; 2],
                    beyond: margins,
                    texels: authored.charts.first().map(|chart| chart.texels).unwrap_or_default(),
                };
                (0..authored.sheets()).map(|_| sheet()).collect()
            }
            (None, own) => {
                let rectangle = |chart: &Chart| Self {
                    extent: Bounds::of(chart).extent.to_array(),
                    beyond: margins + 1.0,
                    texels: chart.texels,
                };
                own.iter().flat_map(|charts| charts.iter()).map(rectangle).collect()
            }
        }
    }

    /// Its texels as a polynomial in 1/t, in an instance of this scale with this choice. Texels of a size that the author chose
    /// are a constant.
    fn coefficients(&self, scale: f64, choice: TexelChoice) -> [f64; 3] {
        let TexelChoice { size, any } = self.texels.or(choice);
        let ([width, height], beyond) = (self.extent.map(|side| side * scale), self.beyond);
        let [a, b, c] = [beyond * beyond, beyond * (width + height), width * height];
        match size {
            _ if any == Some(false) => [0.0; 3],
            Some(size) => [a + b / size + c / (size * size), 0.0, 0.0],
            None => [a, b, c],
        }
    }
}

/// Texels that charts need: with texels of t metres Σ (w/t + m)(h/t + m), where m is the number of texels that a
/// chart needs beyond its extent; a polynomial in 1/t.
#[derive(Debug)]
pub struct Estimate {
    coefficients: [f64; 3],
}

impl Estimate {
    /// The estimate for the instances of `scene`.
    pub fn of(scene: &Scene, parts: &[PartCharts]) -> Self {
        let parts: Vec<Vec<Rectangle>> = parts.iter().map(Rectangle::of_part).collect();
        let mut coefficients = [0.0; 3];
        for instance in &scene.instances {
            for rectangle in &parts[instance.part.index()] {
                let own = rectangle.coefficients(instance.scale(), instance.texels);
                (0..3).for_each(|k| coefficients[k] += own[k]);
            }
        }
        Self { coefficients }
    }

    /// Number of texels of this size, metres, that images will have.
    pub fn texels(&self, size: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        (a + b / size + c / (size * size)) / FILLED_SHARE
    }

    /// The texel size, rounded to two digits, that results in the default number of texels, or in twice the number
    /// for margins alone.
    pub fn suitable_size(&self) -> f64 {
        let [a, b, c] = self.coefficients;
        let spare = (FILLED_SHARE * DEFAULT_TEXELS).max(2.0 * a) - a;
        let size = 2.0 * c / ((b * b + 4.0 * c * spare).sqrt() - b);
        // Printed and parsed, so that the printed size is the size in use.
        if size.is_finite() { format!("{size:.1e}").parse().unwrap_or(size) } else { 1.0 }
    }
}
