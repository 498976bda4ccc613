//! Light from outside the scene: the sky, and the units of the file's lights.

use crate::gather::sky::{Radiances, Sky};
use equilux_formats::{LightUnits, Result};

/// The sky, and the units of the file's lights.
#[derive(Debug)]
pub struct Environment {
    /// The units of the intensities of the file's lights; none for the units that each file suggests.
    pub light_units: Option<LightUnits>,
    /// The sky; none for darkness.
    pub sky: Option<Radiances>,
}

impl Environment {
    /// Load the sky's picture, if there is one. Fails if it cannot be read.
    pub fn read(light_units: Option<LightUnits>, sky: Option<&Sky>) -> Result<Self> {
        Ok(Self { light_units, sky: sky.map(Sky::read).transpose()? })
    }
}
