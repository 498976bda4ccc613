//! The cases with known answers, as `stability` prints them: one test a theme.

use equilux_tests::cases::{Case, themes};

/// What is known not to hold yet; `stability` shows it.
const NOT_YET: [&str; 11] = [
    // The exchange stops on one bound for all light.
    "sealed rooms, ρ = 0.999 dark and 0.1 bright",
    "red 1e12, blue 1e-12, in one room",
    // It takes more rounds.
    "ρ = 1 but one black floor, 32 parts",
    "ρ = 0.999 but one black floor, 32 parts",
    "two nearly sealed chambers in a part, ρ = 0.999",
    "a lamp in one of six nearly sealed rooms, ρ = 0.999",
    // Faces that are flat but for f32 hide what lies in them.
    "furnace with f32 corners turned, in 8 parts",
    "turned open boxes with f32 corners hide no more than they should",
    // Cells moved to their own origins leave cracks of a rounding.
    "a sheet lets nothing through, in 8 parts",
    // Faces that overlap in one plane are seen both.
    "a rug in the plane of its floor",
    // Only faces within one part are compared.
    "a part placed twice in one place is named",
];

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
    let known = cases.iter().filter(|case| !NOT_YET.contains(&case.name));
    let failures: Vec<String> = known.filter_map(failure).collect();
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
