//! What is done at alarms: keys, defaults, and what cannot be done.

use sortie::spec::{Action, AlarmKind, Answer, Who};

use super::{good, issues, only, with};

const OLD: &str = "on_link_loss: hold_all\n";

#[test]
fn what_is_not_given_continues_and_who_is_the_vehicle_itself() {
    let spec = good(&with(
        OLD,
        "on_alarm: {battery: {do: land}, link: {who: others, do: hold}}\n",
    ));
    let answers = spec.answers();
    let own = Answer {
        who: Who::Vehicle,
        action: Action::Land,
    };
    assert_eq!(answers.answer(AlarmKind::Battery), own);
    assert_eq!(answers.answer(AlarmKind::Ekf), Answer::default());
    let others = Answer {
        who: Who::Others,
        action: Action::Hold,
    };
    assert_eq!(answers.answer(AlarmKind::Link), others);
}

#[test]
fn on_link_loss_is_another_word_for_all_at_a_lost_link() {
    let all = |action| Answer {
        who: Who::All,
        action,
    };
    for (word, action) in [("hold_all", Action::Hold), ("land_all", Action::Land)] {
        let spec = good(&with(OLD, &format!("on_link_loss: {word}\n")));
        assert_eq!(spec.answers().answer(AlarmKind::Link), all(action));
    }
    let both = format!("{OLD}on_alarm: {{link: {{do: hold}}}}\n");
    let (path, text) = only(OLD, &both);
    assert_eq!(path, "on_link_loss");
    assert!(text.contains("they are the same"), "{text}");
}

#[test]
fn a_return_is_for_vehicles_that_have_an_altitude_for_it_alone() {
    let found = issues(&with(OLD, "on_alarm: {battery: {do: return}}\n"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "on_alarm.battery.do");
    assert!(
        found[0].allowed.contains("return_amsl_m for bravo"),
        "{found:?}"
    );
}

#[test]
fn an_alarm_or_an_action_that_is_none_is_an_error_with_its_position() {
    for bad in [
        "on_alarm: {batery: {do: hold}}\n",
        "on_alarm: {battery: {do: fly}}\n",
        "on_alarm: {battery: {who: vehicle}}\n",
    ] {
        let found = issues(&with(OLD, bad));
        assert!(found[0].position.is_some(), "{found:?}");
    }
}
