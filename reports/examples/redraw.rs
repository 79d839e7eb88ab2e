//! Redraws reports.
fn main() {
    for dir in std::env::args_os().skip(1) {
        if let Err(e) = gearbench_reports::report_from(std::path::Path::new(&dir)) {
            eprintln!("{dir:?}: {e}");
        }
    }
}
