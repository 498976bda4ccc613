//! The layout of all charts in the lightmap. Input: a scene's parts and instances. Output: the sizes of the images,
//! and the position of each chart of each instance in them.
//!
//! Charts are laid out once for each part and scale, on one or more sheets; each instance gets its own position for
//! every sheet. Instances thus share their mesh and its texture coordinates, but not their light. A layout by the
//! author is kept where possible.

use super::authored::Sheets;
use super::chart::{Chart, charts};
use super::estimate::{Estimate, PartCharts};
use super::grid::{Grid, MARGIN};
use super::pack::{Spot, pack};
use equilux_formats::{Error, PartId, Result, Scene};
use std::collections::HashMap;
use std::sync::Arc;

/// Maximum side of an image, texels; all graphics cards of the last ten years support it.
const MAX_SIDE: u32 = 4096;
/// Maximum number of texels, sixteen such images; more indicate a mistake in the texel size.
const MAX_TEXELS: f64 = 16.0 * MAX_SIDE as f64 * MAX_SIDE as f64;

/// The layout of the lightmap.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// The size of texels, metres.
    pub texel_size: f64,
    /// The layouts of charts, one for each part and scale.
    pub layouts: Vec<Layout>,
    /// The positions of the instances' sheets.
    pub instances: Vec<Placement>,
    /// The sizes of the images, texels.
    pub images: Vec<[u32; 2]>,
    /// Notes for the report, one sentence each.
    pub notes: Vec<String>,
}

/// A part's charts laid out for one scale.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The part.
    pub part: PartId,
    /// The charts.
    pub charts: Arc<[Chart]>,
    /// The grid of each chart.
    pub grids: Vec<Grid>,
    /// The position of each chart on the sheets.
    pub spots: Vec<Spot>,
    /// The sizes of the sheets, texels.
    pub sheets: Vec<[u32; 2]>,
    /// Width of the border of each sheet that texture coordinates exclude, texels, so that the author's coordinates
    /// are unchanged.
    pub border: u32,
}

/// An instance in the lightmap.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Index of its layout.
    pub layout: usize,
    /// The positions of its layout's sheets in the images.
    pub sheets: Vec<Spot>,
}

/// A chart of an instance in the lightmap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// Index of the instance.
    pub instance: usize,
    /// Index of the chart in its part.
    pub chart: usize,
    /// Position of its rectangle, including the margin.
    pub spot: Spot,
    /// Size of its rectangle, including the margin, texels.
    pub size: [u32; 2],
}

impl Tile {
    /// Number of texels of its rectangle.
    pub fn texels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

impl Atlas {
    /// The atlas of `scene` with texels of `texel_size` metres, or of a size that results in about 1024² texels.
    /// Fails if the texels exceed the limits of images.
    pub fn new(scene: &Scene, texel_size: Option<f64>) -> Result<Self> {
        let mut parts: Vec<PartCharts> = scene.parts.iter().map(PartCharts::of).collect();
        let estimate = Estimate::of(scene, &parts);
        let texel_size = texel_size.unwrap_or_else(|| estimate.suitable_size());
        if estimate.texels(texel_size) > MAX_TEXELS {
            let found = format!("texels of {texel_size} m would be {:.1e}", estimate.texels(texel_size));
            return Err(too_fine(scene, found, format!("at most {MAX_TEXELS:.0e}")));
        }
        let (mut layouts, mut known) = (Vec::new(), HashMap::new());
        let mut of_instance = Vec::new();
        for instance in &scene.instances {
            // Scales that differ only by rounding share a layout.
            let key = (instance.part, (instance.scale().ln() * 1e6).round() as i64);
            let layout = *known.entry(key).or_insert(layouts.len());
            if layout == layouts.len() {
                let part = &mut parts[instance.part.index()];
                layouts.push(lay_out(scene, instance.part, part, texel_size / instance.scale())?);
            }
            of_instance.push(layout);
        }
        let (instances, images) = place(&layouts, &of_instance);
        let named =
            scene.parts.iter().zip(parts).filter_map(|(part, charts)| Some((&part.name, charts.refused?)));
        let notes = named.map(|(name, why)| {
            format!("TEXCOORD_1 of part `{name}` {why}: its lightmap has a new layout, as in lightmapped.glb")
        });
        Ok(Self { texel_size, notes: notes.collect(), layouts, instances, images })
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
        (&layout.charts[tile.chart], &layout.grids[tile.chart])
    }
}

fn lay_out(scene: &Scene, part: PartId, charts: &mut PartCharts, texel: f64) -> Result<Layout> {
    if let Some(authored) = &charts.authored {
        match authored.lay_out(texel, MAX_SIDE) {
            Ok(Sheets { grids, spots, sheets }) => {
                let charts = authored.charts.clone().into();
                return Ok(Layout { part, charts, grids, spots, sheets, border: MARGIN });
            }
            Err(why) => charts.refused = Some(why),
        }
    }
    let own = charts.own.get_or_insert_with(|| self::charts(&scene.parts[part.index()]).into());
    lay_out_own(scene, part, Arc::clone(own), texel)
}

fn lay_out_own(scene: &Scene, part: PartId, charts: Arc<[Chart]>, texel: f64) -> Result<Layout> {
    let grids: Vec<Grid> = charts.iter().map(|chart| Grid::new(chart, texel)).collect();
    let sizes: Vec<[u32; 2]> = grids.iter().map(|grid| grid.size).collect();
    if let Some([width, height]) = sizes.iter().find(|size| size.iter().any(|&side| side > MAX_SIDE)) {
        let name = &scene.parts[part.index()].name;
        let found = format!("a surface of part {name} takes {width} × {height} texels");
        return Err(too_fine(scene, found, format!("at most {MAX_SIDE} × {MAX_SIDE}")));
    }
    let packed = pack(&sizes, MAX_SIDE);
    Ok(Layout { part, charts, grids, spots: packed.spots, sheets: packed.images, border: 0 })
}

fn too_fine(scene: &Scene, found: String, expected: String) -> Error {
    Error::new(&scene.file, found, expected, "choose larger texels with --texel-size METRES")
}

/// A position for each sheet of each instance.
fn place(layouts: &[Layout], of_instance: &[usize]) -> (Vec<Placement>, Vec<[u32; 2]>) {
    let sheets: Vec<[u32; 2]> =
        of_instance.iter().flat_map(|&layout| layouts[layout].sheets.clone()).collect();
    let packed = pack(&sheets, MAX_SIDE);
    let mut spots = packed.spots.into_iter();
    let instances = of_instance.iter().map(|&layout| {
        let sheets = spots.by_ref().take(layouts[layout].sheets.len()).collect();
        Placement { layout, sheets }
    });
    (instances.collect(), packed.images)
}
