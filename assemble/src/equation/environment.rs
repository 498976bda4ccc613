//! What lights a scene from outside its elements, beside the lights of its file.

use crate::gather::sky::{Radiances, Sky};
use equilux_formats::{LightUnits, Result};

/// The sky, and the units of the file's lights.
#[derive(Debug)]
pub struct Environment {
    /// The units of the intensities of the file's lights; none for those that each file suggests.
    pub light_units: Option<LightUnits>,
    /// The sky; none for darkness.
    pub sky: Option<Radiances>,
}

impl Environment {
    /// Load the sky's picture, if it is one. Fails if that cannot be read.
    pub fn read(light_units: Option<LightUnits>, sky: Option<&Sky>) -> Result<Self> {
        Ok(Self { light_units, sky: sky.map(Sky::read).transpose()? })
    }
}
