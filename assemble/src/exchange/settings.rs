//! Settings of the exchange: the method and the condition under which it ends.

/// How parts exchange light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Method {
    /// GMRES, with a coarse space if parts return much light
    Auto,
    /// Block Jacobi, the paper's form: all parts at once, each with the light of the previous round
    Jacobi,
    /// Block Gauss-Seidel: one part after the other, with the newest light
    GaussSeidel,
    /// Flexible GMRES, preconditioned by block Gauss-Seidel and always by a coarse space
    Gmres,
}

/// When the exchange ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The required error bound, relative to the brightest radiosity in each channel of each group of parts that
    /// exchange light; 0 continues until rounding.
    pub error: f64,
    /// Maximum number of rounds.
    pub rounds: usize,
}

impl Default for Goal {
    /// A proved error of one millionth of the brightest radiosity, in any number of rounds.
    fn default() -> Self {
        Self { error: 1e-6, rounds: usize::MAX }
    }
}
