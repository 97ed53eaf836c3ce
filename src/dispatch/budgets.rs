//! Smaller budgets that a fleet is planned with as well: a larger one is never worse than those.

use crate::spec::{Algorithm, MissionSpec, Objective};

/// Round budgets from the default on. Each larger one has all before it.
const ROUND: [usize; 3] = [40_000, 100_000, 200_000];
/// Times as many evaluations for each further plan, up to the first round budget.
const GROWTH: usize = 4;
/// How many times smaller other budgets are where a fleet fails, and the least.
const PARTS: [usize; 2] = [2, 4];
const MIN: usize = 10_000;

/// Small budget that a small fleet is planned with as well, where its vehicles pay for each other: another
/// one may then give way, and it takes little time.
const SMALL: usize = 1000;

/// The small budget, if it is below that of a spec.
pub(super) fn small(spec: &MissionSpec) -> Option<usize> {
    let planner = &spec.planner;
    let is_searched =
        planner.objective != Objective::Paper && planner.algorithm == Algorithm::Msfoa;
    (is_searched && SMALL < planner.evaluations).then_some(SMALL)
}

/// Round budgets below that of a spec, each of them and the tens of them. None for what is compared
/// with published figures at equal evaluations.
pub(super) fn smaller(spec: &MissionSpec) -> Vec<usize> {
    let planner = &spec.planner;
    if planner.objective == Objective::Paper || planner.algorithm != Algorithm::Msfoa {
        return Vec::new();
    }
    round()
        .take_while(|round| *round < planner.evaluations)
        .collect()
}

/// What a plan gets after one with fewer evaluations, where the best of all is taken: no round budget
/// is left out, so that the best is also that of its own budget with those below it.
pub(super) fn after(evaluations: usize) -> usize {
    let grown = evaluations.saturating_mul(GROWTH);
    let next = round().find(|round| *round > evaluations);
    grown.min(next.unwrap_or(usize::MAX))
}

/// All round budgets.
fn round() -> impl Iterator<Item = usize> {
    let tens = (0..).map_while(|power| 10_usize.checked_pow(power));
    tens.flat_map(|ten| ROUND.map(|round| round.saturating_mul(ten)))
}

/// Parts of the budget of a spec.
pub(super) fn parts(spec: &MissionSpec) -> impl Iterator<Item = usize> {
    let parts = PARTS.map(|part| spec.planner.evaluations / part);
    parts.into_iter().take_while(|part| *part >= MIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_larger_budget_has_all_round_ones_below_it_and_the_default_none() {
        let path = std::path::Path::new("missions/first.yaml");
        let text = include_str!("../../missions/first.yaml").to_owned();
        let mut spec = (crate::spec::SpecFile::parse(path, text).expect("a shipped mission")).spec;
        let mut of = |evaluations: usize| {
            spec.planner.evaluations = evaluations;
            smaller(&spec)
        };
        assert!(of(4000).is_empty());
        assert!(of(40_000).is_empty());
        assert_eq!(of(64_000), [40_000]);
        assert_eq!(of(400_000), [40_000, 100_000, 200_000]);
        assert_eq!(of(1_000_000), [40_000, 100_000, 200_000, 400_000]);
        assert_eq!(of(1_000_001)[4..], [1_000_000]);
        assert!(of(usize::MAX).len() > 20);
        let steps = std::iter::successors(Some(250), |now| Some(after(*now)));
        let steps: Vec<usize> = steps.take(9).collect();
        let (few, rounds) = steps.split_at(4);
        assert_eq!(few, [250, 1000, 4000, 16_000]);
        assert_eq!(rounds, [40_000, 100_000, 200_000, 400_000, 1_000_000]);
    }
}
