//! Bakes the parts of a glTF file and prints what each returns of the light that it emits:
//! `cargo run --release -p equilux-bake --example bake_parts -- scenes/house/house.gltf`

use equilux_bake::{Monitor, Oven, Preparation, import_scene, prepare};
use equilux_formats::{Rgb, Store};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = PathBuf::from(std::env::args().nth(1).ok_or("name a .gltf or .glb file")?);
    let preparation = Preparation::default();
    let prepared = prepare(&import_scene(&file)?, &preparation)?;
    let (store, monitor) = (Store::open(".equilux")?, Monitor::default());
    let oven = Oven { store: &store, file: &file, resolution: preparation.resolution, monitor: &monitor };
    for part in &prepared.parts {
        let baked = oven.bake(part)?;
        let power = |radiosity: &[Rgb]| -> Rgb {
            let elements = part.geometry.elements.iter();
            elements.zip(radiosity).map(|(element, &b)| b * element.area).sum()
        };
        let [emitted, sent] = [&baked.part.optics.emission, &baked.part.local.radiosity].map(|b| power(b));
        println!(
            "{}: {} elements, {} form factors ({}); emits {:.2} W, sends {:.2} W with what it reflects to itself",
            part.name,
            part.geometry.elements.len(),
            baked.part.self_block.stored(),
            baked.form_factors,
            emitted.into_iter().sum::<f64>(),
            sent.into_iter().sum::<f64>(),
        );
    }
    Ok(())
}
