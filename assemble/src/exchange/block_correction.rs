//! One round of the exchange: equilibria of the parts (steps 5, 6 of the paper) and transfers (7, 8). In goes what the
//! equation misses, v; out come a correction z that every part answers it with, and A z.
//!
//! Parts take turns. In its turn a part solves (I − ρF_kk) z_k = v_k + ρ Σ_{l≠k} F_kl z_l with the newest z_l. With one turn
//! for all that is block Jacobi, with one turn each block Gauss-Seidel. Only transfers are needed for A z then: its own
//! part of each row is what was just solved.

use crate::exchange::groups::Group;
use crate::exchange::step_times::StepTimes;
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Who is solved when, and how exactly.
pub struct BlockCorrection<'a> {
    group: &'a Group<'a>,
    /// The turn of each member.
    turns: Vec<usize>,
    /// What a local solver may leave of its sources; none for rounding.
    share: Option<f64>,
    /// Local equilibria that were not asked for, because nothing shone in the instance.
    pub idle: usize,
}

/// What a member found in its turn.
struct MemberCorrection {
    correction: Vec<Rgb>,
    /// What the local solver left.
    left: Vec<Rgb>,
    idle: bool,
    time: Duration,
}

/// The light of a sweep on its way.
#[derive(Debug)]
struct NewestCorrections {
    /// The newest corrections, of all senders of the scene.
    all: Vec<Rgb>,
    /// Which members have any.
    lit: Vec<bool>,
}

impl<'a> BlockCorrection<'a> {
    /// Members take turns in order, `turns` of them in all; one solves until `share` of its sources is left, or until
    /// rounding.
    pub fn new(group: &'a Group<'a>, turns: usize, share: Option<f64>) -> Self {
        Self { group, turns: (0..group.members.len()).map(|m| m % turns.max(1)).collect(), share, idle: 0 }
    }

    /// The correction z that starts from `start` (nothing, if none), and A z. Vectors of the group, W/m².
    pub fn correct(
        &mut self,
        missing: &[Rgb],
        start: Option<Vec<Rgb>>,
        times: &mut StepTimes,
    ) -> (Vec<Rgb>, Vec<Rgb>) {
        let group = self.group;
        let count = group.members.len();
        let mut light = NewestCorrections {
            all: vec![Rgb::BLACK; group.scene_senders()],
            lit: vec![start.is_some(); count],
        };
        let mut correction = start.unwrap_or_else(|| vec![Rgb::BLACK; missing.len()]);
        for member in (0..count).filter(|&m| light.lit[m]) {
            group.send(member, &correction[group.elements_of(member)], &mut light.all);
        }
        let (mut heard, mut left) = (vec![vec![]; count], vec![vec![]; count]);
        for turn in 0..=self.turns.iter().copied().max().unwrap_or(0) {
            let now: Vec<usize> = (0..count).filter(|&m| self.turns[m] == turn).collect();
            for &member in &now {
                heard[member] = self.hear(member, &light, times);
            }
            let solve = |&m: &usize| self.solve(m, &missing[group.elements_of(m)], &heard[m]);
            let solved: Vec<MemberCorrection> = now.par_iter().map(solve).collect();
            for (&member, solved) in now.iter().zip(solved) {
                times.solve[group.members[member]] += solved.time;
                self.idle += usize::from(solved.idle);
                group.send(member, &solved.correction, &mut light.all);
                light.lit[member] = !solved.idle;
                correction[group.elements_of(member)].copy_from_slice(&solved.correction);
                left[member] = solved.left;
            }
        }
        let image = |m: usize| -> Vec<Rgb> {
            let missing = missing[group.elements_of(m)].iter().zip(&left[m]);
            let solved = missing.map(|(&v, &left)| v - left);
            if !self.is_stale(m) {
                return solved.collect();
            }
            let changes = heard[m].iter().zip(self.hear(m, &light, times));
            let rows = solved.zip(&group.system(m).optics.reflectance).zip(changes);
            rows.map(|((v, &rho), (&before, now))| v + rho * (before - now)).collect()
        };
        let image = (0..count).flat_map(image).collect();
        (correction, image)
    }

    /// Irradiance from the other members; nothing is gathered in the dark.
    fn hear(&self, member: usize, light: &NewestCorrections, times: &mut StepTimes) -> Vec<Rgb> {
        if !self.group.sees[member].iter().any(|&sender| light.lit[sender]) {
            return vec![Rgb::BLACK; self.group.elements_of(member).len()];
        }
        let start = Instant::now();
        let arriving = self.group.arriving(member, &light.all);
        times.transfer[self.group.members[member]] += start.elapsed();
        arriving
    }

    /// Whether a member has not heard the newest of what it sees: of those who have the same turn or a later one.
    fn is_stale(&self, member: usize) -> bool {
        self.group.sees[member].iter().any(|&sender| self.turns[sender] >= self.turns[member])
    }

    fn solve(&self, member: usize, missing: &[Rgb], heard: &[Rgb]) -> MemberCorrection {
        let start = Instant::now();
        let system = self.group.system(member);
        let rows = missing.iter().zip(&system.optics.reflectance).zip(heard);
        let sources: Vec<Rgb> = rows.map(|((&v, &rho), &h)| v + rho * h).collect();
        let dark = vec![Rgb::BLACK; sources.len()];
        let idle = sources == dark;
        let (correction, left) = match self.share {
            _ if idle => (dark.clone(), dark),
            Some(share) => system.local.solve_roughly(&sources, share),
            None => (system.local.solve(&sources, &dark), dark),
        };
        MemberCorrection { correction, left, idle, time: start.elapsed() }
    }
}
