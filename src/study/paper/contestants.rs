//! The algorithms of the experiment and their budgets.

use crate::optimize::{
    AbcParameters, Algorithm, DeParameters, FoaParameters, IffoParameters, Mapping, MfoaParameters,
    Parents, PsoParameters, PublishedParameters,
};

/// The budget that is equal among the contestants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Protocol {
    /// Iterations, as in the paper: MSFOA evaluates every fly twice and has twice the
    /// evaluations of the others.
    Iterations,
    /// Evaluations: population times iterations. Only MSFOA differs from equal iterations,
    /// because the evaluation of a first population counts.
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
    Published(Algorithm),
    /// The default planner of this program on the same objective.
    Planner,
}

/// One row of the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Contestant {
    /// Name in records, unique together with the protocol.
    pub name: String,
    /// Name in tables.
    pub label: String,
    /// Its budget.
    pub protocol: Protocol,
    /// How it searches.
    pub method: Method,
    /// Why it takes part.
    pub role: Role,
}

/// Why a contestant takes part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// One of the paper's seven.
    Paper,
    /// The default planner.
    Own,
    /// MSFOA without one of its parts, or with another threshold.
    Ablation,
    /// Another reading of what the paper leaves open.
    Interpretation,
}

impl Contestant {
    /// Evaluations for each vehicle.
    #[must_use]
    pub fn budget(&self, population: usize, iterations: usize) -> usize {
        match (&self.method, self.protocol) {
            (Method::Published(Algorithm::MsfoaLiteral(of)), Protocol::Iterations) => {
                of.evaluations(iterations)
            }
            _ => population * iterations,
        }
    }

    /// Number of runs: all of `runs` for the paper's seven. The first quarter for variations,
    /// and for the planner, which takes longer and varies less.
    #[must_use]
    pub fn runs(&self, runs: usize) -> usize {
        match self.role {
            Role::Paper => runs,
            Role::Own | Role::Ablation | Role::Interpretation => runs.div_ceil(4),
        }
    }

    /// Name in tables, with the protocol.
    pub(super) fn title(&self) -> String {
        match self.role {
            Role::Own => self.label.clone(),
            _ => format!("{}, equal {}", self.label, self.protocol.name()),
        }
    }

    /// At equal evaluations.
    fn new(name: impl Into<String>, label: impl Into<String>, role: Role, of: Algorithm) -> Self {
        Self {
            name: name.into(),
            label: label.into(),
            protocol: Protocol::Evaluations,
            method: Method::Published(of),
            role,
        }
    }
}

/// Both readings of MSFOA's local step R: name, label, parameters.
fn steps(population: usize) -> [(&'static str, &'static str, PublishedParameters); 2] {
    let (literal, dwindle) = (
        PublishedParameters::literal(),
        PublishedParameters::dwindle(),
    );
    [
        ("literal", "R = 0.1", literal),
        ("dwindle", "R from 0.3", dwindle),
    ]
    .map(|(name, label, of)| (name, label, PublishedParameters { population, ..of }))
}

/// MSFOA with both readings of R and under both protocols, the six others, and the
/// default planner.
#[must_use]
pub fn contestants(population: usize) -> Vec<Contestant> {
    let half = population / 2;
    let msfoa = |protocol: Protocol| {
        steps(population).map(|(name, step, of)| {
            let (name, label) = (format!("msfoa-{name}"), format!("MSFOA, {step}"));
            Contestant {
                protocol,
                ..Contestant::new(name, label, Role::Paper, Algorithm::MsfoaLiteral(of))
            }
        })
    };
    let foa = FoaParameters {
        population,
        ..FoaParameters::default()
    };
    let pso = PsoParameters {
        population,
        ..PsoParameters::default()
    };
    let de = DeParameters {
        population,
        ..DeParameters::default()
    };
    let abc = AbcParameters {
        sources: half,
        onlookers: half,
        ..AbcParameters::default()
    };
    let iffo = IffoParameters {
        population,
        ..IffoParameters::default()
    };
    let mfoa = MfoaParameters {
        population,
        ..MfoaParameters::default()
    };
    let others = [
        ("foa", "FOA", Algorithm::Foa(foa)),
        ("pso", "PSO", Algorithm::Pso(pso)),
        ("de", "DE", Algorithm::De(de)),
        ("abc", "ABC", Algorithm::Abc(abc)),
        ("iffo", "IFFO", Algorithm::Iffo(iffo)),
        ("mfoa", "MFOA", Algorithm::Mfoa(mfoa)),
    ];
    let mut all = Vec::from(msfoa(Protocol::Iterations));
    all.extend(msfoa(Protocol::Evaluations));
    all.extend(others.map(|(name, label, of)| Contestant::new(name, label, Role::Paper, of)));
    all.push(Contestant {
        name: "planner".to_owned(),
        label: "the default planner".to_owned(),
        protocol: Protocol::Evaluations,
        method: Method::Planner,
        role: Role::Own,
    });
    all
}

/// A change of the parameters of MSFOA: name, label, change.
type Change = (&'static str, &'static str, fn(&mut PublishedParameters));

/// MSFOA without one of its parts, and with other thresholds.
#[must_use]
pub fn ablations(population: usize) -> Vec<Contestant> {
    let both: [Change; 4] = [
        ("no-offspring", "no offspring", |of| of.offspring = false),
        ("one-swarm", "one swarm", |of| of.swarms = 1),
        ("no-threshold", "no threshold: local steps only", |of| {
            of.threshold = f64::INFINITY;
        }),
        ("threshold-500", "threshold 500", |of| of.threshold = 500.0),
    ];
    let changed = |(name, label, change): Change| {
        steps(population).map(|(step_name, step, mut of)| {
            change(&mut of);
            let (name, label) = (format!("{step_name}-{name}"), format!("{label}, {step}"));
            Contestant::new(name, label, Role::Ablation, Algorithm::MsfoaLiteral(of))
        })
    };
    let mut all: Vec<Contestant> = both.into_iter().flat_map(changed).collect();
    let [_, (.., dwindle)] = steps(population);
    for (threshold, name, label) in [
        (250.0, "dwindle-threshold-250", "threshold 250, R from 0.3"),
        (0.0, "dwindle-threshold-0", "threshold 0: global steps only"),
    ] {
        let of = Algorithm::MsfoaLiteral(PublishedParameters {
            threshold,
            ..dwindle
        });
        all.push(Contestant::new(name, label, Role::Ablation, of));
    }
    all
}

/// Other readings of what the paper leaves open.
#[must_use]
pub fn readings(population: usize) -> Vec<Contestant> {
    let both: [Change; 2] = [
        ("by-point", "a pair (X, Y) for each control point", |of| {
            of.mapping = Mapping::Point;
        }),
        ("each-pair", "a parent for each variable", |of| {
            of.parents = Parents::EachPair;
        }),
    ];
    let changed = |(name, label, change): Change| {
        steps(population).map(|(step_name, step, mut of)| {
            change(&mut of);
            let label = format!("MSFOA, {step}, {label}");
            let algorithm = Algorithm::MsfoaLiteral(of);
            Contestant::new(
                format!("{step_name}-{name}"),
                label,
                Role::Interpretation,
                algorithm,
            )
        })
    };
    let mut all: Vec<Contestant> = both.into_iter().flat_map(changed).collect();
    let foa = FoaParameters {
        population,
        reciprocal: true,
    };
    let max_speed = f64::INFINITY;
    let pso = PsoParameters {
        population,
        max_speed,
        ..PsoParameters::default()
    };
    let de = DeParameters {
        population,
        midpoint: true,
        ..DeParameters::default()
    };
    for (name, label, of) in [
        ("foa-reciprocal", "FOA, S = 1/D", Algorithm::Foa(foa)),
        ("pso-unlimited", "PSO, no speed limit", Algorithm::Pso(pso)),
        (
            "de-midpoint",
            "DE, put back halfway to the map's edge",
            Algorithm::De(de),
        ),
    ] {
        all.push(Contestant::new(name, label, Role::Interpretation, of));
    }
    all
}
