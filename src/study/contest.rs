//! Who takes part, and with how many evaluations.

use serde::{Deserialize, Serialize};

use crate::optimize::{
    AbcParameters, Algorithm, DeParameters, FoaParameters, IffoParameters, LiteralParameters,
    MfoaParameters, PsoParameters, Step,
};

/// What an algorithm is given for each vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// So many iterations, as in the paper: MSFOA, which evaluates every fly twice,
    /// then has twice the evaluations of the others.
    Iterations,
    /// Population times iterations evaluations. For all but MSFOA this is the same run
    /// as with equal iterations, because the evaluation of a first population counts.
    Evaluations,
}

impl Protocol {
    /// Its name in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Iterations => "iterations",
            Self::Evaluations => "evaluations",
        }
    }
}

/// How a contestant searches.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// An algorithm on the paper's encoding.
    Printed(Algorithm),
    /// This program's own planner on the same objective.
    Planner,
}

/// One row of the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Contestant {
    /// Name in records, unique together with the protocol.
    pub name: &'static str,
    /// Name in tables.
    pub label: &'static str,
    /// What it is given.
    pub protocol: Protocol,
    /// How it searches.
    pub method: Method,
}

impl Contestant {
    /// Evaluations for each vehicle.
    #[must_use]
    pub fn budget(&self, population: usize, iterations: usize) -> usize {
        match (&self.method, self.protocol) {
            (Method::Printed(Algorithm::MsfoaLiteral(of)), Protocol::Iterations) => {
                of.evaluations(iterations)
            }
            _ => population * iterations,
        }
    }

    /// How many of so many runs it makes: the planner, which takes far longer and varies
    /// far less, every fourth.
    #[must_use]
    pub fn runs(&self, runs: usize) -> usize {
        match self.method {
            Method::Printed(_) => runs,
            Method::Planner => runs.div_ceil(4),
        }
    }

    /// Whether it is a variation of MSFOA that the paper does not have.
    #[must_use]
    pub fn is_ablation(&self) -> bool {
        self.name.contains('-') && !matches!(self.name, "msfoa-literal" | "msfoa-dwindle")
    }
}

/// MSFOA with both readings of R and under both protocols, the six others, and the
/// default planner.
#[must_use]
pub fn contestants(population: usize) -> Vec<Contestant> {
    let msfoa = |name, label, protocol, of: LiteralParameters| Contestant {
        name,
        label,
        protocol,
        method: Method::Printed(Algorithm::MsfoaLiteral(LiteralParameters {
            population,
            ..of
        })),
    };
    let other = |name, label, algorithm| Contestant {
        name,
        label,
        protocol: Protocol::Evaluations,
        method: Method::Printed(algorithm),
    };
    let (literal, dwindle) = (LiteralParameters::literal(), LiteralParameters::dwindle());
    let (iterations, evaluations) = (Protocol::Iterations, Protocol::Evaluations);
    vec![
        msfoa("msfoa-literal", "MSFOA, R = 0.1", iterations, literal),
        msfoa("msfoa-dwindle", "MSFOA, R from 0.3", iterations, dwindle),
        msfoa("msfoa-literal", "MSFOA, R = 0.1", evaluations, literal),
        msfoa("msfoa-dwindle", "MSFOA, R from 0.3", evaluations, dwindle),
        other(
            "foa",
            "FOA",
            Algorithm::Foa(FoaParameters {
                population,
                ..FoaParameters::default()
            }),
        ),
        other(
            "pso",
            "PSO",
            Algorithm::Pso(PsoParameters {
                population,
                ..PsoParameters::default()
            }),
        ),
        other(
            "de",
            "DE",
            Algorithm::De(DeParameters {
                population,
                ..DeParameters::default()
            }),
        ),
        other(
            "abc",
            "ABC",
            Algorithm::Abc(AbcParameters {
                sources: population / 2,
                onlookers: population / 2,
                ..AbcParameters::default()
            }),
        ),
        other(
            "iffo",
            "IFFO",
            Algorithm::Iffo(IffoParameters {
                population,
                ..IffoParameters::default()
            }),
        ),
        other(
            "mfoa",
            "MFOA",
            Algorithm::Mfoa(MfoaParameters {
                population,
                ..MfoaParameters::default()
            }),
        ),
        Contestant {
            name: "planner",
            label: "the default planner",
            protocol: Protocol::Evaluations,
            method: Method::Planner,
        },
    ]
}

/// MSFOA without one of its parts, at equal evaluations.
#[must_use]
pub fn ablations(population: usize) -> Vec<Contestant> {
    let base = LiteralParameters {
        population,
        ..LiteralParameters::dwindle()
    };
    let constant = LiteralParameters {
        step: Step::Constant(0.1),
        ..base
    };
    let threshold = |threshold| LiteralParameters { threshold, ..base };
    let barren = |of| LiteralParameters {
        offspring: false,
        ..of
    };
    let lonely = |of| LiteralParameters { swarms: 1, ..of };
    [
        ("dwindle-no-offspring", "no offspring", barren(base)),
        (
            "literal-no-offspring",
            "no offspring, R = 0.1",
            barren(constant),
        ),
        ("dwindle-one-swarm", "one swarm", lonely(base)),
        ("literal-one-swarm", "one swarm, R = 0.1", lonely(constant)),
        (
            "dwindle-no-threshold",
            "no threshold: local steps only",
            threshold(f64::INFINITY),
        ),
        ("dwindle-threshold-500", "threshold 500", threshold(500.0)),
        ("dwindle-threshold-250", "threshold 250", threshold(250.0)),
        (
            "dwindle-threshold-0",
            "threshold 0: global steps only",
            threshold(0.0),
        ),
    ]
    .into_iter()
    .map(|(name, label, of)| Contestant {
        name,
        label,
        protocol: Protocol::Evaluations,
        method: Method::Printed(Algorithm::MsfoaLiteral(of)),
    })
    .collect()
}
