//! A surface that shines.

use crate::rays::hemisphere::Emitters;
use crate::world::place_element;
use equilux_formats::Element;
use equilux_formats::fingerprint::Content;
use glam::{DAffine3, DVec3};

/// A surface that shines: a polygon, or several that are no plane together.
#[derive(Debug)]
pub struct Source {
    elements: Vec<Element>,
    /// Places on it.
    pub(super) places: Emitters,
    /// Square metres.
    pub(super) area: f64,
    /// Follows from the elements and their places alone.
    pub(super) identity: u64,
}

impl Source {
    /// The surface of these elements, in scene coordinates.
    pub fn new(elements: Vec<Element>) -> Self {
        let corners = elements.iter().flat_map(|element| element.corners.as_slice());
        let numbers: Vec<f64> = corners.flat_map(|corner| corner.to_array()).collect();
        let identity = Content::new().f64s(&numbers).digest().first_bytes();
        Self::with_identity(elements, identity)
    }

    fn with_identity(elements: Vec<Element>, identity: u64) -> Self {
        let (places, area) = (Emitters::new(&elements), elements.iter().map(|element| element.area).sum());
        Self { elements, places, area, identity }
    }

    /// Its corners.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.elements.iter().flat_map(|element| element.corners.as_slice()).copied()
    }

    /// A number that follows from its form and place.
    pub fn identity(&self) -> u64 {
        self.identity
    }

    /// The same as the next of several sources at one place.
    pub fn next_twin(self) -> Self {
        Self { identity: Content::new().bytes(self.identity.to_le_bytes()).digest().first_bytes(), ..self }
    }

    /// The same source elsewhere.
    pub(super) fn moved(&self, by: DAffine3) -> Self {
        let elements = self.elements.iter().map(|element| place_element(element, by, 0)).collect();
        Self::with_identity(elements, self.identity)
    }

    /// The polygon, unless there are several.
    pub(super) fn polygon(&self) -> Option<&Element> {
        if let [polygon] = self.elements.as_slice() { Some(polygon) } else { None }
    }
}
