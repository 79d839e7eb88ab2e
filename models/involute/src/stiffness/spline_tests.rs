use super::*;

fn uneven(n: usize) -> Vec<f64> {
    (0..=n)
        .map(|i| {
            let u = i as f64 / n as f64;
            0.004 + 0.018 * (u + 0.3 * u * (1.0 - u))
        })
        .collect()
}

fn cubic(s: &[f64], k: &[f64], ends: Ends) -> Spline {
    Spline::interpolate(s, k, ends, Interpolation::Cubic).unwrap()
}

#[test]
fn reproduces_cubics_and_their_slopes_on_uneven_knots() {
    let s = uneven(9);
    let f = |x: f64| 4e8 + 3e9 * x - 8e11 * x * x + 1e13 * x * x * x;
    let df = |x: f64| 3e9 - 16e11 * x + 3e13 * x * x;
    let k: Vec<f64> = s.iter().map(|&x| f(x)).collect();
    let curve = cubic(&s, &k, Ends::Clamped);
    for i in 0..=1000 {
        let x = s[0] + (s[9] - s[0]) * f64::from(i) / 1000.0;
        let (v, slope) = curve.eval(x);
        assert!((v / f(x) - 1.0).abs() < 1e-12);
        assert!(
            (slope - df(x)).abs() < 1e-10 * 3e10,
            "{x}: {slope} {}",
            df(x)
        );
    }
    assert_eq!(curve.eval(0.0), (k[0], 0.0));
    assert_eq!(curve.eval(1.0), (k[9], 0.0));
    assert!(curve.eval(f64::NAN).0.is_nan());
}

#[test]
fn is_twice_continuously_differentiable() {
    let s = uneven(12);
    let k: Vec<f64> = s.iter().map(|x| 1e8 * (2.0 + (700.0 * x).sin())).collect();
    let curve = cubic(&s, &k, Ends::Clamped);
    for i in 0..11 {
        let h = s[i + 1] - s[i];
        let [c0, c1, c2, c3] = curve.pieces[i].c;
        let next = curve.pieces[i + 1].c;
        assert!((c0 + h * (c1 + h * (c2 + h * c3)) - next[0]).abs() < 1e-6);
        assert!((c1 + h * (2.0 * c2 + 3.0 * h * c3) - next[1]).abs() < 1e-3);
        assert!((c2 + 3.0 * h * c3 - next[2]).abs() < 1e-9 * 1e8 * 700.0 * 700.0);
    }
}

#[test]
fn periodic_curve_repeats_smoothly_and_converges_at_fourth_order() {
    let period = 0.0118;
    let f = |x: f64| 2e8 * (1.0 + 0.2 * (2.0 * std::f64::consts::PI * x / period).cos());
    let error = |n: usize| {
        let s: Vec<f64> = (0..=n).map(|i| period * i as f64 / n as f64).collect();
        let k: Vec<f64> = s.iter().map(|&x| f(x)).collect();
        let curve = cubic(&s, &k, Ends::Periodic);
        (0..500)
            .map(|i| {
                let x = -period + 3.0 * period * f64::from(i) / 499.0;
                (curve.eval(x).0 - f(x)).abs()
            })
            .fold(0.0, f64::max)
    };
    let order = (error(16) / error(32)).log2();
    assert!((order - 4.0).abs() < 0.2, "{order}");
    for n in [2, 3] {
        assert!(error(n).is_finite());
    }
}

#[test]
fn linear_table_passes_its_points() {
    let (s, k) = (vec![0.0, 1e-3, 5e-3], vec![1e8, 3e8, 2e8]);
    let curve = Spline::interpolate(&s, &k, Ends::Clamped, Interpolation::Linear).unwrap();
    assert!((curve.eval(3e-3).0 - 2.5e8).abs() < 1e-6);
    assert!((curve.eval(3e-3).1 + 2.5e10).abs() < 1e-2);
    assert_eq!(
        (curve.minimum(), curve.maximum()),
        ((0.0, 1e8), (1e-3, 3e8))
    );
}

/// The interval is found on very uneven spacings, which exhaust the buckets.
#[test]
fn finds_the_interval_on_any_spacing() {
    let s = [0.0, 1e-9, 2e-9, 1.0, 1.0 + 1e-9, 5.0];
    let k = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let line = Interpolation::Linear;
    let curve = Spline::interpolate(&s, &k, Ends::Clamped, line).unwrap();
    for i in 0..5 {
        for u in [0.0, 0.25, 0.75] {
            let x = s[i] + u * (s[i + 1] - s[i]);
            assert!((curve.eval(x).0 - (k[i] + u)).abs() < 1e-6, "{x}");
        }
    }
    assert_eq!(curve.eval(5.0).0, 6.0);
}

#[test]
fn extremes_between_the_knots_are_found() {
    let s = uneven(8);
    let k: Vec<f64> = s.iter().map(|x| 1e8 * (2.0 + (500.0 * x).sin())).collect();
    let curve = cubic(&s, &k, Ends::Clamped);
    let dense = (0..=100_000).map(|i| curve.eval(s[0] + (s[8] - s[0]) * f64::from(i) / 1e5).0);
    let (low, high) = dense.fold((f64::MAX, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    assert!((curve.minimum().1 / low - 1.0).abs() < 1e-8);
    assert!((curve.maximum().1 / high - 1.0).abs() < 1e-8);
}

#[test]
fn refusals_name_the_place() {
    let build = |s: &[f64], k: &[f64], ends| {
        Spline::interpolate(s, k, ends, Interpolation::Cubic)
            .unwrap_err()
            .to_string()
    };
    let c = Ends::Clamped;
    assert!(build(&[0.0, 1.0], &[1.0], c).contains("one value per coordinate"));
    assert!(build(&[0.0], &[1.0], c).contains("two or more"));
    assert!(build(&[0.0, 2.0, 1.0], &[1.0; 3], c).contains("s[2] = 1"));
    assert!(build(&[0.0, f64::NAN], &[1.0; 2], c).contains("s[1]"));
    assert!(build(&[0.0, 1.0], &[1.0, f64::NAN], c).contains("value 1"));
    assert!(build(&[0.0, 1.0], &[1.0, 2.0], Ends::Periodic).contains("differ"));
}
