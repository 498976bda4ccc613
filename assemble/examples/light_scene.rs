//! Lights a scene and prints the irradiance of its brightest element, and that at a point beside it:
//! `cargo run --release -p equilux-assemble --example light_scene -- scenes/house/house.gltf`

use equilux_assemble::{Place, SolveSettings, light_at, solve};
use equilux_bake::Monitor;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = PathBuf::from(std::env::args().nth(1).ok_or("name a .gltf or .glb file")?);
    let solved = solve(&file, &SolveSettings::default())?;
    let brightness = |element: usize| solved.irradiance[element].luminance();
    let all = 0..solved.elements().len();
    let brightest =
        all.max_by(|&a, &b| brightness(a).total_cmp(&brightness(b))).ok_or("the scene is empty")?;
    let element = &solved.elements()[brightest];
    println!("{:.2?} W/m² at {:.2}", solved.irradiance[brightest].0, element.centroid);

    let corner = element.corners.as_slice()[0];
    let place = Place { point: element.centroid.lerp(corner, 0.5), normal: element.normal };
    let gather = solved.gather();
    let lights =
        light_at(|points| gather.irradiance(points), solved.elements(), &[place], &Monitor::default())?;
    if let Some(light) = &lights[0] {
        println!("{:.2?} W/m² at {:.2}, gathered there", light.irradiance.0, place.point);
    }
    Ok(())
}
