//! Names and links with the number of a vehicle in them.

/// Puts in the number of a vehicle: {n}, {n:03} in three digits, {14550+n}, {5750+10*n}.
/// None for braces with anything else in them.
pub(super) fn filled(template: &str, number: u64) -> Option<String> {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, after) = after.split_once('}')?;
        text += before;
        text += &counted(inside, number)?;
        rest = after;
    }
    (!rest.contains('}')).then(|| text + rest)
}

fn counted(inside: &str, number: u64) -> Option<String> {
    let (sum, digits) = match inside.split_once(":0") {
        Some((sum, digits)) => (sum, digits.parse().ok().filter(|digits| *digits <= 20)?),
        None => (inside, 1_usize),
    };
    let (from, count) = match sum.split_once('+') {
        Some((from, count)) => (from.parse::<u32>().ok()?, count),
        None => (0, sum),
    };
    // Of 32 bits, so that no vehicle's number leads out of 64.
    let step: u32 = match count.strip_suffix('n')? {
        "" => 1,
        step => step.strip_suffix('*')?.parse().ok()?,
    };
    let value = u64::from(step)
        .checked_mul(number)?
        .checked_add(u64::from(from))?;
    Some(format!("{value:0digits$}"))
}

#[cfg(test)]
mod tests {
    use super::filled;

    #[test]
    fn the_number_stands_where_the_braces_were() {
        for (template, text) in [
            ("d{n:03}", "d007"),
            ("{n}-{n}", "7-7"),
            ("udpout:127.0.0.1:{14550+n}", "udpout:127.0.0.1:14557"),
            ("tcp:127.0.0.1:{5750+10*n}", "tcp:127.0.0.1:5820"),
            ("10.0.{2*n}.1", "10.0.14.1"),
            ("sim", "sim"),
        ] {
            assert_eq!(filled(template, 7).as_deref(), Some(text), "{template}");
        }
        for template in [
            "{",
            "}",
            "{}",
            "{x}",
            "{n:3}",
            "{n+1}",
            "{-1+n}",
            "{n:099}",
            "{{n}}",
            "{4294967296*n}",
            "{9223372036854775807*n}",
            "{18446744073709551614+n}",
        ] {
            assert_eq!(filled(template, 7), None, "{template}");
        }
    }
}
