//! From the unknowns of the exchange to all elements: an element of a patch receives what the patch receives, and reflects and
//! emits what it does itself.

use crate::equation::Equation;
use crate::exchange::energy::Energy;
use crate::exchange::listener::{FinishedRound, Listener};
use crate::exchange::outcome::Outcome;
use equilux_formats::Rgb;
use std::ops::Range;

impl Equation {
    /// The irradiance of all elements, W/m², from that of all unknowns along the rows: with D.
    pub fn irradiance_of_elements(&self, of_unknowns: &[Rgb]) -> Vec<Rgb> {
        let direct = self.direct.irradiance.iter().flatten();
        let whole: Vec<Rgb> = of_unknowns.iter().zip(direct).map(|(&h, &d)| h + d).collect();
        self.by_instance(&whole, |k, own| self.spread(k, own)).concat()
    }

    /// The radiosity of all elements, W/m², from what the exchange found for all unknowns.
    pub fn radiosity_of_elements(&self, of_unknowns: &[Rgb]) -> Vec<Rgb> {
        self.by_instance(of_unknowns, |k, own| self.radiosity_of(k, own)).concat()
    }

    /// What the exchange starts from, W/m², from a radiosity of all elements by instance.
    pub fn start_from(&self, radiosity: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let of = |(k, own): (usize, &Vec<Rgb>)| {
            let means = self.placed.means_of_unknowns(k, own);
            means.iter().zip(&self.direct.apart[k]).map(|(&b, &a)| b - a).collect()
        };
        radiosity.iter().enumerate().map(of).collect()
    }

    /// The outcome of an exchange between unknowns as one of elements.
    pub fn of_elements(&self, outcome: Outcome) -> Outcome {
        if !self.placed.is_by_rays() {
            return outcome;
        }
        let irradiance = self.by_instance(&outcome.irradiance, |k, own| self.spread(k, own)).concat();
        let mut outcome = Outcome { irradiance, ..outcome };
        let first = self.first_flight();
        outcome.convergence.energy += first;
        outcome.rounds.iter_mut().for_each(|round| round.convergence.energy += first);
        outcome.radiosity = self.radiosity_of_elements(&outcome.radiosity);
        for round in &mut outcome.rounds {
            round.radiosity = round.radiosity.as_ref().map(|light| self.radiosity_of_elements(light));
        }
        outcome
    }

    /// The power that travels by D instead of along the rows, less what the exchange takes for emission.
    fn first_flight(&self) -> Energy {
        let mut first = Energy::default();
        for (k, system) in self.systems().iter().enumerate() {
            let lights = self.direct.apart[k].iter().zip(&self.direct.from_apart[k]);
            for ((&area, &rho), (&apart, &arriving)) in
                system.areas.iter().zip(&system.optics.reflectance).zip(lights)
            {
                let (sent, arrived) = (apart * area, arriving * area);
                first += Energy {
                    emitted: sent - rho * arrived,
                    absorbed: arrived - rho * arrived,
                    escaped: sent - arrived,
                    travelling: Rgb::BLACK,
                };
            }
        }
        first
    }

    fn radiosity_of(&self, instance: usize, own: &[Rgb]) -> Vec<Rgb> {
        let geometry = &self.placed.part_of(instance).part.geometry;
        let optics = self.placed.optics_of(instance);
        let mean = geometry.optics_of_unknowns(&optics);
        let reflected = |i: usize| -> Rgb {
            let reflected = own[i] + self.direct.apart[instance][i] - mean.emission[i];
            let rho = mean.reflectance[i];
            Rgb::from_fn(|c| if rho[c] > 0.0 { reflected[c] / rho[c] } else { 0.0 })
        };
        let arriving: Vec<Rgb> = (0..own.len()).map(reflected).collect();
        let elements = optics.emission.iter().zip(&optics.reflectance).zip(self.spread(instance, &arriving));
        elements.map(|((&e, &rho), h)| e + rho * h).collect()
    }

    /// For each element the value of its unknown.
    fn spread(&self, instance: usize, own: &[Rgb]) -> Vec<Rgb> {
        match &self.placed.part_of(instance).part.geometry.patches {
            None => own.to_vec(),
            Some(patches) => patches.of.iter().map(|&patch| own[patch as usize]).collect(),
        }
    }

    /// What `of` makes of each instance's values.
    fn by_instance(&self, all: &[Rgb], of: impl Fn(usize, &[Rgb]) -> Vec<Rgb>) -> Vec<Vec<Rgb>> {
        let ends = (0..self.placed.instances.len()).scan(0, |end, k| {
            *end += self.placed.unknowns_of(k);
            Some(*end)
        });
        let range = |(k, end): (usize, usize)| -> (usize, Range<usize>) {
            (k, end - self.placed.unknowns_of(k)..end)
        };
        ends.enumerate().map(range).map(|(k, own)| of(k, &all[own])).collect()
    }
}

/// Passes the rounds of an exchange between unknowns on as rounds of elements.
#[derive(Debug)]
pub struct ElementListener<'a, L: ?Sized> {
    /// The equation that is solved.
    pub equation: &'a Equation,
    /// Who listens.
    pub listener: &'a L,
}

impl<L: Listener + ?Sized> Listener for ElementListener<'_, L> {
    fn round(&self, finished: &FinishedRound) {
        if !self.equation.placed.is_by_rays() {
            return self.listener.round(finished);
        }
        let mut elements = Vec::new();
        let mut rest = finished.radiosity;
        for &instance in finished.instances {
            let (own, after) = rest.split_at(self.equation.placed.unknowns_of(instance));
            elements.extend(self.equation.radiosity_of(instance, own));
            rest = after;
        }
        self.listener.round(&FinishedRound { radiosity: &elements, ..*finished });
    }

    fn ends_exchange(&self) -> bool {
        self.listener.ends_exchange()
    }
}
