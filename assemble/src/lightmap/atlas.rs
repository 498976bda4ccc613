//! The layout of all charts in the lightmap. Input: a scene's parts and instances. Output: the sizes of the images,
//! and the position of each chart of each instance in them.
//!
//! Charts are laid out once for each part and scale, on one or more sheets; each instance gets its own position for
//! every sheet. Instances thus share their mesh and its texture coordinates, but not their light. A layout by the
//! author is kept where possible.

use super::LightmapOptions;
use super::authored::{AuthoredLayout, Sheets};
use super::chart::{Chart, charts};
use super::estimate::{Estimate, PartCharts};
use super::grid::{Grid, MARGIN};
use super::pack::{Spot, pack};
use super::side::SurfaceSide;
use equilux_formats::{Error, Instance, PartId, Result, Scene, TexelChoice};
use std::collections::HashMap;
use std::sync::Arc;

/// Maximum number of texels, sixteen images of 4096 × 4096; more indicate a mistake in the texel size.
const MAX_TEXELS: f64 = 16.0 * 4096.0 * 4096.0;
/// Sides of images are multiples of this: blocks of compressed textures are that wide.
const BLOCK: u32 = 4;

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
    /// The charts that have texels.
    pub charts: Arc<[Chart]>,
    /// The sides that have none, because the author wants so.
    pub without_texels: Vec<SurfaceSide>,
    /// The grid of each chart.
    pub grids: Vec<Grid>,
    /// The maximum size of the texels of each chart, metres of the scene.
    pub texel_sizes: Vec<f64>,
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
        Self::of(scene, &LightmapOptions { texel_size, ..LightmapOptions::default() })
    }

    /// The atlas of `scene` with these options. Fails as [`Atlas::new`] does.
    pub fn of(
        scene: &Scene,
        &LightmapOptions { texel_size, atlas_size, .. }: &LightmapOptions,
    ) -> Result<Self> {
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
            let TexelChoice { size, any } = instance.texels;
            let scale = (instance.scale().ln() * 1e6).round() as i64;
            let layout =
                *known.entry((instance.part, scale, size.map(f64::to_bits), any)).or_insert(layouts.len());
            if layout == layouts.len() {
                let layer = Layer { scene, instance, texel_size, limit: atlas_size };
                layouts.push(layer.lay_out(&mut parts[instance.part.index()])?);
            }
            of_instance.push(layout);
        }
        let (instances, images) = place(&layouts, &of_instance, atlas_size);
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

    /// The maximum size of the texels of a tile, metres of the scene.
    pub fn texel_size_of(&self, tile: &Tile) -> f64 {
        self.layout_of(tile.instance).texel_sizes[tile.chart]
    }
}

/// Lays out the charts of an instance's part.
struct Layer<'a> {
    scene: &'a Scene,
    instance: &'a Instance,
    /// The size of texels where the author chose none, metres of the scene.
    texel_size: f64,
    /// Maximum side of an image, texels.
    limit: u32,
}

impl Layer<'_> {
    fn lay_out(&self, charts: &mut PartCharts) -> Result<Layout> {
        let part = self.instance.part;
        if let Some(authored) = &charts.authored {
            match self.lay_out_authored(authored) {
                Ok(layout) => return Ok(layout),
                Err(why) => charts.refused = Some(why),
            }
        }
        let own = charts.own.get_or_insert_with(|| self::charts(&self.scene.parts[part.index()]).into());
        self.lay_out_own(&Arc::clone(own))
    }

    fn has_texels(&self, chart: &Chart) -> bool {
        chart.texels.or(self.instance.texels).any != Some(false)
    }

    /// The maximum size of the texels of a chart, metres of the scene.
    fn size_of(&self, chart: &Chart) -> f64 {
        chart.texels.or(self.instance.texels).size.unwrap_or(self.texel_size)
    }

    /// The author's layout with the finest texels that any of its charts wants, or the reason why that is impossible.
    fn lay_out_authored(&self, authored: &AuthoredLayout) -> std::result::Result<Layout, &'static str> {
        let wanted = authored.charts.iter().filter(|chart| self.has_texels(chart));
        let size = wanted.map(|chart| self.size_of(chart)).fold(f64::INFINITY, f64::min);
        let Sheets { grids, spots, sheets } = match size.is_finite() {
            true => authored.lay_out(size / self.instance.scale(), self.limit)?,
            false => Sheets { grids: vec![], spots: vec![], sheets: vec![] },
        };
        let all: Arc<[Chart]> = authored.charts.clone().into();
        let numbers: Vec<usize> = (0..grids.len()).filter(|&chart| self.has_texels(&all[chart])).collect();
        let (charts, without_texels) = self.with_and_without(&all);
        Ok(Layout {
            part: self.instance.part,
            without_texels,
            texel_sizes: vec![size; charts.len()],
            charts,
            grids: numbers.iter().map(|&chart| grids[chart].clone()).collect(),
            spots: numbers.iter().map(|&chart| spots[chart]).collect(),
            sheets,
            border: MARGIN,
        })
    }

    fn lay_out_own(&self, charts: &Arc<[Chart]>) -> Result<Layout> {
        let Self { scene, instance, limit, .. } = *self;
        let (charts, without_texels) = self.with_and_without(charts);
        let texel_sizes: Vec<f64> = charts.iter().map(|chart| self.size_of(chart)).collect();
        let grids = charts.iter().zip(&texel_sizes);
        let grids: Vec<Grid> = grids.map(|(chart, size)| Grid::new(chart, size / instance.scale())).collect();
        let sizes: Vec<[u32; 2]> = grids.iter().map(|grid| grid.size).collect();
        if let Some([width, height]) = sizes.iter().find(|size| size.iter().any(|&side| side > limit)) {
            let name = &scene.parts[instance.part.index()].name;
            let found = format!("a surface of part {name} takes {width} × {height} texels");
            return Err(too_fine(scene, found, format!("at most {limit} × {limit}")));
        }
        let packed = pack(&sizes, limit);
        let (spots, sheets) = (packed.spots, packed.images);
        Ok(Layout {
            part: instance.part,
            charts,
            without_texels,
            grids,
            texel_sizes,
            spots,
            sheets,
            border: 0,
        })
    }

    /// The charts that have texels, and the sides of those that have none.
    fn with_and_without(&self, charts: &Arc<[Chart]>) -> (Arc<[Chart]>, Vec<SurfaceSide>) {
        if charts.iter().all(|chart| self.has_texels(chart)) {
            return (Arc::clone(charts), vec![]);
        }
        let (with, without): (Vec<&Chart>, Vec<&Chart>) =
            charts.iter().partition(|chart| self.has_texels(chart));
        (with.into_iter().cloned().collect(), without.iter().flat_map(|chart| chart.sides.clone()).collect())
    }
}

fn too_fine(scene: &Scene, found: String, expected: String) -> Error {
    let remedy = "choose larger texels with --texel-size METRES or texel_size in the node's extras, or larger images with \
                  --atlas-size TEXELS";
    Error::new(&scene.file, found, expected, remedy)
}

/// A position for each sheet of each instance.
fn place(layouts: &[Layout], of_instance: &[usize], limit: u32) -> (Vec<Placement>, Vec<[u32; 2]>) {
    let sheets: Vec<[u32; 2]> =
        of_instance.iter().flat_map(|&layout| layouts[layout].sheets.clone()).collect();
    let packed = pack(&sheets, limit);
    let mut spots = packed.spots.into_iter();
    let instances = of_instance.iter().map(|&layout| {
        let sheets = spots.by_ref().take(layouts[layout].sheets.len()).collect();
        Placement { layout, sheets }
    });
    let whole_blocks = |size: [u32; 2]| size.map(|side| side.next_multiple_of(BLOCK));
    (instances.collect(), packed.images.into_iter().map(whole_blocks).collect())
}
