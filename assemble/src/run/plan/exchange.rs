//! Describes the planned exchange method in a sentence. Before form factors are computed, the method depends only on
//! the share of light from outside that each part returns, which is known for parts whose local equilibrium is in the
//! cache.

use crate::exchange::coarse::{jacobi_rounds, pays};
use crate::exchange::settings::Method;
use crate::solve::settings::SolveSettings;
use equilux_bake::oven::Baked;
use equilux_bake::oven::prepare::Prepared;
use equilux_formats::Rgb;

/// The description of the exchange.
pub fn planned(settings: &SolveSettings, prepared: &Prepared, baked: &[Option<Baked>]) -> String {
    if prepared.instances.len() < 2 {
        return "none: there is one part".into();
    }
    match settings.method {
        Method::Jacobi => "block Jacobi, as requested".into(),
        Method::GaussSeidel => "block Gauss-Seidel, as requested".into(),
        Method::Gmres => "GMRES with a coarse space, as requested".into(),
        Method::Auto => {
            let returned = |baked: &Option<Baked>| Some(baked.as_ref()?.part.local.answers.returned);
            match baked.iter().map(returned).collect::<Option<Vec<Rgb>>>() {
                Some(returned) => automatic(&returned, settings.goal.error),
                None => "GMRES; with a coarse space if the parts, once baked, return much light".into(),
            }
        }
    }
}

fn automatic(returned: &[Rgb], error: f64) -> String {
    let most = returned.iter().flatten().copied().fold(0.0, f64::max);
    let share = format!("parts return up to {:.1} % of light from outside", 100.0 * most);
    let rounds = jacobi_rounds(most, error).ceil();
    let jacobi = if rounds.is_finite() {
        format!("about {rounds} rounds")
    } else {
        "an unlimited number of rounds".into()
    };
    let coarse = if pays(returned.iter().copied(), error) { "with" } else { "without" };
    format!("GMRES {coarse} a coarse space: {share}, so block Jacobi would take {jacobi}")
}
