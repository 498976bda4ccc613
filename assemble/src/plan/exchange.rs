//! How parts would exchange light, in a sentence. What can be told before a form factor is computed is how much light from
//! outside each part returns; and that only of parts whose own light is in the cache.

use crate::exchange::Method;
use crate::exchange::coarse::{jacobi_rounds, pays};
use crate::run::Job;
use equilux_bake::oven::Baked;
use equilux_bake::oven::prepare::Prepared;
use equilux_formats::Rgb;

/// The sentence.
pub fn planned(job: &Job, prepared: &Prepared, baked: &[Option<Baked>]) -> String {
    if prepared.instances.len() < 2 {
        return "none: there is one part".into();
    }
    match job.method {
        Method::Jacobi => "block Jacobi, as asked for".into(),
        Method::GaussSeidel => "block Gauss-Seidel, as asked for".into(),
        Method::Gmres => "GMRES with a coarse space, as asked for".into(),
        Method::Auto => {
            let returned = |baked: &Option<Baked>| Some(baked.as_ref()?.part.local.answers.returned);
            match baked.iter().map(returned).collect::<Option<Vec<Rgb>>>() {
                Some(returned) => automatic(&returned, job.goal.error),
                None => "GMRES; with a coarse space if the parts, once baked, return much light".into(),
            }
        }
    }
}

fn automatic(returned: &[Rgb], error: f64) -> String {
    let most = returned.iter().flatten().copied().fold(0.0, f64::max);
    let share = format!("parts return up to {:.1} % of light from outside", 100.0 * most);
    let rounds = jacobi_rounds(most, error).ceil();
    let jacobi =
        if rounds.is_finite() { format!("about {rounds} rounds") } else { "no end of rounds".into() };
    let coarse = if pays(returned.iter().copied(), error) { "with" } else { "without" };
    format!("GMRES {coarse} a coarse space: {share}, so block Jacobi would take {jacobi}")
}
