//! What the paper prints: its Tables 2 and 3, to stand beside what was measured.

use std::fmt::Write;

use super::contest::{Contestant, Role};

/// One algorithm of the paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Printed {
    /// Its name.
    pub(super) label: &'static str,
    /// Table 2: the three vehicles and their printed sum, for each scenario.
    pub(super) best: [[f64; 4]; 3],
    /// Table 3: best, average, median, for each scenario.
    pub(super) spread: [[f64; 3]; 3],
}

/// Tables 2 and 3, as printed.
pub(super) const PRINTED: [Printed; 7] = [
    Printed {
        label: "MSFOA",
        best: [
            [133.21, 138.09, 145.66, 404.37],
            [128.79, 125.52, 149.90, 382.95],
            [152.48, 145.19, 156.85, 440.71],
        ],
        spread: [
            [404.37, 490.23, 466.56],
            [382.95, 485.46, 505.18],
            [440.71, 504.20, 492.95],
        ],
    },
    Printed {
        label: "FOA",
        best: [
            [165.22, 168.24, 173.69, 507.15],
            [155.16, 293.51, 661.07, 520.27],
            [307.26, 244.29, 178.91, 730.46],
        ],
        spread: [
            [507.15, 708.73, 698.53],
            [520.27, 755.35, 693.81],
            [730.46, 1001.69, 993.81],
        ],
    },
    Printed {
        label: "PSO",
        best: [
            [146.27, 137.72, 201.16, 485.14],
            [123.72, 112.26, 171.77, 520.27],
            [228.07, 238.56, 162.09, 628.71],
        ],
        spread: [
            [485.14, 797.76, 754.04],
            [520.27, 755.35, 693.81],
            [628.71, 953.93, 954.92],
        ],
    },
    Printed {
        label: "DE",
        best: [
            [158.20, 184.94, 218.39, 561.53],
            [232.28, 235.97, 187.56, 655.81],
            [207.78, 244.22, 212.59, 664.59],
        ],
        spread: [
            [561.53, 674.52, 665.62],
            [655.81, 761.37, 768.37],
            [664.59, 809.74, 815.48],
        ],
    },
    Printed {
        label: "ABC",
        best: [
            [113.07, 142.89, 155.21, 411.16],
            [139.17, 112.85, 148.99, 401.02],
            [165.08, 125.62, 166.76, 457.45],
        ],
        spread: [
            [411.16, 503.64, 497.22],
            [401.02, 516.94, 520.93],
            [457.45, 589.69, 591.39],
        ],
    },
    Printed {
        label: "IFFO",
        best: [
            [181.34, 146.80, 169.14, 497.29],
            [134.56, 154.59, 258.29, 547.44],
            [229.20, 165.71, 194.94, 589.85],
        ],
        spread: [
            [497.29, 859.11, 860.97],
            [547.44, 928.37, 908.26],
            [589.85, 953.56, 934.38],
        ],
    },
    Printed {
        label: "MFOA",
        best: [
            [116.54, 155.41, 145.11, 417.07],
            [126.34, 109.93, 152.06, 388.33],
            [167.12, 146.68, 152.06, 465.87],
        ],
        spread: [
            [417.07, 495.04, 493.33],
            [388.33, 482.81, 475.26],
            [465.87, 566.83, 564.83],
        ],
    },
];

/// The printed row of a contestant, if the paper has it; both readings of R are MSFOA.
pub(super) fn printed(contestant: &Contestant) -> Option<&'static Printed> {
    if contestant.role != Role::Paper {
        return None;
    }
    let name = if contestant.name.starts_with("msfoa") {
        "msfoa"
    } else {
        contestant.name
    };
    PRINTED
        .iter()
        .find(|printed| printed.label.eq_ignore_ascii_case(name))
}

/// A sum may differ from its parts by this much through rounding.
const ROUNDING: f64 = 0.0151;

/// Which of the paper's sums do not add up, and what follows.
pub(super) fn sums(text: &mut String) {
    let _ = writeln!(
        text,
        "\n## The paper's own numbers\n\n\
         Rows of its Table 2 whose vehicles do not sum to what is printed as their sum; the other \
         rows do. Best runs of single vehicles taken from different runs would sum to less than \
         the best run, not to more. Table 3 repeats the printed sums as \"best\".\n\n\
         | row | parts | their sum | printed | printed minus sum |\n|---|---|---:|---:|---:|"
    );
    for printed in &PRINTED {
        for (map, [a, b, c, sum]) in (1..).zip(printed.best) {
            let added = a + b + c;
            if (added - sum).abs() > ROUNDING {
                let _ = writeln!(
                    text,
                    "| {}, scenario {map} | {a:.2}, {b:.2}, {c:.2} | {added:.2} | {sum:.2} | \
                     {:+.2} |",
                    printed.label,
                    sum - added
                );
            }
        }
    }
    let _ = writeln!(
        text,
        "\nThe order by printed sums, and by the sums of the parts:\n"
    );
    for map in 0..3 {
        let order = |value: fn([f64; 4]) -> f64| {
            let mut all: Vec<(f64, &str)> = PRINTED
                .iter()
                .map(|printed| (value(printed.best[map]), printed.label))
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let first = all.iter().take(3);
            let first: Vec<String> = first
                .map(|(sum, label)| format!("{label} {sum:.2}"))
                .collect();
            first.join(", ")
        };
        let _ = writeln!(
            text,
            "- scenario {}: printed {}; added {}.",
            map + 1,
            order(|[.., sum]| sum),
            order(|[a, b, c, _]| a + b + c)
        );
    }
    let _ = writeln!(
        text,
        "\nThe rows of PSO and FOA for the second scenario are the same in Table 3 (520.27, \
         755.35, 693.81), so one is a copy. The text says that MSFOA has the smallest mean on the \
         second scenario; Table 3 gives it to MFOA (482.81 against 485.46). There is neither a \
         deviation nor a test, and neither the number of iterations nor the threshold, R, the \
         maps and the threats are printed."
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_rows_of_the_paper_do_not_add_up() {
        let mut text = String::new();
        sums(&mut text);
        let rows = text.lines().filter(|line| line.contains(", scenario "));
        let rows: Vec<&str> = rows.collect();
        assert_eq!(rows.len(), 5, "{text}");
        assert!(rows[..3].iter().all(|row| row.starts_with("| MSFOA")));
        assert!(text.contains("added ABC 411.17, MSFOA 416.96, MFOA 417.06"));
    }
}
