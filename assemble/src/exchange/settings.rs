//! Settings of the exchange: the method and the condition under which it ends.

/// How parts exchange light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Method {
    /// GMRES, with a coarse space where parts return much light
    Auto,
    /// Block Jacobi, the paper's form: all parts at once, each with the light of the round before
    Jacobi,
    /// Block Gauss-Seidel: one part after the other, with the newest light
    GaussSeidel,
    /// Flexible GMRES, preconditioned by block Gauss-Seidel and always by a coarse space of the parts' answers to light from
    /// outside
    Gmres,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The error bound asked for, relative to the brightest radiosity in each channel of each group of parts that exchange
    /// light; 0 asks for all that rounding allows.
    pub error: f64,
    /// At most this many rounds.
    pub rounds: usize,
}

impl Default for Goal {
    /// A proved error of one millionth of the brightest radiosity, in any number of rounds.
    fn default() -> Self {
        Self { error: 1e-6, rounds: usize::MAX }
    }
}
