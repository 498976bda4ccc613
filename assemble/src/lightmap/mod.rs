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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightmapOptions {
    /// The size of texels, metres; none for a size that suits the scene.
    pub texel_size: Option<f64>,
    /// Maximum side of an image, texels, a multiple of 4.
    pub atlas_size: u32,
    /// The units of the numbers in the images.
    pub units: Units,
    /// Whether to write the mean directions of light, too.
    pub directions: bool,
}

impl Default for LightmapOptions {
    /// Images of at most 4096 × 4096 texels; all graphics cards of the last ten years support them.
    fn default() -> Self {
        Self { texel_size: None, atlas_size: 4096, units: Units::default(), directions: false }
    }
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
    /// How many texels each of these is away from the value that it has, [`dilate::NEVER`] for those without one.
    distances: Vec<Vec<u32>>,
    /// The materials of each instance.
    materials: Vec<Vec<Material>>,
    /// The factors of textures on reflectance and emission of each texel, if there are any.
    tints: Option<[Vec<Vec<Rgb>>; 2]>,
}

/// Light below this share of the brightest is darkness: the exchange ends when it is right to a tenth of that.
const DARK: f64 = 1e-5;

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
        // What nothing shines on, such as the foot of a crate that is sunk into a floor, does not darken what something covers.
        let brightest = values.iter().flatten().flatten().flatten().fold(0.0, |most: f64, &h| most.max(h));
        let (mut irradiance, distances) =
            extended(values, &tiles, |light| light.iter().any(|&h| h > DARK * brightest));
        let mut tints = None;
        if let Some(coats) = tints::coats(scene) {
            let tint = |of: TintTarget| {
                let tint = |texels: &Texels| tints::tints(scene, &coats, texels, of);
                let step = ("textures of the lightmap", 0.0);
                let values = self::values(scene, atlas, &tiles, tint, step, monitor)?;
                Ok(extended(values, &tiles, |_| true).0)
            };
            tints = Some([tint(TintTarget::Reflectance)?, tint(TintTarget::Emission)?]);
        }
        seams::close_seams(atlas, &scene.instances, &tiles, &distances, &mut irradiance);
        let materials = scene.instances.iter().map(|i| i.materials(&scene.parts[i.part.index()].materials));
        let materials = materials.collect();
        Ok(Self { scene, atlas, materials, tints, tiles, irradiance, directions: None, distances })
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
        let tiles = extended(values, &self.tiles, |_| true).0;
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

/// Values extended over the rectangles of tiles from those for which `extends` holds, zero where there are none, and how far each
/// is away from where it was.
fn extended(
    mut values: Vec<Vec<Option<Rgb>>>,
    tiles: &[Tile],
    extends: impl Fn(Rgb) -> bool + Sync,
) -> (Vec<Vec<Rgb>>, Vec<Vec<u32>>) {
    let extend =
        |(values, tile): (&mut Vec<Option<Rgb>>, &Tile)| dilate::dilate(values, tile.size[0], &extends);
    let distances = values.par_iter_mut().zip(tiles).map(extend).collect();
    let filled = |values: Vec<Option<Rgb>>| values.into_iter().map(Option::unwrap_or_default).collect();
    (values.into_iter().map(filled).collect(), distances)
}
