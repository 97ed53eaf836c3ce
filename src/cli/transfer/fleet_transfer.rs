//! The result of a transfer: table, sentences and record.

use std::path::Path;

use crate::cli::folder::replace;
use crate::cli::folder::runs;
use crate::cli::print::console::{Paint, note, out_lines};
use crate::cli::print::failure::Failure;
use crate::cli::print::table::Rows;
use crate::flight::STANDS_M;
use crate::link::{TransferReport, Verdict};
use crate::report::{UploadDocument, UploadedVehicle, json_text};

/// Differing items that are listed of each vehicle.
const MAX_DIFFERENCES: usize = 5;

/// The result of a transfer to a fleet.
pub(crate) struct FleetTransfer {
    pub(crate) reports: Vec<TransferReport>,
}

/// The verdict in one word, and the time of the transfer.
pub(crate) fn state(report: &TransferReport) -> String {
    match &report.verdict {
        Verdict::Verified => format!("verified, {:.1} s", report.seconds),
        Verdict::Failed(_) => "FAILED".to_owned(),
        Verdict::Refused(_) => "refused".to_owned(),
    }
}

/// The result of one transfer: a line, and indented ones with its details.
fn lines(report: &TransferReport) -> Vec<String> {
    let why = match &report.verdict {
        Verdict::Verified => "holds exactly its mission".to_owned(),
        Verdict::Failed(failure) => failure.to_string(),
        Verdict::Refused(refusal) => format!("refused: {refusal} (--force overrides)"),
    };
    let differences = report.differences.iter().take(MAX_DIFFERENCES);
    let texts = report.statustexts.iter();
    std::iter::once(format!("{}: {why}", report.vehicle))
        .chain(differences.map(|difference| format!("  {difference}")))
        .chain(texts.map(|text| format!("  the vehicle says: {text}")))
        .collect()
}

fn uploaded(report: &TransferReport) -> UploadedVehicle {
    let (verdict, reason) = match &report.verdict {
        Verdict::Verified => ("verified", None),
        Verdict::Failed(failure) => ("failed", Some(failure.to_string())),
        Verdict::Refused(refusal) => ("refused", Some(refusal.to_string())),
    };
    UploadedVehicle {
        vehicle: report.vehicle.clone(),
        sysid: report.sysid,
        autopilot: report.autopilot.clone(),
        version: report.version.clone(),
        items: report.items,
        fence: report.fence,
        rally: report.rally,
        attempts: report.attempts,
        retries: report.retries,
        seconds: report.seconds,
        hash: report.hash.clone(),
        from_home_m: report.from_home_m,
        plan_ids: report.plan_ids,
        verdict,
        reason,
        differences: report.differences.iter().map(ToString::to_string).collect(),
        statustexts: report.statustexts.clone(),
    }
}

impl FleetTransfer {
    /// The content of `upload.json`.
    pub(crate) fn document(&self) -> UploadDocument {
        UploadDocument {
            sortie: env!("CARGO_PKG_VERSION"),
            verdict: if self.is_verified() {
                "verified"
            } else {
                "failed"
            },
            reason: None,
            vehicles: self.reports.iter().map(uploaded).collect(),
        }
    }

    fn is_verified(&self) -> bool {
        !self.reports.is_empty() && self.reports.iter().all(TransferReport::is_verified)
    }

    /// Writes the record to `DIR.runs/`, under its time and as the newest.
    pub(crate) fn record(&self, target: &Path) -> Result<(), Failure> {
        let text = json_text(&self.document());
        let folder = runs::folder(target);
        replace::write_file(&runs::named(&folder, "upload", "json"), text.as_bytes())?;
        replace::write_file(&folder.join("upload.json"), text.as_bytes())?;
        Ok(())
    }

    pub(crate) fn print(&self) -> Result<(), Failure> {
        let mut rows = Rows::new(&[
            "vehicle", "system", "reports", "items", "fence", "rally", "on board", "hash",
        ]);
        rows.spare(&["hash", "system", "rally", "fence"]);
        for report in &self.reports {
            rows.add([
                report.vehicle.clone(),
                report.sysid.to_string(),
                format!("{} {}", report.autopilot, report.version)
                    .trim()
                    .to_owned(),
                report.items.to_string(),
                report.fence.to_string(),
                report.rally.to_string(),
                state(report),
                report.hash.chars().take(12).collect(),
            ]);
        }
        rows.print()?;
        self.print_failures()
    }

    /// Warns of vehicles that stand where their missions do not begin.
    pub(crate) fn warn(&self) {
        for (report, away_m) in self.reports.iter().filter_map(|report| {
            let away_m = report.from_home_m.filter(|away_m| *away_m > STANDS_M)?;
            Some((report, away_m))
        }) {
            let away = match away_m {
                near if near < 1000.0 => format!("{near:.0} m"),
                far => format!("{:.1} km", far / 1000.0),
            };
            let id = &report.vehicle;
            note(&format!(
                "warning: {id} stands {away} from the home of its mission: fly refuses that (allowed: {STANDS_M:.0} m)"
            ));
        }
    }

    /// Prints why each of the failed transfers did.
    pub(crate) fn print_failures(&self) -> Result<(), Failure> {
        let fail = Paint::for_stdout().bad("FAIL");
        let failed = self.reports.iter().filter(|report| !report.is_verified());
        failed.map(lines).try_for_each(|mut lines| {
            lines[0] = format!("{fail} {}", lines[0]);
            out_lines(&lines)
        })
    }

    pub(crate) fn verdict(&self) -> Result<(), Failure> {
        if self.is_verified() {
            return Ok(());
        }
        let failed = self
            .reports
            .iter()
            .filter(|report| !report.is_verified())
            .count();
        let message = format!(
            "{failed} of {} vehicles: mission not verified on board",
            self.reports.len()
        );
        Err(Failure::new(Failure::TRANSFER, message))
    }
}

#[cfg(test)]
mod tests {
    use super::{TransferReport, Verdict, lines};
    use crate::cli::print::console::shown;

    #[test]
    fn a_text_of_a_vehicle_is_one_line_and_commands_no_terminal() {
        let report = TransferReport {
            statustexts: vec!["\u{1b}[2K\r landed as planned\n".to_owned()],
            ..TransferReport::nothing("alpha", 1, Verdict::Verified)
        };
        let shown: Vec<String> = lines(&report)
            .iter()
            .map(|line| shown(line).into())
            .collect();
        assert_eq!(
            shown,
            [
                "alpha: holds exactly its mission",
                "  the vehicle says: \\u{1b}[2K\\r landed as planned\\n"
            ]
        );
    }
}
