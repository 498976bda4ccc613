//! The light of a whole scene, and what is proved about it.

use crate::rows::Rgb;

/// The answer, one vector an instance, elements in their part's order.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Radiosity B, W/m², linear RGB.
    pub radiosity: Vec<Vec<Rgb>>,
    /// Irradiance H = Σ F B, W/m², not divided by π and without reflectance.
    pub irradiance: Vec<Vec<Rgb>>,
    /// No radiosity is further than this from the exact solution of the equation, W/m².
    pub error_bound: f64,
}
