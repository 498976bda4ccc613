//! One round of the exchange: equilibria of the parts (steps 5 and 6 of the paper) and transfers (steps 7 and 8).
//! Input: the residual v of the equation. Output: a correction z, to which each part contributes its local response,
//! and A z.
//!
//! Parts are solved in turns. In its turn a part solves (I − ρF_kk) z_k = v_k + ρ Σ_{l≠k} F_kl z_l with the newest
//! z_l. A single turn for all parts is block Jacobi; one turn for each part is block Gauss-Seidel. A z then needs
//! only transfers, since the part's own share of each row was just solved.

use crate::exchange::groups::Group;
use crate::exchange::step_times::StepTimes;
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// The order in which members are solved, and the accuracy of their local solutions.
pub struct BlockCorrection<'a> {
    group: &'a Group<'a>,
    /// The turn of each member.
    turns: Vec<usize>,
    /// Share of the sources that a local solver may leave unsolved; none to solve until rounding.
    share: Option<f64>,
    /// Number of local solves that were skipped because the sources were zero.
    pub idle: usize,
}

/// Result of one member's turn.
struct MemberCorrection {
    correction: Vec<Rgb>,
    /// Residual that the local solver left, W/m².
    left: Vec<Rgb>,
    idle: bool,
    time: Duration,
}

/// Corrections during one round.
#[derive(Debug)]
struct NewestCorrections {
    /// The newest corrections of all senders of the scene, W/m².
    all: Vec<Rgb>,
    /// Whether each member has a correction.
    lit: Vec<bool>,
}

impl<'a> BlockCorrection<'a> {
    /// Distribute the members over `turns` turns in order. A member solves until `share` of its sources is left, or
    /// until rounding if `share` is none.
    pub fn new(group: &'a Group<'a>, turns: usize, share: Option<f64>) -> Self {
        Self { group, turns: (0..group.members.len()).map(|m| m % turns.max(1)).collect(), share, idle: 0 }
    }

    /// The correction z, starting from `start` (from zero if none), and A z. Both are vectors of the group, W/m².
    pub fn correct(
        &mut self,
        residual: &[Rgb],
        start: Option<Vec<Rgb>>,
        times: &mut StepTimes,
    ) -> (Vec<Rgb>, Vec<Rgb>) {
        let group = self.group;
        let count = group.members.len();
        let mut newest = NewestCorrections {
            all: vec![Rgb::BLACK; group.scene_senders()],
            lit: vec![start.is_some(); count],
        };
        let mut correction = start.unwrap_or_else(|| vec![Rgb::BLACK; residual.len()]);
        for member in (0..count).filter(|&m| newest.lit[m]) {
            group.send(member, &correction[group.elements_of(member)], &mut newest.all);
        }
        let (mut arrived, mut left) = (vec![vec![]; count], vec![vec![]; count]);
        for turn in 0..=self.turns.iter().copied().max().unwrap_or(0) {
            let now: Vec<usize> = (0..count).filter(|&m| self.turns[m] == turn).collect();
            for &member in &now {
                arrived[member] = self.gather(member, &newest, times);
            }
            let solve = |&m: &usize| self.solve(m, &residual[group.elements_of(m)], &arrived[m]);
            let solved: Vec<MemberCorrection> = now.par_iter().map(solve).collect();
            for (&member, solved) in now.iter().zip(solved) {
                times.solve[group.members[member]] += solved.time;
                self.idle += usize::from(solved.idle);
                group.send(member, &solved.correction, &mut newest.all);
                newest.lit[member] = !solved.idle;
                correction[group.elements_of(member)].copy_from_slice(&solved.correction);
                left[member] = solved.left;
            }
        }
        let image = |m: usize| -> Vec<Rgb> {
            let pairs = residual[group.elements_of(m)].iter().zip(&left[m]);
            let solved = pairs.map(|(&v, &left)| v - left);
            if !self.is_stale(m) {
                return solved.collect();
            }
            let changes = arrived[m].iter().zip(self.gather(m, &newest, times));
            let rows = solved.zip(&group.system(m).optics.reflectance).zip(changes);
            rows.map(|((v, &rho), (&before, now))| v + rho * (before - now)).collect()
        };
        let image = (0..count).flat_map(image).collect();
        (correction, image)
    }

    /// Irradiance of a member from the other members' corrections, W/m². Gathers nothing if those corrections are
    /// zero.
    fn gather(&self, member: usize, newest: &NewestCorrections, times: &mut StepTimes) -> Vec<Rgb> {
        if !self.group.sees[member].iter().any(|&sender| newest.lit[sender]) {
            return vec![Rgb::BLACK; self.group.elements_of(member).len()];
        }
        let start = Instant::now();
        let arriving = self.group.arriving(member, &newest.all);
        times.transfer[self.group.members[member]] += start.elapsed();
        arriving
    }

    /// Whether a member was solved before the newest correction of some member it receives from was known, that is,
    /// of a member with the same or a later turn.
    fn is_stale(&self, member: usize) -> bool {
        self.group.sees[member].iter().any(|&sender| self.turns[sender] >= self.turns[member])
    }

    fn solve(&self, member: usize, residual: &[Rgb], arrived: &[Rgb]) -> MemberCorrection {
        let start = Instant::now();
        let system = self.group.system(member);
        let rows = residual.iter().zip(&system.optics.reflectance).zip(arrived);
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
