//! A world that is not the spec's: nothing is paired wrongly without a word.

use sortie::spec::Threat;
use sortie::{Mission, plan};

#[test]
fn a_world_of_another_spec_is_never_a_pass() {
    let mission = Mission::read("missions/first.yaml").expect("a good spec");
    let planned = plan(&mission);
    let missions: Vec<_> = planned.missions.iter().map(|(at, of)| (*at, of)).collect();
    let judged = |spec| sortie::verify::review(spec, mission.world(), &missions);
    assert!(judged(mission.spec()).passes());

    let mut spec = mission.spec().clone();
    let threat = Threat {
        id: "on the way".to_owned(),
        ..spec.threats[0].clone()
    };
    spec.threats.push(threat);
    let review = judged(&spec);
    let failed: Vec<_> = review.margins.iter().filter(|margin| !margin.ok).collect();
    assert_eq!(failed.len(), 1, "{failed:?}");
    assert!(failed[0].note.contains("another spec"), "{failed:?}");
}
