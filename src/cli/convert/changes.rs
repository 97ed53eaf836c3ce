//! What became of items between two lists of them, in words.

use std::collections::BTreeMap;

use crate::mission::Item;

/// The differences between items and those read back; equal differences share a line.
pub(crate) fn changes(what: &str, was: &[Item], is: &[Item]) -> Vec<String> {
    if was.len() == is.len() && was != is && is_reordered(was, is) {
        return vec![format!("the order of the {what}s")];
    }
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for ((was, is), number) in was.iter().zip(is).zip(1..) {
        // A NaN that comes back is another number, and no change.
        let change = change(was, is);
        if !change.is_empty() {
            groups.entry(change).or_default().push(number);
        }
    }
    let mut groups: Vec<(String, Vec<usize>)> = groups.into_iter().collect();
    groups.sort_by_key(|(_, numbers)| numbers.first().copied());
    let mut changes: Vec<String> = groups
        .iter()
        .map(|(text, numbers)| format!("{}: {text}", ranges(what, numbers)))
        .collect();
    if was.len() != is.len() {
        changes.push(format!("of {} {what}s {} come back", was.len(), is.len()));
    }
    changes
}

/// Whether each of them is there, elsewhere.
fn is_reordered(was: &[Item], is: &[Item]) -> bool {
    let sorted = |items: &[Item]| {
        let bits = |item: &Item| {
            let params = item.params.map(f32::to_bits);
            let place = (item.x, item.y, item.z.to_bits());
            (item.command, item.frame, item.autocontinue, params, place)
        };
        let mut all: Vec<_> = items.iter().map(bits).collect();
        all.sort_unstable();
        all
    };
    sorted(was) == sorted(is)
}

/// The fields of an item that are not what they were.
fn change(was: &Item, is: &Item) -> String {
    let fields = |item: &Item| {
        let [a, b, c, d] = item.params.map(|value| value.to_string());
        [
            ("command", item.command.to_string()),
            ("frame", item.frame.to_string()),
            ("autocontinue", item.autocontinue.to_string()),
            ("param1", a),
            ("param2", b),
            ("param3", c),
            ("param4", d),
            ("param5", item.x.to_string()),
            ("param6", item.y.to_string()),
            ("altitude", item.z.to_string()),
        ]
    };
    let changed: Vec<String> = fields(was)
        .into_iter()
        .zip(fields(is))
        .filter(|(was, is)| was != is)
        .map(|((name, was), (_, is))| format!("{name} {was} becomes {is}"))
        .collect();
    changed.join(", ")
}

/// `item 3`, or `items 1-4, 7`: numbers in ascending order.
pub(crate) fn ranges(what: &str, numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let runs: Vec<String> = runs
        .iter()
        .map(|&(first, last)| {
            if first == last {
                first.to_string()
            } else {
                format!("{first}-{last}")
            }
        })
        .collect();
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("{what}{plural} {}", runs.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::command;

    fn waypoint(x: i32, yaw: f32) -> Item {
        Item {
            x,
            params: [0.0, 0.0, 0.0, yaw],
            ..Item::without_place(command::NAV_WAYPOINT, [0.0; 4])
        }
    }

    #[test]
    fn the_same_change_of_many_items_is_listed_once_with_their_numbers() {
        let was = [1, 2, 3, 4].map(|x| waypoint(x, f32::NAN));
        let mut is = was;
        for index in [0, 1, 3] {
            is[index].params[3] = 0.0;
        }
        assert_eq!(
            changes("item", &was, &is),
            ["items 1-2, 4: param4 NaN becomes 0"]
        );
        assert!(changes("item", &was, &was).is_empty());
    }

    #[test]
    fn another_order_is_named_as_such_and_a_lost_item_by_count() {
        let was = [1, 2, 3].map(|x| waypoint(x, 0.0));
        let is = [was[2], was[0], was[1]];
        assert_eq!(changes("item", &was, &is), ["the order of the items"]);
        assert_eq!(changes("item", &was, &was[..2]), ["of 3 items 2 come back"]);
    }
}
