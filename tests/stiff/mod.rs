//! The cases with known solutions, as `stability` prints them, one test a theme; and the independence of the solution
//! from the method.

mod methods;

use equilux_tests::cases::{Case, themes};

macro_rules! themes_as_tests {
    ($($theme:ident),* $(,)?) => {
        $(#[test]
        fn $theme() {
            hold(&equilux_tests::cases::$theme::cases());
        })*

        #[test]
        fn no_theme_is_left_out() {
            let names: Vec<&str> = themes().iter().map(|theme| theme.name).collect();
            assert_eq!(names, [$(stringify!($theme)),*]);
        }
    };
}

themes_as_tests!(form_factors, visibility, furnaces, spheres, rooms, scales, splits, stiff, untidy);

fn hold(cases: &[Case]) {
    let failures: Vec<String> = cases.iter().filter_map(failure).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn failure(case: &Case) -> Option<String> {
    let finding = case.found();
    let rounds = case.most_rounds.map(|most| format!(" in {:?} rounds, at most {most}", finding.rounds));
    (!case.holds(&finding)).then(|| {
        format!(
            "{}: expected {}, got {}{}, off by {:e}, more than {:e}: {}",
            case.name,
            finding.expected,
            finding.got,
            rounds.unwrap_or_default(),
            finding.error,
            case.tolerance,
            case.why
        )
    })
}
