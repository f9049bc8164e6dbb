//! Numbers as programs write them into text.

use crate::sources::stored::Element;

/// A number of the type asked for, however a program wrote it: `1.0` where a whole one is wanted, Fortran's `1.0D+00` and
/// `1.0-100`, C's `nan(ind)` and `-1.#IND` count. `None` if it is none, or of no value that the type has.
pub(in crate::sources) fn number<T: Element>(word: &str) -> Option<T> {
    word.parse().ok().or_else(|| T::of_value(real(word)?))
}

/// Splits into numbers, all of which must be; `None` if one is not.
pub(in crate::sources) fn numbers<T: Element>(text: &str) -> Option<Vec<T>> {
    text.split_whitespace().map(number).collect()
}

fn real(word: &str) -> Option<f64> {
    if let Ok(value) = word.parse() {
        return Some(value);
    }
    let lower = word.to_ascii_lowercase();
    let (sign, digits) = match lower.as_bytes().first()? {
        b'-' => (-1.0, &lower[1..]),
        b'+' => (1.0, &lower[1..]),
        _ => (1.0, &*lower),
    };
    if let Some((_, mark)) = digits.split_once(".#") {
        return if mark.starts_with("inf") {
            Some(sign * f64::INFINITY)
        } else {
            ["qnan", "snan", "nan", "ind"].iter().any(|nan| mark.starts_with(nan)).then_some(f64::NAN)
        };
    }
    if digits.starts_with("nan") {
        return Some(f64::NAN);
    }
    if let Some((mantissa, exponent)) = digits.split_once(['d', 'q']) {
        return Some(sign * format!("{mantissa}e{exponent}").parse::<f64>().ok()?);
    }
    // An exponent of three digits leaves Fortran no room for its letter.
    let at = digits.find(['+', '-']).filter(|at| *at > 0)?;
    let (mantissa, exponent) = digits.split_at(at);
    let is_mantissa = mantissa.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    is_mantissa.then(|| format!("{mantissa}e{exponent}").parse::<f64>().ok().map(|value| sign * value))?
}
