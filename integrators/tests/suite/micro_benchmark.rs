//! .
use crate::problems::*;
#[test]
fn probe() {
    for zeta in [0.0, 0.05] {
    let hammer = Hammer::one_impact(zeta);
    let t_end = after_impact(&hammer);
    for method in adaptive() {
        let mut last = 0.0f64;
        for i in 0..10 {
            let rtol = 10f64.powf(-4.0 - f64::from(i));
            if rtol < 1e-12 {break;}
            let (s, work, r) = run(method, &mut hammer.clone(), hammer.start(), &tolerance(t_end, rtol));
            let e = hammer.error(&s);
            println!("{:10} {rtol:.0e} {e:.2e} slope {:.2} steps {} rej {} f {} ev {} {:?}", method.info.id, (last/e).log10(), work.steps, work.rejected, work.force_evaluations, work.events, r.err());
            last = e;
        }
    }}
}
