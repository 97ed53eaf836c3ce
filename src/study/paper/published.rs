//! The paper's Tables 2 and 3.
//!
//! Five rows of Table 2 do not add up to their published sum: MSFOA in all three scenarios (416.96
//! for 404.37, 404.21 for 382.95, 454.52 for 440.71), FOA (1109.74 for 520.27) and PSO (407.75 for
//! 520.27) in the second. By the added sums ABC leads the first scenario, MFOA the second.
//! Table 3 repeats the published sums as "best".
//!
//! The rows of PSO and FOA for the second scenario are the same in Table 3, so one is a copy. The
//! text says that MSFOA has the smallest mean on the second scenario; Table 3 gives it to MFOA.
//! The paper publishes no deviation, no test, no number of iterations, no threshold, no R, and
//! neither its maps nor its threats. Best runs of single vehicles taken from different runs would
//! sum to less than the best run, not to more.

use super::contestants::{Contestant, Role};

/// One algorithm of the paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Published {
    /// Its name.
    pub(super) label: &'static str,
    /// Table 2: the three vehicles and their published sum, for each scenario.
    pub(super) best: [[f64; 4]; 3],
    /// Table 3: average and median for each scenario; its best is the published sum.
    spread: [[f64; 2]; 3],
}

impl Published {
    /// Table 3: best, average, median.
    pub(super) fn spread(&self, scenario: usize) -> [f64; 3] {
        let [average, median] = self.spread[scenario];
        [self.best[scenario][3], average, median]
    }
}

/// Tables 2 and 3 as published.
pub(super) const PUBLISHED: [Published; 7] = [
    Published {
        label: "MSFOA",
        best: [
            [133.21, 138.09, 145.66, 404.37],
            [128.79, 125.52, 149.90, 382.95],
            [152.48, 145.19, 156.85, 440.71],
        ],
        spread: [[490.23, 466.56], [485.46, 505.18], [504.20, 492.95]],
    },
    Published {
        label: "FOA",
        best: [
            [165.22, 168.24, 173.69, 507.15],
            [155.16, 293.51, 661.07, 520.27],
            [307.26, 244.29, 178.91, 730.46],
        ],
        spread: [[708.73, 698.53], [755.35, 693.81], [1001.69, 993.81]],
    },
    Published {
        label: "PSO",
        best: [
            [146.27, 137.72, 201.16, 485.14],
            [123.72, 112.26, 171.77, 520.27],
            [228.07, 238.56, 162.09, 628.71],
        ],
        spread: [[797.76, 754.04], [755.35, 693.81], [953.93, 954.92]],
    },
    Published {
        label: "DE",
        best: [
            [158.20, 184.94, 218.39, 561.53],
            [232.28, 235.97, 187.56, 655.81],
            [207.78, 244.22, 212.59, 664.59],
        ],
        spread: [[674.52, 665.62], [761.37, 768.37], [809.74, 815.48]],
    },
    Published {
        label: "ABC",
        best: [
            [113.07, 142.89, 155.21, 411.16],
            [139.17, 112.85, 148.99, 401.02],
            [165.08, 125.62, 166.76, 457.45],
        ],
        spread: [[503.64, 497.22], [516.94, 520.93], [589.69, 591.39]],
    },
    Published {
        label: "IFFO",
        best: [
            [181.34, 146.80, 169.14, 497.29],
            [134.56, 154.59, 258.29, 547.44],
            [229.20, 165.71, 194.94, 589.85],
        ],
        spread: [[859.11, 860.97], [928.37, 908.26], [953.56, 934.38]],
    },
    Published {
        label: "MFOA",
        best: [
            [116.54, 155.41, 145.11, 417.07],
            [126.34, 109.93, 152.06, 388.33],
            [167.12, 146.68, 152.06, 465.87],
        ],
        spread: [[495.04, 493.33], [482.81, 475.26], [566.83, 564.83]],
    },
];

/// The published row of a contestant; both readings of R are MSFOA. `None` where the paper has
/// no such algorithm.
pub(super) fn of_contestant(contestant: &Contestant) -> Option<&'static Published> {
    let name = contestant.name.split('-').next()?;
    let mut rows = PUBLISHED.iter().filter(|_| contestant.role == Role::Paper);
    rows.find(|row| row.label.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_rows_of_the_paper_do_not_add_up() {
        let rows = PUBLISHED.iter().flat_map(|row| {
            let wrong = |map: &usize| {
                let [a, b, c, sum] = row.best[*map];
                // More than rounding.
                (a + b + c - sum).abs() > 0.0151
            };
            (0..3).filter(wrong).map(|map| (row.label, map + 1))
        });
        let expected = [
            ("MSFOA", 1),
            ("MSFOA", 2),
            ("MSFOA", 3),
            ("FOA", 2),
            ("PSO", 2),
        ];
        assert_eq!(rows.collect::<Vec<_>>(), expected);
    }
}
