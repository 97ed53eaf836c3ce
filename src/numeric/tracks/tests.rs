use super::ends::CLEAR_M;
use super::{Ends, Nearness, Track, Tracks};
use crate::numeric::approach::Segment;
use proptest::prelude::*;

type Position = [f64; 3];

fn position() -> impl Strategy<Value = Position> {
    [-1500.0..1500.0_f64, -1500.0..1500.0_f64, 0.0..120.0_f64]
}

/// A flight: up from the ground, through some places, and then down, to stay above
/// its last place for ever, or back over its first.
fn flight() -> impl Strategy<Value = Track> {
    let way = prop::collection::vec(position(), 2..6);
    // Few pads, so that some are shared, not all of them in one cell.
    let pads = [0, 1].map(|_| (0..4_u8).prop_map(|pad| [f64::from(pad) * 2.5, 7.0, -20.0]));
    (
        0.0..120.0_f64,
        5.0..20.0_f64,
        way,
        0..3_u8,
        1..12_usize,
        pads,
    )
        .prop_map(|(t0_s, speed_mps, mut way, finish, pieces, pads)| {
            let ground = |at: &Position| [at[0], at[1], -20.0];
            if finish == 1 {
                way.push(way[0]);
            }
            way.insert(0, ground(&way[0]));
            if finish != 2 {
                way.push(ground(&way[way.len() - 1]));
            }
            let (mut segments, mut t_s) = (Vec::new(), t0_s);
            for pair in way.windows(2) {
                let step =
                    |share: f64| [0, 1, 2].map(|i| pair[0][i] + share * (pair[1][i] - pair[0][i]));
                for piece in 0..pieces {
                    #[expect(clippy::cast_precision_loss, reason = "a few pieces")]
                    let share = |piece: usize| piece as f64 / pieces as f64;
                    let (from, to) = (step(share(piece)), step(share(piece + 1)));
                    let way_m: f64 = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum();
                    let next_s = t_s + way_m.sqrt() / speed_mps;
                    segments.push(Segment::between((t_s, from), (next_s, to)));
                    t_s = next_s;
                }
            }
            if finish == 2 {
                let last = way[way.len() - 1];
                segments.push(Segment::between((t_s, last), (f64::INFINITY, last)));
            }
            let ends = Ends {
                begin: (t0_s, pads[0]),
                end: (finish != 2).then_some((t_s, pads[1])),
            };
            Track::new(segments).standing_at(Some(ends))
        })
}

fn nearness() -> impl Strategy<Value = Nearness> {
    let slack = prop_oneof![Just(0.0), 0.0..15.0_f64];
    let clear = prop_oneof![Just(0.0), 0.5..CLEAR_M];
    (
        10.0..250.0_f64,
        prop::option::of(5.0..60.0_f64),
        slack,
        clear,
    )
        .prop_map(|(distance_m, vertical_m, slack_s, clear_m)| Nearness {
            distance_m,
            vertical_m,
            slack_s,
            clear_m,
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_index_finds_exactly_the_conflicts_that_brute_force_finds(
        fleet in prop::collection::vec(flight(), 1..14), nearness in nearness(), from in 0..6_usize
    ) {
        let mut one_by_one = Tracks::new(&nearness);
        let mut at_once = Tracks::new(&nearness);
        at_once.extend(fleet.iter().cloned());
        for own in &fleet {
            let by_all = one_by_one.near_by_all(own, &nearness, from);
            prop_assert_eq!(one_by_one.near(own, &nearness, from), by_all);
            let is_near = !one_by_one.near_by_all(own, &nearness, 0).is_empty();
            prop_assert_eq!(one_by_one.is_any_near((own, 0.0), &nearness, |_| true), is_near);
            prop_assert_eq!(
                at_once.near(own, &nearness, from),
                at_once.near_by_all(own, &nearness, from)
            );
            one_by_one.extend([own.clone()]);
        }
    }

    #[test]
    fn looks_at_several_delays_are_those_at_each_of_them(
        fleet in prop::collection::vec(flight(), 1..9),
        nearness in nearness(),
        delays in prop::collection::vec(-60.0..90.0_f64, 1..5),
        from in 0..3_usize,
    ) {
        let mut tracks = Tracks::new(&nearness);
        tracks.extend(fleet.iter().cloned());
        let among = from.min(fleet.len())..fleet.len();
        for own in &fleet {
            let all = tracks.near_delayed(own, &nearness, among.clone(), &delays);
            for (found, &later_s) in all.into_iter().zip(&delays) {
                let later = own.segments().iter().map(|segment| segment.later(later_s));
                let ends = own.ends.map(|ends| ends.later(later_s));
                let later = Track::new(later.collect()).standing_at(ends);
                let is_any = tracks.is_any_near((own, later_s), &nearness, |one| one >= from);
                prop_assert_eq!(is_any, !found.is_empty());
                prop_assert_eq!(found, tracks.near_by_all(&later, &nearness, from));
            }
        }
    }

    /// Margins differ from vehicle to vehicle, the index serves them all.
    #[test]
    fn an_index_made_for_one_nearness_answers_another(
        fleet in prop::collection::vec(flight(), 1..8), made_for in nearness(), asked in nearness()
    ) {
        let mut tracks = Tracks::new(&made_for);
        tracks.extend(fleet.iter().cloned());
        for own in &fleet {
            prop_assert_eq!(tracks.near(own, &asked, 0), tracks.near_by_all(own, &asked, 0));
        }
    }
}
