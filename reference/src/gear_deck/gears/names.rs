//! Names of sets that make a body a gear; those of an instance have its name in front, `pinion-1.bore`.

use gearbench_models::geometry::Side;

/// The name without that of an instance.
fn own(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, own)| own)
}

/// Parts of a flank's name: `flank_3l`, `flank1_3l`, `flank2_m1r` (tooth -1). `None` for other names.
pub(in crate::gear_deck) fn flank_name(name: &str) -> Option<(i64, Side)> {
    let rest = own(name).strip_prefix("flank")?;
    let (gear, tooth) = rest.split_once('_')?;
    if !gear.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let side = match tooth.as_bytes().last()? {
        b'l' => Side::Left,
        b'r' => Side::Right,
        _ => return None,
    };
    let digits = &tooth[..tooth.len() - 1];
    let (sign, digits) = match digits.strip_prefix('m') {
        Some(digits) => (-1, digits),
        None => (1, digits),
    };
    if !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let label: u32 = digits.parse().ok()?;
    Some((sign * i64::from(label), side))
}

/// True for `bore`, `bore1`, `bore2`, ...
pub(in crate::gear_deck) fn is_bore_name(name: &str) -> bool {
    own(name)
        .strip_prefix("bore")
        .is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()))
}
