//! The coarse space: corrects light that travels back and forth between parts many times. Input: the residual v.
//! Output: a sum of the parts' boundary responses whose image under A has the same weighted averages as the residual.
//!
//! With the responses as columns of C, y solves (Cᵀ D A C) y = Cᵀ D v, with the areas in D; C y starts the parts' own
//! corrections. Nicolaides 1987 for the idea; Tang, Nabben, Vuik & Erlangga 2009 for the ways to combine the two.

use crate::exchange::groups::{Group, ranges};
use crate::exchange::system::InstanceSystem;
use equilux_bake::equilibrium::direct::{factorise_dense, solve};
use equilux_formats::Rgb;
use equilux_formats::baked::Factors;
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of unknowns: their dense matrix then costs less than a second.
const MAX_UNKNOWNS: usize = 1024;

/// Maximum number of unknowns of a part: the number of boundary responses that a part has.
const MAX_PART_UNKNOWNS: usize = 7;

/// No coarse space is used if block Jacobi would need at most this many rounds.
const MAX_ROUNDS_WITHOUT: f64 = 16.0;

/// The factored coarse equation of a group.
#[derive(Debug)]
pub struct Coarse<'a> {
    group: &'a Group<'a>,
    /// Each member's unknowns.
    unknowns: Vec<Range<usize>>,
    factors: Factors,
}

/// Whether a coarse space pays off for solving to `error`, relative to the brightest radiosity. `returned`: the share
/// of uniform light from outside that each part returns, 0..1. A round of block Jacobi reduces the residual of
/// uniform light to at most the largest of these shares.
pub fn pays(returned: impl Iterator<Item = Rgb>, error: f64) -> bool {
    jacobi_rounds(returned.flatten().fold(0.0, f64::max), error) > MAX_ROUNDS_WITHOUT
}

/// Approximate number of block Jacobi rounds needed to reach `error`, relative to the brightest radiosity, if each
/// round leaves this share of the error.
pub fn jacobi_rounds(share: f64, error: f64) -> f64 {
    if share < 1.0 { error.max(f64::EPSILON).ln() / share.ln() } else { f64::INFINITY }
}

impl<'a> Coarse<'a> {
    /// The coarse equation; none for fewer than two parts, too many parts, or parts without boundary responses.
    pub fn of(group: &'a Group<'a>) -> Option<Self> {
        let each = (MAX_UNKNOWNS / group.members.len().max(1)).min(MAX_PART_UNKNOWNS);
        let unknowns = ranges(group.systems().map(|system| system.answers.radiosity.len().min(each)));
        let size = unknowns.last().map_or(0, |last| last.end);
        if group.members.len() < 2 || size == 0 {
            return None;
        }
        let coupling = coupling(group, &unknowns);
        let row = |row: usize| -> Vec<Rgb> {
            let member = unknowns.partition_point(|range| range.end <= row);
            let (answers, own) = (&group.system(member).answers, &unknowns[member]);
            let (count, first) = (answers.radiosity.len(), row - own.start);
            let mut entries: Vec<Rgb> =
                coupling[member][first * size..][..size].iter().map(|entry| entry.map(|f| -f)).collect();
            let inside = &answers.matrix[first * count..][..own.len()];
            entries[own.clone()].iter_mut().zip(inside).for_each(|(entry, &own)| *entry += own);
            for channel in (0..3).filter(|&c| inside[first][c] == 0.0) {
                // This channel does not have the response.
                entries.iter_mut().for_each(|entry| entry[channel] = 0.0);
                entries[row][channel] = 1.0;
            }
            entries
        };
        let entries: Vec<Rgb> = (0..size).flat_map(row).collect();
        Some(Self { group, factors: factorise_dense(size, &entries), unknowns })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.unknowns.last().map_or(0, |last| last.end)
    }

    /// The sum of boundary responses; none if all averages of the residual are zero. Vectors of the group, W/m².
    pub fn correct(&self, residual: &[Rgb]) -> Option<Vec<Rgb>> {
        let members = || (0..self.group.members.len()).into_par_iter();
        let averages: Vec<Rgb> = members().flat_map_iter(|m| self.weighted_averages(m, residual)).collect();
        if averages.iter().all(|average| *average == Rgb::BLACK) {
            return None;
        }
        let shares = solve(&self.factors, &averages);
        // Where nothing removes light from the scene, the coarse equation has no solution either.
        let finite = shares.iter().all(|share| share.iter().all(|share| share.is_finite()));
        finite.then(|| members().flat_map_iter(|m| self.sum_of_answers(m, &shares)).collect())
    }

    /// Σ_i A_i a_i v_i for each response a of a member.
    fn weighted_averages(&self, member: usize, residual: &[Rgb]) -> Vec<Rgb> {
        let system = self.group.system(member);
        let residual = &residual[self.group.elements_of(member)];
        let product = |answer: &Vec<Rgb>| {
            let terms = answer.iter().zip(residual).enumerate();
            terms.fold(Rgb::BLACK, |sum, (i, (&a, &v))| {
                sum + (a * v).map(|av| av * system.clusters.area_of(i))
            })
        };
        system.answers.radiosity[..self.unknowns[member].len()].iter().map(product).collect()
    }

    fn sum_of_answers(&self, member: usize, shares: &[Rgb]) -> Vec<Rgb> {
        let mut sum = vec![Rgb::BLACK; self.group.elements_of(member).len()];
        let answers = &self.group.system(member).answers.radiosity;
        for (&share, answer) in shares[self.unknowns[member].clone()].iter().zip(answers) {
            sum.iter_mut().zip(answer).for_each(|(sum, &a)| *sum += share * a);
        }
        sum
    }
}

/// Σ_i A_i a_i ρ_i Σ_j F_ij b_j for the responses a of one member and b of all others, row by row; one matrix for
/// each member.
fn coupling(group: &Group, unknowns: &[Range<usize>]) -> Vec<Vec<Rgb>> {
    let sent = |m: usize| -> Vec<[Rgb; MAX_PART_UNKNOWNS]> {
        let system = group.system(m);
        let mut sent = vec![[Rgb::BLACK; MAX_PART_UNKNOWNS]; system.clusters.nodes()];
        for (k, answer) in system.answers.radiosity[..unknowns[m].len()].iter().enumerate() {
            sent.iter_mut().zip(system.clusters.means(answer)).for_each(|(sent, mean)| sent[k] = mean);
        }
        sent
    };
    let sent: Vec<Vec<[Rgb; MAX_PART_UNKNOWNS]>> = (0..unknowns.len()).into_par_iter().map(sent).collect();
    (0..unknowns.len()).into_par_iter().map(|m| received_by(group, m, unknowns, &sent)).collect()
}

/// The matrix of one member from the radiosity that all responses send.
fn received_by(
    group: &Group,
    member: usize,
    unknowns: &[Range<usize>],
    sent: &[Vec<[Rgb; MAX_PART_UNKNOWNS]>],
) -> Vec<Rgb> {
    let system = group.system(member);
    let answers = &system.answers.radiosity[..unknowns[member].len()];
    let size = unknowns.last().map_or(0, |last| last.end);
    let mut matrix = vec![Rgb::BLACK; answers.len() * size];
    for rows in 0..system.coupling.groups() {
        let weights: Vec<[f64; 3 * MAX_PART_UNKNOWNS]> =
            system.coupling.receivers_of(rows).map(|i| weights(system, answers, i)).collect();
        if weights.iter().flatten().all(|&weight| weight == 0.0) {
            continue;
        }
        let scattered = system.coupling.scatter_group(rows, &weights);
        // Senders are sorted, so those of one member are adjacent.
        let (mut from, mut rest) = (0, scattered.as_slice());
        while let Some((next, _)) = rest.first() {
            while group.senders_of(from).end <= *next {
                from += 1;
            }
            let of_member = rest.partition_point(|(sender, _)| *sender < group.senders_of(from).end);
            let (of_member, others) = rest.split_at(of_member);
            rest = others;
            let products = products(of_member, &sent[from], group.senders_of(from).start);
            for (row, products) in matrix.chunks_mut(size).zip(products) {
                let entries = row[unknowns[from].clone()].iter_mut();
                entries.zip(products).for_each(|(entry, product)| *entry += product);
            }
        }
    }
    matrix
}

/// Σ_j s_j b_j over senders j of one member, the first of which is `first`, for each sum s of receivers and each
/// response b.
fn products(
    scattered: &[(usize, [f64; 3 * MAX_PART_UNKNOWNS])],
    sent: &[[Rgb; MAX_PART_UNKNOWNS]],
    first: usize,
) -> [[Rgb; MAX_PART_UNKNOWNS]; MAX_PART_UNKNOWNS] {
    let mut products = [[Rgb::BLACK; MAX_PART_UNKNOWNS]; MAX_PART_UNKNOWNS];
    for (sender, sums) in scattered {
        for (row, &sum) in products.iter_mut().zip(sums.as_chunks::<3>().0) {
            let entries = row.iter_mut().zip(&sent[sender - first]);
            entries.for_each(|(entry, &sent)| *entry += Rgb(sum) * sent);
        }
    }
    products
}

/// A_i a_i ρ_i of one element for each response a.
fn weights(system: &InstanceSystem, answers: &[Vec<Rgb>], i: usize) -> [f64; 3 * MAX_PART_UNKNOWNS] {
    let mut weights = [0.0; 3 * MAX_PART_UNKNOWNS];
    let reflected = system.optics.reflectance[i].map(|rho| rho * system.clusters.area_of(i));
    let places = weights.as_chunks_mut::<3>().0.iter_mut();
    places.zip(answers).for_each(|(place, answer)| *place = (reflected * answer[i]).0);
    weights
}
