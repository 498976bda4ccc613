//! Lightmaps: the light of a scene as images that game engines apply to its surfaces.
//!
//! Input: a scene's parts and instances, and a function that computes the irradiance of texels. Output: images,
//! models that carry them, and a list of the positions of all charts in the images.
//!
//! Once for each part and scale: part → sides → charts → grids → atlas. Then: atlas × instances → texels → irradiance
//! → margins → seams → images, models, list.

pub mod atlas;
mod authored;
mod bands;
mod bounds;
pub mod by_rays;
pub mod chart;
pub mod contacts;
mod dilate;
pub mod estimate;
mod field;
pub mod grid;
mod images;
mod knots;
mod least_squares;
pub mod light;
mod listing;
mod model;
mod names;
mod overlap;
pub mod pack;
pub mod patch;
mod seams;
pub mod side;
mod squares;
pub mod texels;
mod tints;
mod traced_chart;
mod write;

pub use images::Units;
pub use write::write;

use atlas::{Atlas, Tile};
use bands::bands;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Error, Material, MaterialId, Result, Rgb, Scene};
use rayon::prelude::*;
use std::ops::Range;
use texels::Texels;
use tints::TintTarget;

/// Options of lightmaps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LightmapOptions {
    /// The size of texels, metres; none for a size that suits the scene.
    pub texel_size: Option<f64>,
    /// The units of the numbers in the images.
    pub units: Units,
    /// Whether to write the mean directions of light, too.
    pub directions: bool,
}

/// A scene with light on its surfaces.
#[derive(Debug)]
pub struct Lightmap<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The layout.
    pub atlas: &'a Atlas,
    /// The charts of all instances.
    pub tiles: Vec<Tile>,
    /// Irradiance, W/m², linear RGB: for each tile one value for each texel of its rectangle, row after row.
    pub irradiance: Vec<Vec<Rgb>>,
    /// The mean direction of the light of each of these texels, if requested: see [`Lightmap::with_directions`].
    pub directions: Option<Vec<Vec<[f64; 3]>>>,
    /// The contents of each of these texels.
    holds: Vec<Vec<Holds>>,
    /// The materials of each instance.
    materials: Vec<Vec<Material>>,
    /// The factors of textures on reflectance and emission of each texel, if there are any.
    tints: Option<[Vec<Vec<Rgb>>; 2]>,
}

/// The contents of a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Holds {
    /// Nothing; the chart is not near.
    Nothing,
    /// Light for lookups next to the chart.
    Margin,
    /// Part of the chart.
    Chart,
}

/// Cost of a texel, in rows of form factors.
pub const ROWS_PER_TEXEL: f64 = 0.1;

impl<'a> Lightmap<'a> {
    /// The lightmap of `scene`. `irradiance` computes the irradiance of texels in their order, W/m², linear RGB, not
    /// divided by π. Fails if the monitor is stopped meanwhile; earlier stops only ended the exchange.
    pub fn new(
        scene: &'a Scene,
        atlas: &'a Atlas,
        irradiance: impl Fn(&Texels) -> Vec<Rgb> + Sync,
        monitor: &Monitor,
    ) -> Result<Self> {
        let tiles = atlas.tiles();
        let values = values(scene, atlas, &tiles, irradiance, ("lightmap", ROWS_PER_TEXEL), monitor)?;
        Self::of_values(scene, atlas, values, monitor)
    }

    /// The lightmap of `scene` with this irradiance of the texels of each tile, W/m²; none for those without light. Fails as
    /// [`Lightmap::new`] does.
    pub fn of_values(
        scene: &'a Scene,
        atlas: &'a Atlas,
        values: Vec<Vec<Option<Rgb>>>,
        monitor: &Monitor,
    ) -> Result<Self> {
        let tiles = atlas.tiles();
        let (mut irradiance, holds) = with_margins(values, &tiles);
        let mut tints = None;
        if let Some(coats) = tints::coats(scene) {
            let tint = |of: TintTarget| {
                let tint = |texels: &Texels| tints::tints(scene, &coats, texels, of);
                let step = ("textures of the lightmap", 0.0);
                let values = self::values(scene, atlas, &tiles, tint, step, monitor)?;
                Ok(with_margins(values, &tiles).0)
            };
            tints = Some([tint(TintTarget::Reflectance)?, tint(TintTarget::Emission)?]);
        }
        seams::close_seams(atlas, &scene.instances, &tiles, &mut irradiance);
        let materials = scene.instances.iter().map(|i| i.materials(&scene.parts[i.part.index()].materials));
        let materials = materials.collect();
        Ok(Self { scene, atlas, materials, tints, tiles, irradiance, directions: None, holds })
    }

    /// Add the mean direction of each texel's light, computed by `directions`: in scene coordinates, weighted by the
    /// luminance from each direction, with a length from 0 (uniform) to 1 (from a single direction). Fails as
    /// [`Lightmap::new`] does.
    pub fn with_directions(
        mut self,
        directions: impl Fn(&Texels) -> Vec<[f64; 3]> + Sync,
        monitor: &Monitor,
    ) -> Result<Self> {
        let values = values(
            self.scene,
            self.atlas,
            &self.tiles,
            |texels: &Texels| directions(texels).into_iter().map(Rgb).collect(),
            ("directions of the lightmap", ROWS_PER_TEXEL),
            monitor,
        )?;
        let tiles = with_margins(values, &self.tiles).0;
        let bare = |tile: Vec<Rgb>| tile.into_iter().map(|Rgb(direction)| direction).collect();
        self.directions = Some(tiles.into_iter().map(bare).collect());
        Ok(self)
    }

    /// The material of a tile.
    pub fn material_of(&self, tile: &Tile) -> (MaterialId, &Material) {
        let id = self.atlas.chart_of(tile).0.material;
        (id, &self.materials[tile.instance][id.index()])
    }

    /// The materials of an instance.
    pub fn materials_of(&self, instance: usize) -> &[Material] {
        &self.materials[instance]
    }

    /// Radiosity B = E + ρH of a texel of a tile, W/m².
    pub fn radiosity(&self, tile: usize, texel: usize) -> Rgb {
        let Material { reflectance, emission, .. } = self.material_of(&self.tiles[tile]).1;
        let h = self.irradiance[tile][texel];
        let tint = |of: usize| self.tints.as_ref().map_or(Rgb::WHITE, |tints| tints[of][tile][texel]);
        let [painted, shining] = [0, 1].map(tint);
        *emission * shining + *reflectance * painted * h
    }
}

/// The values of texels that hold part of a chart, for each tile. `what` and `rows_per_texel`: name and cost of the
/// progress step. Fails if the monitor was stopped meanwhile.
fn values(
    scene: &Scene,
    atlas: &Atlas,
    tiles: &[Tile],
    irradiance: impl Fn(&Texels) -> Vec<Rgb> + Sync,
    (what, rows_per_texel): (&str, f64),
    monitor: &Monitor,
) -> Result<Vec<Vec<Option<Rgb>>>> {
    let in_bands = |(number, tile): (usize, &Tile)| bands(tile.size).map(move |rows| (number, rows));
    let bands: Vec<(usize, Range<u32>)> = tiles.iter().enumerate().flat_map(in_bands).collect();
    let texels: f64 = tiles.iter().map(|tile| tile.size.map(f64::from)).map(|[w, h]| w * h).sum();
    monitor.begin(what, bands.len(), rows_per_texel * texels);
    let before = monitor.stopped();
    let light_in = |(number, rows): &(usize, Range<u32>)| -> Result<Vec<([u32; 2], Rgb)>> {
        if monitor.stopped() != before {
            return Err(Error::Stopped);
        }
        let tile = &tiles[*number];
        let (chart, grid) = atlas.chart_of(tile);
        let placement = scene.instances[tile.instance].placement;
        let texels = Texels::new(chart, grid, rows.clone(), tile.instance, placement);
        let light = irradiance(&texels);
        assert_eq!(light.len(), texels.texels.len(), "one value a texel");
        let wrong = light.iter().position(|h| h.iter().any(|h| !h.is_finite()));
        if let Some((texel, h)) = wrong.map(|number| (texels.texels[number].at, light[number])) {
            panic!("irradiance must be a number, but is {h:?} in texel {texel:?} of tile {number}");
        }
        monitor.advance(1);
        Ok(texels.texels.iter().map(|texel| texel.at).zip(light).collect())
    };
    let lit: Vec<_> = bands.par_iter().map(light_in).collect::<Result<_>>()?;
    let mut values: Vec<Vec<Option<Rgb>>> = tiles.iter().map(|tile| vec![None; tile.texels()]).collect();
    for ((number, _), lit) in bands.iter().zip(lit) {
        let width = tiles[*number].size[0];
        for ([x, y], light) in lit {
            values[*number][(y * width + x) as usize] = Some(light);
        }
    }
    Ok(values)
}

/// Values extended to margins, zero for all other texels, and what each texel holds.
fn with_margins(mut values: Vec<Vec<Option<Rgb>>>, tiles: &[Tile]) -> (Vec<Vec<Rgb>>, Vec<Vec<Holds>>) {
    let whose = |had: &[Option<Rgb>], have: &[Option<Rgb>]| {
        let both = had.iter().zip(have);
        both.map(|(had, have)| match (had, have) {
            (Some(_), _) => Holds::Chart,
            (None, Some(_)) => Holds::Margin,
            (None, None) => Holds::Nothing,
        })
        .collect()
    };
    let fill = |(values, tile): (&mut Vec<Option<Rgb>>, &Tile)| {
        let had = values.clone();
        dilate::dilate(values, tile.size[0]);
        whose(&had, values)
    };
    let holds = values.par_iter_mut().zip(tiles).map(fill).collect();
    let filled = |values: Vec<Option<Rgb>>| values.into_iter().map(Option::unwrap_or_default).collect();
    (values.into_iter().map(filled).collect(), holds)
}
