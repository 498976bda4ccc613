//! Sample values of every kind of file, and helpers to write and read them.

use equilux_formats::baked::{
    BakedGeometry, BakedLight, BoundaryResponses, Escapes, Factors, LocalEquilibrium, Lu,
};
use equilux_formats::container::Reader;
use equilux_formats::fingerprint::{Content, Manifest};
use equilux_formats::rows::{Precision, RowGroup};
use equilux_formats::stored::Stored;
use equilux_formats::{
    ClusterTree, Corners, Element, Error, Face, FaceId, Geometry, LocalSolver, MaterialId, Optics, Rgb, Rows,
};
use glam::DVec3;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

pub fn manifest() -> Manifest {
    Manifest::new()
        .setting("kernel", 1)
        .digest("geometry of hall", Content::new().f64s(&[1.0, 2.0]).digest())
        .setting("element size", "0.25 m")
}

/// A quad and a triangle far from the origin, in coordinates that no short decimal has.
pub fn part() -> BakedGeometry {
    let at = |x: f64, y: f64| DVec3::new(x / 3.0 + 1e4, y / 7.0 - 0.1, -0.0);
    let quad = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let triangle = [at(2.0, 0.0), at(3.0, 0.0), at(2.0, 1.0)];
    let elements = vec![
        Element::new(Corners::quad(quad), MaterialId(0), FaceId(0)),
        Element::new(Corners::triangle(triangle).flipped(), MaterialId(1), FaceId(1)),
    ];
    let faces = vec![Face::new(quad.to_vec()), Face::new(triangle.to_vec())];
    let areas: Vec<f64> = elements.iter().map(|element| element.area).collect();
    let clusters = ClusterTree::new(&areas, vec![[0, 1]]).unwrap();
    let self_block = Rows::from_rows(3, [vec![(1, 0.1 + 0.2)], vec![(0, 1e-300), (1, 0.0)]]);
    let geometry = Geometry { elements, faces, clusters, patches: None };
    BakedGeometry { geometry, self_block, escapes: Escapes::default() }
}

pub fn light() -> BakedLight {
    let lu = |pivot| Lu { size: 2, packed: vec![pivot, 0.5, -0.25, 0.75], rows: vec![1, 0] };
    let factors = Some(Factors { channels: vec![lu(1.0), lu(0.9)], of_channel: [0, 1, 0] });
    let optics = Optics {
        reflectance: vec![Rgb([0.5, 0.25, 0.5]); 2],
        emission: vec![Rgb::BLACK, Rgb([10.0, 1e12, 1e-12])],
    };
    let answers = BoundaryResponses {
        radiosity: vec![vec![Rgb([0.5, 0.25, 0.0]); 2]],
        matrix: vec![Rgb([0.125, 1e-9, 0.0])],
        returned: Rgb([0.75, 0.5, 0.0]),
    };
    let radiosity = vec![Rgb::splat(1.0 / 3.0); 2];
    let local = LocalEquilibrium { solver: LocalSolver::Direct, radiosity, factors, answers };
    BakedLight { optics, local }
}

pub fn coupling() -> Rows {
    let together = RowGroup { columns: vec![0, 4], values: vec![0.125, 1e-9, 0.0, 0.25], receivers: 2 };
    let alone = RowGroup { columns: vec![2], values: vec![1.0], receivers: 1 };
    Rows::from_groups(5, [together, alone], Precision::Single)
}

pub fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub fn written<T: Stored>(folder: &TempDir, value: &T) -> (PathBuf, Vec<u8>) {
    let path = folder.path().join("whole.eqx");
    value.write(&manifest()).write_to(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    (path, bytes)
}

pub fn read<T: Stored>(path: &Path) -> Result<T, Error> {
    T::read(&mut Reader::open(path, T::KIND)?)
}

pub fn read_bytes<T: Stored>(folder: &TempDir, bytes: &[u8]) -> Result<T, Error> {
    let path = folder.path().join("changed.eqx");
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}
