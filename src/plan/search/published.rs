//! The algorithms as they are printed, on the paper's problem.

use super::most_promising;
use super::objective::spatial;
use super::problem::Spline;
use super::route_context::Course;
use crate::numeric::Seed;
use crate::optimize::{
    AbcParameters, Algorithm, DeParameters, FoaParameters, IffoParameters, MfoaParameters,
    PsoParameters, PublishedParameters, Starts, Step, TracePoint, minimise,
};
use crate::spec;

/// Splines found by one of them, and the evaluations made: all three coordinates searched.
pub(crate) fn letter(
    course: &Course<'_>,
    printed: spec::Algorithm,
    budget: usize,
    seed: Seed,
    stream: u64,
    watch: &(dyn Fn(TracePoint) + Sync),
) -> (Vec<Spline>, usize) {
    let problem = spatial(course, &course.parameters(course.samples()));
    let mut rng = seed.stream("plan", stream);
    let outcome = minimise(
        &problem,
        &as_printed(printed, course),
        Starts::default(),
        budget,
        &mut rng,
        watch,
    );
    let splines = most_promising(outcome.finalists)
        .iter()
        .map(|candidate| {
            let mut spline = Spline::default();
            problem.spline(&candidate.position, &mut spline);
            spline
        })
        .collect();
    (splines, outcome.evaluations)
}

/// An algorithm of the paper, with what the spec says otherwise.
fn as_printed(algorithm: spec::Algorithm, course: &Course<'_>) -> Algorithm {
    let planner = &course.spec.planner;
    let flies = |printed: usize| planner.population.unwrap_or(printed);
    let msfoa = |printed: PublishedParameters| {
        Algorithm::MsfoaLiteral(PublishedParameters {
            swarms: planner.swarms.unwrap_or(printed.swarms),
            population: flies(printed.population),
            threshold: planner.threshold.unwrap_or(printed.threshold),
            step: match (printed.step, planner.step) {
                (Step::Constant(_), Some(step)) => Step::Constant(step),
                (Step::Dwindling(_), Some(step)) => Step::Dwindling(step),
                (step, None) => step,
            },
            ..printed
        })
    };
    let (foa, pso, de) = (
        FoaParameters::default(),
        PsoParameters::default(),
        DeParameters::default(),
    );
    let (abc, iffo, mfoa) = (
        AbcParameters::default(),
        IffoParameters::default(),
        MfoaParameters::default(),
    );
    match algorithm {
        spec::Algorithm::Msfoa | spec::Algorithm::MsfoaLiteral => {
            msfoa(PublishedParameters::literal())
        }
        spec::Algorithm::MsfoaDwindle => msfoa(PublishedParameters::dwindle()),
        spec::Algorithm::Foa => Algorithm::Foa(FoaParameters {
            population: flies(foa.population),
            ..foa
        }),
        spec::Algorithm::Pso => Algorithm::Pso(PsoParameters {
            population: flies(pso.population),
            ..pso
        }),
        spec::Algorithm::De => Algorithm::De(DeParameters {
            population: flies(de.population),
            ..de
        }),
        spec::Algorithm::Abc => Algorithm::Abc(AbcParameters {
            sources: flies(2 * abc.sources) / 2,
            onlookers: flies(2 * abc.onlookers) / 2,
            ..abc
        }),
        spec::Algorithm::Iffo => Algorithm::Iffo(IffoParameters {
            population: flies(iffo.population),
            ..iffo
        }),
        spec::Algorithm::Mfoa => Algorithm::Mfoa(MfoaParameters {
            population: flies(mfoa.population),
            swarms: planner.swarms.unwrap_or(mfoa.swarms),
            ..mfoa
        }),
    }
}
