#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;

#[test]
fn numbers_are_read_however_programs_write_them() {
    let real = |word: &str| number::<f64>(word);
    assert_eq!(real("1.5e3"), Some(1500.0));
    assert_eq!(real("-2.5D+02"), Some(-250.0));
    assert_eq!(real("1.25d-1"), Some(0.125));
    assert_eq!(real("+.5"), Some(0.5));
    assert_eq!(real("-0.5-100"), Some(-0.5e-100));
    assert_eq!(real("0.5+003"), Some(500.0));
    assert_eq!(real("-1.#INF000"), Some(f64::NEG_INFINITY));
    for nan in ["nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00", "1.#SNAN0"] {
        assert!(real(nan).unwrap().is_nan(), "{nan}");
    }
    for none in ["", "-", "one", "1.#", "1.0f", "1.5+e2", "d5", "0x10", "1,5", "3-", "é"] {
        assert_eq!(real(none), None, "{none}");
    }
    let byte = |word: &str| number::<u8>(word);
    assert_eq!(
        (byte("255"), byte("1.0"), byte("2.5e1"), byte("+7")),
        (Some(255), Some(1), Some(25), Some(7))
    );
    for none in ["256", "-1", "0.5", "nan", "inf", "1e9"] {
        assert_eq!(byte(none), None, "{none}");
    }
    assert_eq!(number::<i64>("-9223372036854775808"), Some(i64::MIN));
    assert_eq!(numbers::<u64>(" 1 2.0\t3 "), Some(vec![1, 2, 3]));
    assert_eq!(numbers::<u64>("1 x"), None);
}
