//! Quantiles of Student's t distribution.

/// The half width, in standard errors, of a two-sided interval of a level with some degrees of freedom (1 or more): with
/// `t = sqrt(nu) tan(x)` the probability of `|t|` is that part of the integral of `cos^(nu-1)` up to `pi/2`.
pub fn two_sided(level: f64, freedom: f64) -> f64 {
    // From here on the distribution is normal to four digits.
    let nu = freedom.clamp(1.0, 2000.0);
    const PARTS: usize = 8000;
    let h = std::f64::consts::FRAC_PI_2 / PARTS as f64;
    let density = |i: usize| (h * i as f64).cos().max(0.0).powf(nu - 1.0);
    let cells: Vec<f64> = (0..PARTS)
        .map(|i| 0.5 * (density(i) + density(i + 1)))
        .collect();
    let wanted = level * cells.iter().sum::<f64>();
    let mut reached = 0.0;
    for (i, cell) in cells.iter().enumerate() {
        if reached + cell >= wanted {
            let x = h * (i as f64 + (wanted - reached) / cell);
            return nu.sqrt() * x.tan();
        }
        reached += cell;
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use super::two_sided;

    /// W. S. Gosset's table, as in any handbook.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (nu, t) in [
            (1.0, 12.706),
            (2.0, 4.3027),
            (5.0, 2.5706),
            (30.0, 2.0423),
            (1e9, 1.960),
        ] {
            let got = two_sided(0.95, nu);
            assert!((got / t - 1.0).abs() < 1e-3, "{nu}: {got}");
        }
    }
}
