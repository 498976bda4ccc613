//! `stability [PART OF A NAME]`: the cases with known answers as a table. Exit code 1 if a claim does not hold.

use equilux_tests::cases::{Case, themes};
use std::process::ExitCode;

fn main() -> ExitCode {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    println!("| case | expected | got | error | tolerance | rounds | verdict |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    let (mut run, mut failed) = (0, 0);
    for theme in themes() {
        for case in theme.cases.iter().filter(|case| case.name.contains(&wanted)) {
            run += 1;
            failed += usize::from(!shown(theme.name, case));
        }
    }
    println!("\n{run} cases, {failed} failed");
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn shown(theme: &str, case: &Case) -> bool {
    let finding = case.found();
    let holds = case.holds(&finding);
    let mut rounds = finding.rounds.map_or("-".into(), |rounds| rounds.to_string());
    if let Some(most) = case.most_rounds {
        rounds = format!("{rounds} ≤ {most}");
    }
    let verdict = if holds { "holds".into() } else { format!("FAILS ({})", case.why) };
    println!(
        "| {theme}: {} | {} | {} | {:.1e} | {:.0e} | {rounds} | {verdict} |",
        case.name, finding.expected, finding.got, finding.error, case.tolerance
    );
    holds
}
