//! The charts of parts, and how many texels they will take. In go a scene's parts; out come their charts, and a texel size
//! that suits the scene.

use super::authored::AuthoredLayout;
use super::bounds::Bounds;
use super::chart::{Chart, charts};
use super::grid::MARGIN;
use equilux_formats::{Part, Scene};
use std::sync::Arc;

/// So many texels an atlas gets when nobody says otherwise.
const DEFAULT_TEXELS: f64 = 1024.0 * 1024.0;
/// The share of an image that rectangles fill.
const FILLED: f64 = 0.85;

/// A part's charts, as its author or else we cut them.
#[derive(Debug)]
pub struct PartCharts {
    /// The author's.
    pub authored: Option<AuthoredLayout>,
    /// Ours, made when they are needed.
    pub own: Option<Arc<[Chart]>>,
    /// Why the author's layout is not kept, at least in one place.
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

/// What charts take of an atlas: with texels of t metres Σ (w/t + m)(h/t + m), where m is what a chart takes beyond its
/// extent, a polynomial in 1/t.
#[derive(Debug)]
pub struct Estimate {
    coefficients: [f64; 3],
}

impl Estimate {
    /// What the instances of `scene` take.
    pub fn of(scene: &Scene, parts: &[PartCharts]) -> Self {
        let parts: Vec<[f64; 3]> = parts.iter().map(Self::of_part).collect();
        let mut coefficients = [0.0; 3];
        for instance in &scene.instances {
            let ([a, b, c], scale) = (parts[instance.part.index()], instance.scale());
            coefficients[0] += a;
            coefficients[1] += b * scale;
            coefficients[2] += c * scale * scale;
        }
        Self { coefficients }
    }

    fn of_part(part: &PartCharts) -> [f64; 3] {
        let rectangle = |width: f64, height: f64, beyond: f64| {
            [beyond * beyond, beyond * (width + height), width * height]
        };
        let margins = f64::from(2 * MARGIN);
        let rectangles: Vec<[f64; 3]> = match (&part.authored, &part.own) {
            (Some(authored), _) => {
                vec![rectangle(authored.stretch, authored.stretch, margins); authored.sheets()]
            }
            (None, own) => {
                let extents =
                    own.iter().flat_map(|charts| charts.iter()).map(|chart| Bounds::of(chart).extent);
                extents.map(|extent| rectangle(extent.x, extent.y, margins + 1.0)).collect()
            }
        };
        rectangles.into_iter().fold([0.0; 3], |sum, one| [0, 1, 2].map(|i: usize| sum[i] + one[i]))
    }

    /// How many texels of this size, metres, images will have.
    pub fn texels(&self, size: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        (a + b / size + c / (size * size)) / FILLED
    }

    /// The size, two digits of it, that makes the usual number of texels, or twice what margins alone take.
    pub fn suitable_size(&self) -> f64 {
        let [a, b, c] = self.coefficients;
        let spare = (FILLED * DEFAULT_TEXELS).max(2.0 * a) - a;
        let size = 2.0 * c / ((b * b + 4.0 * c * spare).sqrt() - b);
        // Written out and read again, so that the size printed is the size used.
        if size.is_finite() { format!("{size:.1e}").parse().unwrap_or(size) } else { 1.0 }
    }
}
