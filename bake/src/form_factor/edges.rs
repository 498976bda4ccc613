//! Contour sums of many small polygons. Edges are collected and evaluated together.

use super::contour;
use super::wide::{STEEP, angle_over_sine, vectorised};
use glam::DVec3;
use std::f64::consts::PI;

/// Edges that are not evaluated yet, each with the index of the value it contributes to.
#[derive(Debug, Default)]
pub struct Edges {
    cosine: Vec<f64>,
    /// n·(a×b) of the unit vectors to the edge's ends, signed.
    triple: Vec<f64>,
    value: Vec<u32>,
}

impl Edges {
    /// Adds `sign` times the form factor of a polygon (corners relative to the receiver's point, above its horizon) to
    /// `values[value]`, at once or at [`Edges::flush`].
    pub fn add(&mut self, polygon: &[DVec3], normal: DVec3, sign: f64, value: usize, values: &mut [f64]) {
        let first = self.cosine.len();
        let mut a = polygon[polygon.len() - 1].normalize();
        let mut lowest = 1.0f64;
        for corner in polygon {
            let b = corner.normalize();
            let cosine = a.dot(b);
            lowest = lowest.min(cosine);
            self.cosine.push(cosine);
            self.triple.push(sign * normal.dot(a.cross(b)));
            self.value.push(value as u32);
            a = b;
        }
        if lowest < STEEP {
            self.cosine.truncate(first);
            self.triple.truncate(first);
            self.value.truncate(first);
            values[value] += sign * contour::contour(polygon, normal);
        }
    }

    /// Evaluates all collected edges.
    pub fn flush(&mut self, values: &mut [f64]) {
        if self.cosine.is_empty() {
            return;
        }
        vectorised(|| {
            for (triple, &cosine) in self.triple.iter_mut().zip(&self.cosine) {
                *triple *= angle_over_sine(cosine);
            }
        });
        for (&triple, &value) in self.triple.iter().zip(&self.value) {
            values[value as usize] -= triple / (2.0 * PI);
        }
        self.cosine.clear();
        self.triple.clear();
        self.value.clear();
    }
}
