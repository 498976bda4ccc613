//! No choice beats one on the front, and every other choice is beaten or equalled by one on it.

use equilux_assemble::sweep::front::front;
use proptest::prelude::*;

/// Few different values, so that there are ties.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![(0..8u8).prop_map(f64::from), Just(f64::NAN)]
}

fn beats(a: (f64, f64), b: (f64, f64)) -> bool {
    a.0 <= b.0 && a.1 <= b.1 && a != b
}

proptest! {
    #[test]
    fn no_choice_beats_one_on_the_front_and_every_other_is_matched_by_one(
        choices in prop::collection::vec((value(), value()), 0..30)
    ) {
        let front = front(&choices);
        let numbers: Vec<_> = choices.iter().copied().filter(|c| !c.0.is_nan() && !c.1.is_nan()).collect();
        prop_assert_eq!(front.is_empty(), numbers.is_empty());
        for &chosen in &front {
            let beaten = numbers.iter().find(|other| beats(**other, choices[chosen]));
            prop_assert_eq!(beaten, None, "{:?} is on the front", choices[chosen]);
        }
        for choice in numbers {
            let matched = front.iter().any(|&chosen| choices[chosen] == choice || beats(choices[chosen], choice));
            prop_assert!(matched, "{:?} is worse than nothing on the front", choice);
        }
        let costs: Vec<f64> = front.iter().map(|&chosen| choices[chosen].0).collect();
        prop_assert!(costs.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", costs);
    }
}
