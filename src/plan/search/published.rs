//! The algorithms as they are printed, on the paper's problem.

use super::Run;
use super::judgement::most_promising;
use super::objective::spatial;
use crate::optimize::{
    AbcParameters, Algorithm, DeParameters, FoaParameters, IffoParameters, MfoaParameters,
    PsoParameters, PublishedParameters, SearchSeeds, Step, minimise,
};
use crate::plan::route_context::RouteContext;
use crate::plan::spline::Spline;
use crate::spec;

/// Splines found by one of them, and the evaluations made: all three coordinates searched.
pub(crate) fn published(
    context: &RouteContext<'_>,
    algorithm: spec::Algorithm,
    run: Run<'_>,
) -> (Vec<Spline>, usize) {
    let problem = spatial(context, &context.parameters(context.samples()));
    let mut rng = run.seed.stream("plan", run.stream);
    let outcome = minimise(
        &problem,
        &published_parameters(algorithm, context),
        SearchSeeds::default(),
        run.budget,
        &mut rng,
        run.watch,
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
fn published_parameters(algorithm: spec::Algorithm, context: &RouteContext<'_>) -> Algorithm {
    let planner = &context.spec.planner;
    let flies = |published: usize| planner.population.unwrap_or(published);
    let msfoa = |published: PublishedParameters| {
        Algorithm::MsfoaLiteral(PublishedParameters {
            swarms: planner.swarms.unwrap_or(published.swarms),
            population: flies(published.population),
            threshold: planner.threshold.unwrap_or(published.threshold),
            step: match (published.step, planner.step) {
                (Step::Constant(_), Some(step)) => Step::Constant(step),
                (Step::Dwindling(_), Some(step)) => Step::Dwindling(step),
                (step, None) => step,
            },
            ..published
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
