//! Formatting of numbers: significant digits, SI prefixes, grouped counts.

/// Text of a missing value, an en dash.
pub const ABSENT: &str = "\u{2013}";

/// Formats `x` with `digits` significant digits, and with a power of ten outside 1e-4 to 1e6; [`ABSENT`] if not finite.
pub fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return ABSENT.into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let digits = digits.max(1);
    // Through the exponent form, so that 9.996 to three digits becomes 10.0 and not 10.00.
    let scientific = format!("{:.*e}", digits - 1, x);
    let (mantissa, exponent) = match scientific.split_once('e') {
        Some((m, e)) => (m, e.parse::<i32>().unwrap_or(0)),
        None => return scientific,
    };
    let text = if !(-4..6).contains(&exponent) {
        format!("{mantissa}e{exponent}")
    } else {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let rounded: f64 = scientific.parse().unwrap_or(x);
        format!("{rounded:.decimals$}")
    };
    minus(text)
}

/// Formats `x` with a power of ten, whatever its magnitude.
pub fn power(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        ABSENT.into()
    } else if x == 0.0 {
        "0".into()
    } else {
        minus(format!("{:.*e}", digits.max(1) - 1, x))
    }
}

/// Formats `x` as [`significant`] does, without trailing zeros: for labels and prose.
pub fn short(x: f64, digits: usize) -> String {
    let text = significant(x, digits);
    let (mantissa, exponent) = text
        .split_once('e')
        .map_or((&*text, None), |(m, e)| (m, Some(e)));
    let mantissa = if mantissa.contains('.') {
        mantissa.trim_end_matches('0').trim_end_matches('.')
    } else {
        mantissa
    };
    match exponent {
        Some(e) => format!("{mantissa}e{e}"),
        None => mantissa.to_owned(),
    }
}

/// Returns the number of digits, at least `least`, at which different values differ and each is kept to 1/2000.
pub fn digits_apart(values: &[f64], least: usize) -> usize {
    let texts = |digits: usize| -> Vec<String> {
        (values.iter().map(|x| format!("{x:.*e}", digits - 1))).collect()
    };
    let different = |mut texts: Vec<String>| {
        texts.sort();
        texts.dedup();
        texts.len()
    };
    let kept = |digits: usize| {
        let back = |text: &String| text.parse().unwrap_or(f64::NAN);
        (texts(digits).iter().zip(values)).all(|(t, x)| (back(t) - x).abs() <= 5e-4 * x.abs())
    };
    // Seventeen digits distinguish any two numbers.
    let all = different(texts(17));
    (least.max(1)..17)
        .find(|&digits| different(texts(digits)) == all && kept(digits))
        .unwrap_or(17)
}

/// Threshold (a ratio, or a value in SI units) below which a number is rounding error and is written without digits.
pub const ROUNDING: f64 = 1e-12;

/// Formats a ratio in per cent, without the sign of the unit; below [`ROUNDING`] only as rounding.
pub fn percent(ratio: f64, digits: usize) -> String {
    if ratio != 0.0 && ratio.abs() < ROUNDING {
        return "<\u{a0}1e\u{2212}10".into();
    }
    significant(100.0 * ratio, digits)
}

/// Formats a ratio in per cent with its unit, such as `4.69 %`; without trailing zeros as [`short`].
pub fn per_cent(ratio: f64, digits: usize) -> String {
    if ratio.is_finite() {
        format!("{}\u{a0}%", percent(ratio, digits))
    } else {
        ABSENT.into()
    }
}

/// Formats a limit in per cent: `5 %`, `0.5 %`.
pub fn limit(ratio: f64) -> String {
    format!("{}\u{a0}%", short(100.0 * ratio, 3))
}

/// Formats a deviation in per cent with its sign, without the unit; a deviation below [`ROUNDING`] is 0.
pub fn deviation(ratio: f64, digits: usize) -> String {
    if ratio.abs() < ROUNDING {
        return "0".into();
    }
    let sign = if ratio > 0.0 { "+" } else { "" };
    format!("{sign}{}", significant(100.0 * ratio, digits))
}

/// Formats a number of things with their noun: `1 choice`, `2 choices`.
pub fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", count(n as u64), if n == 1 { one } else { many })
}

/// Formats a time with three digits in the unit that suits it, from nanoseconds to days: `12.5 ms`, `3.4 h`.
pub fn duration(seconds: f64) -> String {
    const LONG: [(f64, &str); 3] = [(86_400.0, "days"), (3600.0, "h"), (60.0, "min")];
    let long = LONG.into_iter().find(|(unit, _)| seconds >= 2.0 * unit);
    match long {
        Some((unit, name)) => format!("{}\u{a0}{name}", significant(seconds / unit, 3)),
        None => quantity(seconds, "s", 3),
    }
}

/// Returns a ratio of costs or steps in words, `2.8 times `; an empty text where it rounds to 1.0.
pub fn times(ratio: f64) -> String {
    match significant(ratio, 2).as_str() {
        "1.0" => String::new(),
        text => format!("{text} times "),
    }
}

/// Formats a count with its digits in groups of three.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out
}

/// An SI prefix with its factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prefix {
    /// Multiply SI values with this.
    pub factor: f64,
    /// Symbol to be written before the unit.
    pub symbol: &'static str,
}

impl Prefix {
    /// Returns the prefix under which a magnitude reads as 1 to 1000. `small_from` moves the boundary: 20 keeps 15 000
    /// N as `15000` and makes 25 000 N `25 kN`.
    pub fn of(magnitude: f64, small_from: f64) -> Self {
        const TABLE: [(f64, &str); 8] = [
            (1e-9, "n"),
            (1e-6, "\u{b5}"),
            (1e-3, "m"),
            (1.0, ""),
            (1e3, "k"),
            (1e6, "M"),
            (1e9, "G"),
            (1e12, "T"),
        ];
        let magnitude = magnitude.abs();
        let mut best = (1.0, "");
        if magnitude.is_finite() && magnitude > 0.0 {
            best = TABLE[0];
            for entry in TABLE {
                if magnitude >= small_from * entry.0 * (1.0 - 1e-9) {
                    best = entry;
                }
            }
        }
        Self {
            factor: 1.0 / best.0,
            symbol: best.1,
        }
    }
}

/// Converts a quantity in kilograms to grams, since a unit has one prefix at most.
fn in_grams(x: f64, unit: &str) -> (f64, &str) {
    match unit.strip_prefix('k') {
        Some(grams) if grams.starts_with('g') => (1e3 * x, grams),
        _ => (x, unit),
    }
}

/// Formats a quantity as [`quantity`] does, without trailing zeros: for steps and other given numbers.
pub fn round_quantity(x: f64, unit: &str, digits: usize) -> String {
    if !x.is_finite() || x.abs() < ROUNDING {
        return quantity(x, unit, digits);
    }
    let (x, unit) = in_grams(x, unit);
    let p = Prefix::of(x, 1.0);
    format!("{}\u{a0}{}{unit}", short(x * p.factor, digits), p.symbol)
}

/// Formats a quantity with prefix and unit, such as `1.23 ms`; zero below [`ROUNDING`].
pub fn quantity(x: f64, unit: &str, digits: usize) -> String {
    if !x.is_finite() {
        return ABSENT.into();
    }
    if x.abs() < ROUNDING {
        return format!("0\u{a0}{unit}");
    }
    let (x, unit) = in_grams(x, unit);
    let p = Prefix::of(x, 1.0);
    format!(
        "{}\u{a0}{}{unit}",
        significant(x * p.factor, digits),
        p.symbol
    )
}

/// Replaces hyphens by the minus sign, also in the exponent.
fn minus(text: String) -> String {
    text.replace('-', "\u{2212}")
}

/// Computes a quantile of the finite values, in any order, by linear interpolation between neighbours.
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let place = part.clamp(0.0, 1.0) * last as f64;
    let (low, rest) = (place.floor() as usize, place.fract());
    let high = (low + 1).min(last);
    Some(sorted[low] + rest * (sorted[high] - sorted[low]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_have_the_unit_that_suits_them() {
        let texts = [2.5e-8, 0.0125, 90.0, 150.0, 12_000.0, 1e6].map(duration);
        let plain = texts.map(|t| t.replace('\u{a0}', " "));
        assert_eq!(
            plain,
            [
                "25.0 ns",
                "12.5 ms",
                "90.0 s",
                "2.50 min",
                "3.33 h",
                "11.6 days"
            ]
        );
    }

    #[test]
    fn masses_have_one_prefix() {
        let found = [5.2404e-3, 12.0, 2.5e3].map(|x| quantity(x, "kg", 3));
        assert_eq!(found, ["5.24\u{a0}g", "12.0\u{a0}kg", "2.50\u{a0}Mg"]);
        assert_eq!(round_quantity(2e-3, "kg", 3), "2\u{a0}g");
    }

    #[test]
    fn significant_digits() {
        for (x, digits, expected) in [
            (0.0, 3, "0"),
            (9.996, 3, "10.0"),
            (0.048_61, 3, "0.0486"),
            (1234.5, 3, "1230"),
            (123_456.0, 4, "123500"),
            (2.5e7, 3, "2.50e7"),
            (-1.0e-9, 2, "\u{2212}1.0e\u{2212}9"),
            (f64::NAN, 3, ABSENT),
            (f64::INFINITY, 3, ABSENT),
        ] {
            assert_eq!(significant(x, digits), expected);
        }
        assert_eq!(short(5.0, 3), "5");
        assert_eq!(short(100.0, 3), "100");
        assert_eq!(short(2.50e7, 3), "2.5e7");
        assert_eq!(percent(0.0486, 3), "4.86");
        assert_eq!(digits_apart(&[1.5e-6, 1.49e-6, 1.5e-6], 1), 3);
        assert_eq!(digits_apart(&[1.5e-6], 1), 2);
        assert_eq!(digits_apart(&[1.0 / 3.0], 1), 4);
        assert_eq!(digits_apart(&[1e-6, 2e-6], 2), 2);
        assert_eq!(digits_apart(&[], 3), 3);
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
    }

    #[test]
    fn prefixes() {
        assert_eq!(quantity(1.234e-3, "s", 3), "1.23\u{a0}ms");
        assert_eq!(quantity(1e-6, "s", 3), "1.00\u{a0}\u{b5}s");
        assert_eq!(quantity(0.0, "s", 3), "0\u{a0}s");
        assert_eq!(Prefix::of(2.7e4, 20.0).symbol, "k");
        assert_eq!(Prefix::of(3.7e3, 20.0).symbol, "");
        assert_eq!(Prefix::of(0.0, 1.0).symbol, "");
        assert_eq!(round_quantity(1.5e-6, "s", 3), "1.5\u{a0}\u{b5}s");
        assert_eq!(round_quantity(2e-8, "s", 3), "20\u{a0}ns");
    }

    /// A shift of -9.89e-18 s, or an error of 4.4e-17 %, is none.
    #[test]
    fn rounding_is_told_as_such() {
        assert_eq!(quantity(-9.89e-18, "s", 3), "0\u{a0}s");
        assert_eq!(quantity(3e-12, "s", 3), "0.00300\u{a0}ns");
        assert_eq!(per_cent(4.4e-19, 2), "<\u{a0}1e\u{2212}10\u{a0}%");
        assert_eq!(per_cent(0.0, 2), "0\u{a0}%");
        assert_eq!(deviation(-4.4e-17, 3), "0");
        assert_eq!(deviation(0.0123, 3), "+1.23");
        assert_eq!(limit(0.005), "0.5\u{a0}%");
    }

    #[test]
    fn one_is_not_several() {
        assert_eq!(counted(1, "choice", "choices"), "1 choice");
        assert_eq!(counted(1200, "run", "runs"), "1\u{202f}200 runs");
        assert_eq!(times(2.78), "2.8 times ");
        assert_eq!(times(1.0), "");
    }

    #[test]
    fn quantiles_of_small_samples() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0], 0.9), Some(3.0));
        assert_eq!(quantile(&[4.0, 1.0, f64::NAN, 2.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[0.0, 10.0], 0.25), Some(2.5));
    }
}
