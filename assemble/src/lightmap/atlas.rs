//! Where every instance's charts lie in the lightmap. In go a scene's parts and instances; out come images' sizes and a
//! place in them for each chart of each instance.
//!
//! Charts are laid out once for each part and scale, on one or more sheets; each instance gets its own place for every
//! sheet. So instances share their mesh with its texture coordinates, but not their light. A layout that the author made
//! is kept where it can be.

use super::authored::Sheets;
use super::chart::{Chart, charts};
use super::estimate::{Estimate, PartCharts};
use super::grid::{Grid, MARGIN};
use super::pack::{Spot, pack};
use equilux_formats::{Error, PartId, Result, Scene};
use std::collections::HashMap;
use std::sync::Arc;

/// The longest side of an image, texels; every graphics card of the last ten years takes it.
const LONGEST: u32 = 4096;
/// More texels than sixteen such images are a mistake in the texel size, not a lightmap.
const MOST_TEXELS: f64 = 16.0 * LONGEST as f64 * LONGEST as f64;

/// The lightmap's plan.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// The size of texels, metres.
    pub texel_size: f64,
    /// How charts are laid out, for each part and scale.
    pub layouts: Vec<Layout>,
    /// Where the instances' sheets lie.
    pub instances: Vec<Placement>,
    /// The sizes of the images, texels.
    pub images: Vec<[u32; 2]>,
    /// What a person should know of it, one sentence each.
    pub notes: Vec<String>,
}

/// A part's charts laid out for one scale.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The part.
    pub part: PartId,
    /// The charts.
    pub charts: Arc<[Chart]>,
    /// A grid for each chart.
    pub grids: Vec<Grid>,
    /// Where each chart lies on the sheets.
    pub spots: Vec<Spot>,
    /// The sizes of the sheets, texels.
    pub sheets: Vec<[u32; 2]>,
    /// How many texels of each sheet's border texture coordinates leave out, so that an author's are as they were.
    pub border: u32,
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

impl Tile {
    /// How many texels its rectangle has.
    pub fn texels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

impl Atlas {
    /// The atlas of `scene` with texels of `texel_size` metres, or of a size that makes about 1024² of them. Fails where
    /// that would be more than images can hold.
    pub fn new(scene: &Scene, texel_size: Option<f64>) -> Result<Self> {
        let mut parts: Vec<PartCharts> = scene.parts.iter().map(PartCharts::of).collect();
        let estimate = Estimate::of(scene, &parts);
        let texel_size = texel_size.unwrap_or_else(|| estimate.suitable_size());
        if estimate.texels(texel_size) > MOST_TEXELS {
            let found = format!("texels of {texel_size} m would be {:.1e}", estimate.texels(texel_size));
            return Err(too_fine(scene, found, format!("at most {MOST_TEXELS:.0e}")));
        }
        let (mut layouts, mut known) = (Vec::new(), HashMap::new());
        let mut of_instance = Vec::new();
        for instance in &scene.instances {
            // Scales that differ by rounding only share a layout.
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
            format!("TEXCOORD_1 of part `{name}` {why}: its lightmap is laid out anew, as in lightmapped.glb")
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
        match authored.lay_out(texel, LONGEST) {
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
    if let Some([width, height]) = sizes.iter().find(|size| size.iter().any(|&side| side > LONGEST)) {
        let name = &scene.parts[part.index()].name;
        let found = format!("a surface of part {name} takes {width} × {height} texels");
        return Err(too_fine(scene, found, format!("at most {LONGEST} × {LONGEST}")));
    }
    let packed = pack(&sizes, LONGEST);
    Ok(Layout { part, charts, grids, spots: packed.spots, sheets: packed.images, border: 0 })
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
