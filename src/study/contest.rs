//! Who takes part, and with how many evaluations.

use serde::{Deserialize, Serialize};

use crate::optimize::{
    AbcParameters, Algorithm, DeParameters, FoaParameters, IffoParameters, Mapping, MfoaParameters,
    Parents, PsoParameters, PublishedParameters, Step,
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
    /// Why it takes part.
    pub role: Role,
}

/// Why a contestant takes part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It is one of the paper's seven.
    Paper,
    /// It is this program's own.
    Own,
    /// It is MSFOA without one of its parts, or with another threshold.
    Ablation,
    /// It reads what the paper leaves open in another way.
    Reading,
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

    /// How many of so many runs it makes: all if it is the paper's; the first quarter if it
    /// is the planner, which takes longer and varies less, or one of the many variations.
    #[must_use]
    pub fn runs(&self, runs: usize) -> usize {
        match self.role {
            Role::Paper => runs,
            Role::Own | Role::Ablation | Role::Reading => runs.div_ceil(4),
        }
    }
}

/// MSFOA with both readings of R and under both protocols, the six others, and the
/// default planner.
#[must_use]
pub fn contestants(population: usize) -> Vec<Contestant> {
    let msfoa = |name, label, protocol, of: PublishedParameters| Contestant {
        name,
        label,
        protocol,
        method: Method::Printed(Algorithm::MsfoaLiteral(PublishedParameters {
            population,
            ..of
        })),
        role: Role::Paper,
    };
    let other = |name, label, algorithm| Contestant {
        name,
        label,
        protocol: Protocol::Evaluations,
        method: Method::Printed(algorithm),
        role: Role::Paper,
    };
    let (literal, dwindle) = (
        PublishedParameters::literal(),
        PublishedParameters::dwindle(),
    );
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
            role: Role::Own,
        },
    ]
}

/// A variation at equal evaluations.
fn variation(role: Role) -> impl Fn((&'static str, &'static str, Algorithm)) -> Contestant {
    move |(name, label, algorithm)| Contestant {
        name,
        label,
        protocol: Protocol::Evaluations,
        method: Method::Printed(algorithm),
        role,
    }
}

/// MSFOA without one of its parts, and with other thresholds.
#[must_use]
pub fn ablations(population: usize) -> Vec<Contestant> {
    let dwindle = PublishedParameters {
        population,
        ..PublishedParameters::dwindle()
    };
    let constant = PublishedParameters {
        step: Step::Constant(0.1),
        ..dwindle
    };
    let threshold = |of, threshold| PublishedParameters { threshold, ..of };
    let barren = |of| PublishedParameters {
        offspring: false,
        ..of
    };
    let lonely = |of| PublishedParameters { swarms: 1, ..of };
    let never = f64::INFINITY;
    [
        (
            "literal-no-offspring",
            "no offspring, R = 0.1",
            barren(constant),
        ),
        (
            "dwindle-no-offspring",
            "no offspring, R from 0.3",
            barren(dwindle),
        ),
        ("literal-one-swarm", "one swarm, R = 0.1", lonely(constant)),
        (
            "dwindle-one-swarm",
            "one swarm, R from 0.3",
            lonely(dwindle),
        ),
        (
            "literal-no-threshold",
            "no threshold: local steps only, R = 0.1",
            threshold(constant, never),
        ),
        (
            "dwindle-no-threshold",
            "no threshold: local steps only, R from 0.3",
            threshold(dwindle, never),
        ),
        (
            "literal-threshold-500",
            "threshold 500, R = 0.1",
            threshold(constant, 500.0),
        ),
        (
            "dwindle-threshold-500",
            "threshold 500, R from 0.3",
            threshold(dwindle, 500.0),
        ),
        (
            "dwindle-threshold-250",
            "threshold 250, R from 0.3",
            threshold(dwindle, 250.0),
        ),
        (
            "dwindle-threshold-0",
            "threshold 0: global steps only",
            threshold(dwindle, 0.0),
        ),
    ]
    .map(|(name, label, of)| (name, label, Algorithm::MsfoaLiteral(of)))
    .map(variation(Role::Ablation))
    .into()
}

/// What the paper leaves open, read in the other way.
#[must_use]
pub fn readings(population: usize) -> Vec<Contestant> {
    let (literal, dwindle) = (
        PublishedParameters::literal(),
        PublishedParameters::dwindle(),
    );
    let msfoa =
        |of: PublishedParameters| Algorithm::MsfoaLiteral(PublishedParameters { population, ..of });
    let by_point = |of| PublishedParameters {
        mapping: Mapping::Point,
        ..of
    };
    let each_pair = |of| PublishedParameters {
        parents: Parents::EachPair,
        ..of
    };
    [
        (
            "literal-by-point",
            "MSFOA, R = 0.1, a pair (X, Y) for each control point",
            msfoa(by_point(literal)),
        ),
        (
            "dwindle-by-point",
            "MSFOA, R from 0.3, a pair (X, Y) for each control point",
            msfoa(by_point(dwindle)),
        ),
        (
            "literal-each-pair",
            "MSFOA, R = 0.1, a parent for each variable",
            msfoa(each_pair(literal)),
        ),
        (
            "dwindle-each-pair",
            "MSFOA, R from 0.3, a parent for each variable",
            msfoa(each_pair(dwindle)),
        ),
        (
            "foa-reciprocal",
            "FOA, S = 1/D",
            Algorithm::Foa(FoaParameters {
                population,
                reciprocal: true,
            }),
        ),
        (
            "pso-unlimited",
            "PSO, no speed limit",
            Algorithm::Pso(PsoParameters {
                population,
                max_speed: f64::INFINITY,
                ..PsoParameters::default()
            }),
        ),
        (
            "de-midpoint",
            "DE, put back halfway to the map's edge",
            Algorithm::De(DeParameters {
                population,
                midpoint: true,
                ..DeParameters::default()
            }),
        ),
    ]
    .map(variation(Role::Reading))
    .into()
}
