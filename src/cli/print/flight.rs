//! The verdict on a flight, as printed.

use super::console::{Paint, out};
use super::failure::Failure;
use super::table::{self, Rows};
use crate::flight::{ErrorPercentiles, FlightReport, ServiceState, done_words};
use crate::report::END_AS_PLANNED;
use crate::verify::{Limit, Margin, Sense};

/// Prints the table of a flight that is over, and the limits that were violated.
pub(crate) fn report(judged: &FlightReport) -> Result<(), Failure> {
    let paint = Paint::for_stdout();
    vehicle_rows(judged, paint).print()?;
    let stopped = judged.vehicles.iter().filter(|of| !of.ended_as_planned);
    for of in stopped {
        out(&format!(
            "{} {}: {}; {END_AS_PLANNED}",
            paint.bad("FAIL"),
            of.vehicle,
            of.end
        ))?;
    }
    for of in &judged.vehicles {
        let left = of.served.iter().filter(|of| of.state != ServiceState::Done);
        let left: Vec<String> = left
            .map(|served| {
                format!(
                    "{} {} {}",
                    served.kind.word(),
                    served.id,
                    served.state.word()
                )
            })
            .collect();
        if !left.is_empty() {
            out(&format!(
                "{}: not seen done: {}",
                of.vehicle,
                left.join(", ")
            ))?;
        }
    }
    for margin in judged.margins.iter().filter(|m| m.other.is_some() || !m.ok) {
        out(&margin_line(margin, paint))?;
    }
    Ok(())
}

/// One row for each vehicle.
fn vehicle_rows(judged: &FlightReport, paint: Paint) -> Rows {
    let has_services = judged.vehicles.iter().any(|of| !of.served.is_empty());
    let mut headers = vec![
        "vehicle",
        "end",
        "cross-track error",
        "altitude error",
        "late",
        "clearance",
    ];
    headers.extend(has_services.then_some("done"));
    headers.push("");
    let mut rows = Rows::new(&headers);
    let spread = |spread: Option<ErrorPercentiles>| {
        spread.map_or_else(
            || "-".to_owned(),
            |s| format!("{:.1} / {:.1} / {:.1} m", s.median, s.p95, s.worst),
        )
    };
    for vehicle in &judged.vehicles {
        let latest = vehicle.late_s();
        let latest = latest.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let clearance = judged
            .margins
            .iter()
            .find(|m| m.vehicle == vehicle.vehicle && m.limit == Limit::TerrainClearance);
        let is_within = judged
            .margins
            .iter()
            .all(|margin| margin.ok || !margin.concerns(&vehicle.vehicle));
        let mut cells = vec![
            vehicle.vehicle.clone(),
            vehicle.end.clone(),
            spread(vehicle.cross_track_m),
            spread(vehicle.altitude_error_m),
            latest.map_or_else(|| "-".to_owned(), |s| format!("{s:.0} s at most")),
            clearance
                .filter(|margin| margin.value.is_finite())
                .map_or_else(|| "-".to_owned(), |m| format!("{:.0} m", m.value)),
        ];
        cells.extend(has_services.then(|| done_words(&vehicle.served)));
        cells.push(if is_within && vehicle.ended_as_planned {
            paint.good("ok")
        } else {
            paint.bad("FAIL")
        });
        rows.add(cells);
    }
    rows
}

/// The worst value of a limit as a line.
fn margin_line(margin: &Margin, paint: Paint) -> String {
    let whom = margin
        .other
        .as_ref()
        .map_or_else(String::new, |other| format!(" and {other}"));
    let sign = if margin.sense == Sense::AtLeast {
        ">="
    } else {
        "<="
    };
    let at = margin
        .at
        .map_or_else(String::new, |at| format!(" at T0+{}", table::clock(at.t_s)));
    let mark = if margin.ok {
        paint.good("ok")
    } else {
        paint.bad("FAIL")
    };
    format!(
        "{mark} {}{whom}: {} {} {} flown ({sign} {}){at} {}",
        margin.vehicle,
        margin.limit,
        table::number(margin.value, 1),
        margin.unit,
        table::number(margin.bound, 1),
        margin.note
    )
}
