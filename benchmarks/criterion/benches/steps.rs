//! Criterion: one run of `spur_impact` per model and method, as shipped.
//!
//! `cargo bench --manifest-path benchmarks/criterion/Cargo.toml`

#[path = "../../benches/support/mod.rs"]
mod support;

use criterion::{Criterion, criterion_group, criterion_main};
use gearbench_integrators::{NullSink, Resolution, Stepping, TimePlan, Work};
use support::spur_impact;

fn steps(c: &mut Criterion) {
    for label in ["rigid", "movable-teeth"] {
        let (mut scene, end) = spur_impact(label);
        let mut group = c.benchmark_group(label);
        for row in gearbench_integrators::METHODS {
            let resolution = match row.info.stepping {
                Stepping::Fixed => Resolution::Step(1e-6),
                _ => Resolution::Tolerance(1e-6),
            };
            let mut method = row.build();
            let plan = TimePlan::new(end, resolution);
            group.bench_function(row.info.id, |b| {
                b.iter(|| {
                    let mut s = scene.initial();
                    method.run(&mut scene, &mut s, &plan, &mut NullSink, &mut Work::default())
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
