//! NamedBytes names of lightmaps.

/// The file name of image `number`; the first has no number, since it is usually the only one.
pub fn name(number: usize, ending: &str) -> String {
    if number == 0 { format!("lightmap.{ending}") } else { format!("lightmap-{}.{ending}", number + 1) }
}

/// The file name of the directions of image `number`.
pub fn direction_name(number: usize) -> String {
    if number == 0 {
        "lightmap_direction.exr".into()
    } else {
        format!("lightmap_direction-{}.exr", number + 1)
    }
}
