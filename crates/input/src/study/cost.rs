//! What a design of a search costs: a sum of factors times parameters.

use crate::spec::study::{Best, Ranking};
use crate::study::parameters::{Parameter, Setting};
use indexmap::IndexMap;
use lumiduct_core::measure::{Measure, Status};
use lumiduct_core::plan::Estimator;

/// What a design of a search costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Cost {
    /// By parameter.
    factors: IndexMap<String, f64>,
    /// That of all its parameters, or `1`.
    unit: String,
}

impl Cost {
    /// The name of its measure.
    pub const NAME: &str = "cost";

    /// A cost by factors of parameters; `None` without factors.
    pub(crate) fn new(factors: &IndexMap<String, f64>, parameters: &[Parameter]) -> Option<Self> {
        let mut units = parameters
            .iter()
            .filter(|own| factors.contains_key(&own.name))
            .map(|own| own.unit.as_deref());
        let first = units.next()?;
        let unit = first.filter(|_| units.all(|own| own == first)).unwrap_or("1").to_owned();
        Some(Self { factors: factors.clone(), unit })
    }

    /// The lowest cost is the best.
    pub(crate) fn ranking() -> Ranking {
        Ranking { measure: Self::NAME.to_owned(), best: Best::Lowest }
    }

    /// The name and value of the cost of a design, which is exact. A parameter that is not set to a number costs nothing.
    pub fn measure(&self, parameters: &[Parameter], settings: &[Setting]) -> (String, Measure) {
        let own = |(parameter, setting): (&Parameter, &Setting)| {
            Some(self.factors.get(&parameter.name)? * setting.number()?)
        };
        let measure = Measure {
            value: parameters.iter().zip(settings).filter_map(own).sum(),
            std_error: 0.0,
            bias: None,
            unit: self.unit.clone(),
            batches: 0,
            paths: 0,
            estimator: Estimator::Forward,
            status: Status::Ok,
        };
        (Self::NAME.to_owned(), measure)
    }
}
