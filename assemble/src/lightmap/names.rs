//! NamedBytes names of lightmaps.

/// The first image has no number: mostly it is the only one.
pub fn name(number: usize, ending: &str) -> String {
    if number == 0 { format!("lightmap.{ending}") } else { format!("lightmap-{}.{ending}", number + 1) }
}

/// The same of directions.
pub fn direction_name(number: usize) -> String {
    if number == 0 {
        "lightmap_direction.exr".into()
    } else {
        format!("lightmap_direction-{}.exr", number + 1)
    }
}
