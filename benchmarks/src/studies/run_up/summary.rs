//! Terminal summary of a record of `run-up`.

use crate::messages::Messages;
use gearbench_reports::numbers::{quantity, short};
use gearbench_reports::record::Results;
use gearbench_reports::run_up::strongest;

/// Largest number of peaks printed for each model.
const MOST: usize = 12;

/// Prints the strongest order of each quantity with the speed at which it peaks.
pub fn summarise(messages: &Messages, results: &Results) {
    for run in results.run_ups() {
        if !run.message.is_empty() {
            messages.print_line(&format!("{}: {}", run.label, run.message));
            continue;
        }
        messages.print_line(&format!(
            "{}: {} with mean speeds of the windows from {} to {} rad/s in {} revolutions, windows of {} {} and {}",
            run.label,
            run.gear,
            short(run.lowest_rad_s, 4),
            short(run.highest_rad_s, 4),
            short(run.turns, 4),
            short(run.by_turns.span, 4),
            if run.by_turns.span == 1.0 {
                "revolution"
            } else {
                "revolutions"
            },
            quantity(run.by_time.span, "s", 3)
        ));
        messages.print_line(&format!(
            "{:<40} {:<26} {:>9} {:>12} {:>12} {:>10}",
            "quantity", "order", "", "amplitude", "at rad/s", "at Hz"
        ));
        for peak in strongest(run, 1).iter().take(MOST) {
            messages.print_line(&format!(
                "{:<40} {:<26} {:>9} {:>12} {:>12} {:>10}",
                peak.channel.name,
                peak.order.name,
                short(peak.order.order, 5),
                quantity(peak.amplitude, &peak.channel.unit, 4),
                short(peak.speed_rad_s, 4),
                short(peak.frequency_hz(), 4)
            ));
        }
    }
}
