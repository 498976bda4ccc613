//! The solid angle Ω of a polygon, triangle by triangle: tan(Ω/2) = a·(b × c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|) with
//! corners a, b, c. Van Oosterom & Strackee 1983.

use glam::DVec3;

/// The solid angle under which a convex polygon is seen from the origin, sr; negative if its corners run counter-clockwise
/// as seen from there.
pub fn solid_angle(polygon: &[DVec3]) -> f64 {
    let a = polygon[0];
    let triangle = |b: DVec3, c: DVec3| {
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        // By differences, so that small polygons far away keep their digits.
        let volume = a.dot((b - a).cross(c - a));
        2.0 * volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    polygon.windows(2).skip(1).map(|edge| triangle(edge[0], edge[1])).sum()
}
