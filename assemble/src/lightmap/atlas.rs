//! Where every instance's charts lie in the lightmap. In go a scene's parts and instances; out come images' sizes and a
//! place in them for each chart of each instance.
//!
//! Charts are laid out once for each part and scale, on one or more sheets; each instance gets its own place for every
//! sheet. So instances share their mesh with its texture coordinates, but not their light.

use super::chart::{Chart, charts};
use super::grid::{Bounds, Grid, MARGIN};
use super::pack::{Spot, pack};
use equilux_formats::{Error, Instance, PartId, Result, Scene};
use std::collections::HashMap;

/// The longest side of an image, texels; every graphics card of the last ten years takes it.
const LONGEST: u32 = 4096;
/// More texels than sixteen such images are a mistake in the texel size, not a lightmap.
const MOST_TEXELS: f64 = 16.0 * LONGEST as f64 * LONGEST as f64;
/// So many texels an atlas gets when nobody says otherwise.
const DEFAULT_TEXELS: f64 = 1024.0 * 1024.0;
/// The share of an image that rectangles fill.
const FILLED: f64 = 0.85;

/// The lightmap's plan.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// The size of texels, metres.
    pub texel_size: f64,
    /// The charts of each part.
    pub charts: Vec<Vec<Chart>>,
    /// How charts are laid out, for each part and scale.
    pub layouts: Vec<Layout>,
    /// Where the instances' sheets lie.
    pub instances: Vec<Placement>,
    /// The sizes of the images, texels.
    pub images: Vec<[u32; 2]>,
}

/// A part's charts laid out for one scale.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The part.
    pub part: PartId,
    /// A grid for each chart.
    pub grids: Vec<Grid>,
    /// Where each chart lies on the sheets.
    pub spots: Vec<Spot>,
    /// The sizes of the sheets, texels.
    pub sheets: Vec<[u32; 2]>,
}

/// An instance in the lightmap.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Its layout.
    pub layout: usize,
    /// Where its layout's sheets lie in the images.
    pub sheets: Vec<Spot>,
}

/// A chart of an instance in the lightmap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// The instance, by number.
    pub instance: usize,
    /// The chart of its part, by number.
    pub chart: usize,
    /// Its rectangle's place, margin included.
    pub spot: Spot,
    /// Its rectangle's size, margin included, texels.
    pub size: [u32; 2],
}

impl Atlas {
    /// The atlas of `scene` with texels of `texel_size` metres, or of a size that makes about 1024² of them. Fails where
    /// that would be more than images can hold.
    pub fn new(scene: &Scene, texel_size: Option<f64>) -> Result<Self> {
        let charts: Vec<Vec<Chart>> = scene.parts.iter().map(charts).collect();
        let estimate = Estimate::of(scene, &charts);
        let texel_size = texel_size.unwrap_or_else(|| estimate.suitable_size());
        if estimate.texels(texel_size) > MOST_TEXELS {
            let found = format!("texels of {texel_size} m would be {:.1e}", estimate.texels(texel_size));
            return Err(too_fine(scene, found, format!("at most {MOST_TEXELS:.0e}")));
        }
        let (mut layouts, mut known) = (Vec::new(), HashMap::new());
        let mut of_instance = Vec::new();
        for instance in &scene.instances {
            // Scales that differ by rounding only share a layout.
            let key = (instance.part, (scale(instance).ln() * 1e6).round() as i64);
            let layout = *known.entry(key).or_insert(layouts.len());
            if layout == layouts.len() {
                let texel = texel_size / scale(instance);
                layouts.push(lay_out(scene, instance.part, &charts[instance.part.index()], texel)?);
            }
            of_instance.push(layout);
        }
        let (instances, images) = place(&layouts, &of_instance);
        Ok(Self { texel_size, charts, layouts, instances, images })
    }

    /// The layout of an instance.
    pub fn layout_of(&self, instance: usize) -> &Layout {
        &self.layouts[self.instances[instance].layout]
    }

    /// All charts of all instances, instance after instance.
    pub fn tiles(&self) -> Vec<Tile> {
        (0..self.instances.len()).flat_map(|instance| self.tiles_of(instance)).collect()
    }

    fn tiles_of(&self, instance: usize) -> impl Iterator<Item = Tile> {
        let layout = self.layout_of(instance);
        layout.grids.iter().zip(&layout.spots).enumerate().map(move |(chart, (grid, on_sheet))| {
            let Spot { image, at } = self.instances[instance].sheets[on_sheet.image];
            let at = [at[0] + on_sheet.at[0], at[1] + on_sheet.at[1]];
            Tile { instance, chart, spot: Spot { image, at }, size: grid.size }
        })
    }

    /// The chart of a tile, and the grid on it.
    pub fn chart_of(&self, tile: &Tile) -> (&Chart, &Grid) {
        let layout = self.layout_of(tile.instance);
        (&self.charts[layout.part.index()][tile.chart], &layout.grids[tile.chart])
    }
}

fn lay_out(scene: &Scene, part: PartId, charts: &[Chart], texel: f64) -> Result<Layout> {
    let grids: Vec<Grid> = charts.iter().map(|chart| Grid::new(chart, texel)).collect();
    let sizes: Vec<[u32; 2]> = grids.iter().map(|grid| grid.size).collect();
    if let Some([width, height]) = sizes.iter().find(|size| size.iter().any(|&side| side > LONGEST)) {
        let name = &scene.parts[part.index()].name;
        let found = format!("a surface of part {name} takes {width} × {height} texels");
        return Err(too_fine(scene, found, format!("at most {LONGEST} × {LONGEST}")));
    }
    let packed = pack(&sizes, LONGEST);
    Ok(Layout { part, grids, spots: packed.spots, sheets: packed.images })
}

fn too_fine(scene: &Scene, found: String, expected: String) -> Error {
    Error::new(&scene.file, found, expected, "choose larger texels with --texel-size METRES")
}

/// A place for each sheet of each instance.
fn place(layouts: &[Layout], of_instance: &[usize]) -> (Vec<Placement>, Vec<[u32; 2]>) {
    let sheets: Vec<[u32; 2]> =
        of_instance.iter().flat_map(|&layout| layouts[layout].sheets.clone()).collect();
    let packed = pack(&sheets, LONGEST);
    let mut spots = packed.spots.into_iter();
    let instances = of_instance.iter().map(|&layout| {
        let sheets = spots.by_ref().take(layouts[layout].sheets.len()).collect();
        Placement { layout, sheets }
    });
    (instances.collect(), packed.images)
}

/// The factor of an instance's placement on lengths.
pub fn scale(instance: &Instance) -> f64 {
    instance.placement.matrix3.determinant().abs().cbrt()
}

/// What charts take of an atlas: with texels of t metres Σ (w/t + m)(h/t + m), where m is what a chart takes beyond its
/// extent, a polynomial in 1/t.
struct Estimate {
    coefficients: [f64; 3],
}

impl Estimate {
    fn of(scene: &Scene, charts: &[Vec<Chart>]) -> Self {
        let beyond = f64::from(2 * MARGIN + 1);
        let of_part = |charts: &Vec<Chart>| {
            let extents = charts.iter().map(|chart| Bounds::of(chart).extent);
            extents.fold([0.0; 3], |[n, lengths, areas], e| [n + 1.0, lengths + e.x + e.y, areas + e.x * e.y])
        };
        let parts: Vec<[f64; 3]> = charts.iter().map(of_part).collect();
        let mut coefficients = [0.0; 3];
        for instance in &scene.instances {
            let ([count, lengths, areas], scale) = (parts[instance.part.index()], scale(instance));
            coefficients[0] += count * beyond * beyond;
            coefficients[1] += lengths * beyond * scale;
            coefficients[2] += areas * scale * scale;
        }
        Self { coefficients }
    }

    fn texels(&self, size: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        (a + b / size + c / (size * size)) / FILLED
    }

    /// The size, two digits of it, that makes the usual number of texels, or twice what margins alone take.
    fn suitable_size(&self) -> f64 {
        let [a, b, c] = self.coefficients;
        let spare = (FILLED * DEFAULT_TEXELS).max(2.0 * a) - a;
        let size = 2.0 * c / ((b * b + 4.0 * c * spare).sqrt() - b);
        // Written out and read again, so that the size printed is the size used.
        if size.is_finite() { format!("{size:.1e}").parse().unwrap_or(size) } else { 1.0 }
    }
}
