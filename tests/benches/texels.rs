//! Cost of texels of the size of a path tracer's elements, and their difference from its averages.
//! `cargo bench -p equilux-tests --bench texels [-- SCENE ELEMENT_SIZE TOLERANCE]`

use equilux_tests::averages::{Compared, compared};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let number = |k: usize| arguments.get(k).and_then(|a| a.parse().ok());
    println!(
        "{:<10}{:>10}{:>8}{:>18}{:>18}  error, of the mean in RMS",
        "", "elements", "texels", "CPU-s to solve", "CPU-s of texels"
    );
    for (name, size, tolerance) in [("cornell", 0.5, 0.03), ("wood", 0.125, 0.01), ("shadow", 0.25, 0.01)] {
        if arguments.first().is_some_and(|wanted| wanted != name) {
            continue;
        }
        let (size, tolerance) = (number(1).unwrap_or(size), number(2).unwrap_or(tolerance));
        let Compared { errors, counts: [elements, texels], seconds: [solve, light] } =
            compared(name, size, tolerance);
        println!("{name:<10}{elements:>10}{texels:>8}{solve:>18.2}{light:>18.2}  r {}", errors[0]);
        println!("{:>66}  g {}", "", errors[1]);
        println!("{:>66}  b {}", "", errors[2]);
    }
}
