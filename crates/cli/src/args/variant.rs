//! The variants of the method, for `refine` and `bench`.

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use surfine::{Neighborhood, RefineParams, Rules};

/// Above the options of the method in the help.
pub(super) const METHOD: &str = "Method (the defaults fit every cloud)";

/// The variants of the paper.
#[derive(Args, Debug)]
#[command(next_help_heading = METHOD)]
pub(super) struct VariantArgs {
    /// How neighbors are told from points that lie behind them
    #[arg(long, value_enum, value_name = "KIND", default_value_t)]
    neighborhood: NeighborhoodChoice,
    /// Trade quality for some 1.5 times the speed, for dense smooth clouds; implies --neighborhood fuzzy
    ///
    /// Distances are Euclidean, the rules for irregular samples are left out (`natural_neighbors`, `sure_neighbors`,
    /// `next_ring`), and a triangle in the neighborhoods of all three corners gets its new point without a look for
    /// others nearby.
    #[arg(long)]
    simplified: bool,
    /// Keep to the text of the paper: none of the rules that --without lists
    ///
    /// Boundaries are still found (see --closed).
    #[arg(long)]
    literal: bool,
    /// Leave out one of the rules that go beyond the paper; may be given several times
    ///
    /// docs/algorithm.md says what each does, and measures it.
    #[arg(long, value_name = "RULE", value_parser = rule(), conflicts_with = "literal")]
    without: Vec<String>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum NeighborhoodChoice {
    /// As seen along the curved surface: for any sampling
    #[default]
    Accurate,
    /// As seen from the point itself: faster, for well-sampled clouds
    Fuzzy,
}

impl VariantArgs {
    /// Whether the paper's text is asked for.
    pub(super) fn is_literal(&self) -> bool {
        self.literal
    }

    /// Other parameters with the variant that is asked for.
    pub(super) fn applied_to(&self, params: RefineParams) -> RefineParams {
        let neighborhood = match self.neighborhood {
            NeighborhoodChoice::Accurate => Neighborhood::Accurate,
            NeighborhoodChoice::Fuzzy => Neighborhood::Fuzzy,
        };
        RefineParams { neighborhood, simplified: self.simplified, rules: self.rules(), ..params }
    }

    /// The rules beyond the paper; the names were checked.
    fn rules(&self) -> Rules {
        let mut rules = if self.literal { Rules::LITERAL } else { Rules::ALL };
        for name in &self.without {
            *rules.get_mut(name).expect("the name was checked") = false;
        }
        rules
    }
}

fn rule() -> PossibleValuesParser {
    PossibleValuesParser::new(Rules::ALL.named().map(|(name, _)| name))
}
