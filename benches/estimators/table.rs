//! What is printed.

use nephroid::metrics::fit_slope;

use crate::{
    cost::{Row, Series},
    exact::{Case, Reference},
};

/// An error of which the time is always told.
const TARGET: f64 = 1e-3;

/// The scene and the columns of its table.
pub(crate) fn heading(case: &Case, reference: &Reference) {
    say(&format!(
        "\n{}: window {} m, {} px; relMSE of the reference {:.0e}",
        case.name, case.window.width, case.window.pixels, reference.error
    ));
    say("method                photons     CPU s    relMSE");
}

/// A method's pictures.
pub(crate) fn rows(series: &Series) {
    for row in &series.rows {
        say(&format!(
            "{:16} {:12}  {:8.3}  {:8.2e}",
            series.name, row.photons, row.seconds, row.error
        ));
    }
}

/// Our time to the least error of SPPM, with the radius that serves it best
/// and with the untuned one, and how fast our error falls.
pub(crate) fn summary(own: &Series, progressive: &[Series], untuned: usize) {
    let least = |s: &Series| s.best().map_or(f64::INFINITY, |row| row.error);
    let tuned = progressive
        .iter()
        .min_by(|a, b| least(a).total_cmp(&least(b)));
    if let Some(series) = tuned {
        versus("tuned", own, series);
    }
    if let Some(series) = progressive.get(untuned) {
        versus("untuned", own, series);
    }
    match own.cost_to(TARGET) {
        Some([seconds, photons]) => say(&format!(
            "nephroid to relMSE {TARGET:e}: {seconds:.2} s, {photons:.0} photons"
        )),
        None => say(&format!("nephroid did not reach relMSE {TARGET:e}")),
    }
    slopes(own, "photons");
}

fn versus(how: &str, own: &Series, rival: &Series) {
    let Some(best) = rival.best() else {
        return;
    };
    let what = format!(
        "{how} {}: {:.2e} in {:.2} s, {} photons",
        rival.name, best.error, best.seconds, best.photons
    );
    let Some([seconds, photons]) = own.cost_to(best.error) else {
        return say(&format!("{what}; nephroid did not reach that"));
    };
    // The first picture may be better than what was asked for.
    let first = own.rows.first().is_some_and(|r| r.error <= best.error);
    let least = if first { "at least " } else { "" };
    say(&format!(
        "{what}; nephroid {seconds:.2} s, {photons:.0} photons: {least}{:.2} times faster, {:.2} times fewer",
        best.seconds / seconds,
        best.photons as f64 / photons
    ));
}

/// Exponents of the error against photons, or what else the rows count, and
/// seconds, with their 95 % confidence intervals.
pub(crate) fn slopes(series: &Series, counted: &str) {
    let errors: Vec<f64> = series.rows.iter().map(|r| r.error).collect();
    let by = |what: &str, cost: fn(&Row) -> f64| {
        let costs: Vec<f64> = series.rows.iter().map(cost).collect();
        let Some(fit) = fit_slope(&costs, &errors) else {
            return format!("too few pictures for a slope by {what}");
        };
        let half = student(costs.len() - 2) * fit.standard_error;
        format!("{what}^({:.2} +- {half:.2})", fit.slope)
    };
    say(&format!(
        "{} error ~ {}, {}",
        series.name,
        by(counted, |r| r.photons as f64),
        by("seconds", |r| r.seconds)
    ));
}

/// Student's t for a two-sided probability of 95 %, by degrees of freedom.
fn student(freedom: usize) -> f64 {
    const T: [f64; 10] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    ];
    // Beyond ten the normal law's 1.96 is near enough from below, so the
    // last entry is kept: intervals are then a little too wide.
    T[freedom.clamp(1, T.len()) - 1]
}

/// One line to whoever runs the bench.
#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
pub(crate) fn say(line: &str) {
    println!("{line}");
}
