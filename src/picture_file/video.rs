//! Frames for video encoders: YUV4MPEG2, as mjpegtools' `yuv4mpeg(5)` describes it.
//!
//! Colours are those of ITU-R BT.601 in the limited range, which is what readers take a file of this kind for that does not say: it has no
//! word for it. No pixel shares its colour with another (4:4:4).

/// What stands at the head of a file. `rate` is frames a second, as a ratio.
pub(super) fn head(width: u32, height: u32, (frames, seconds): (u64, u64)) -> String {
    format!("YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C444 XYSCSS=444 XCOLORRANGE=LIMITED\n")
}

/// A frame with its own head: all of Y, all of Cb, all of Cr.
pub(super) fn in_yuv(pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = b"FRAME\n".to_vec();
    let all: Vec<[u8; 3]> = pixels.iter().map(|pixel| yuv(*pixel)).collect();
    for plane in 0..3 {
        bytes.extend(all.iter().map(|pixel| pixel[plane]));
    }
    bytes
}

/// BT.601-7, 2.5.1 and 2.5.3: luma from 16 to 235, differences of colour from 16 to 240.
fn yuv(rgb: [u8; 3]) -> [u8; 3] {
    let [r, g, b] = rgb.map(|part| f64::from(part) / 255.0);
    let luma = 0.299 * r + 0.587 * g + 0.114 * b;
    let [y, cb, cr] =
        [16.0 + 219.0 * luma, 128.0 + 224.0 * (b - luma) / 1.772, 128.0 + 224.0 * (r - luma) / 1.402];
    [y, cb, cr].map(|part| part.round() as u8)
}

/// Frames a second as a ratio of whole numbers: 25 is 25:1, and 29.97 what it stands for, 30000:1001.
pub(crate) fn ratio(rate: f64) -> (u64, u64) {
    // Rates of old television, 1000/1001 of a whole number, are told by two or three digits.
    let nominal = (rate * 1.001).round();
    if rate.fract() != 0.0 && nominal >= 1.0 && (nominal * 1000.0 / 1001.0 - rate).abs() < 0.005 {
        return (nominal as u64 * 1000, 1001);
    }
    // Continued fraction (Hardy and Wright, 10.2): each step is the best ratio with so small a denominator.
    let (mut before, mut last) = ((0u64, 1u64), (1u64, 0u64));
    let mut rest = rate;
    while rest.is_finite() && rest < 1e12 {
        let whole = rest.floor();
        let next = |before: u64, last: u64| (whole as u64).checked_mul(last)?.checked_add(before);
        let (Some(frames), Some(seconds)) = (next(before.0, last.0), next(before.1, last.1)) else { break };
        if frames.max(seconds) > u64::from(u32::MAX) {
            break;
        }
        (before, last) = (last, (frames, seconds));
        if (frames as f64 / seconds as f64 - rate).abs() <= 1e-9 * rate {
            break;
        }
        rest = (rest - whole).recip();
    }
    (last.0.max(1), last.1.max(1))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn rates_are_ratios() {
        let cases = [
            (25.0, (25, 1)),
            (1.0, (1, 1)),
            (12.5, (25, 2)),
            (0.25, (1, 4)),
            (1.0 / 3.0, (1, 3)),
            (23.976, (24_000, 1001)),
            (29.97, (30_000, 1001)),
            (30_000.0 / 1001.0, (30_000, 1001)),
            (59.94, (60_000, 1001)),
            (1e9, (1_000_000_000, 1)),
        ];
        for (rate, expected) in cases {
            assert_eq!(ratio(rate), expected, "{rate}");
        }
        for extreme in [1e-300, 1e300, std::f64::consts::PI] {
            let (frames, seconds) = ratio(extreme);
            assert!(frames > 0 && seconds > 0, "{extreme}");
        }
    }

    /// By another reader.
    #[test]
    fn what_is_written_can_be_read() {
        let pixels = [[0, 0, 0], [255, 255, 255], [255, 0, 0], [0, 255, 0], [0, 0, 255], [100, 150, 200]];
        let mut file = head(3, 2, (30_000, 1001)).into_bytes();
        file.extend(in_yuv(&pixels));
        file.extend(in_yuv(&[[128; 3]; 6]));
        let mut decoder = y4m::decode(file.as_slice()).unwrap();
        assert_eq!((decoder.get_width(), decoder.get_height()), (3, 2));
        assert!(matches!(decoder.get_colorspace(), y4m::Colorspace::C444));
        let rate = decoder.get_framerate();
        assert_eq!((rate.num, rate.den), (30_000, 1001));
        let frame = decoder.read_frame().unwrap();
        let planes = [frame.get_y_plane(), frame.get_u_plane(), frame.get_v_plane()];
        // As tables of colour bars have them (BT.601 at 100 %).
        let bars = [(0, [16, 128, 128]), (1, [235, 128, 128]), (2, [81, 90, 240]), (3, [145, 54, 34])];
        for (pixel, expected) in bars.into_iter().chain([(4, [41, 240, 110])]) {
            assert_eq!(planes.map(|plane| plane[pixel]), expected, "{pixel}");
        }
        for (pixel, expected) in pixels.iter().enumerate() {
            let [y, cb, cr] = planes.map(|plane| f64::from(plane[pixel]));
            let (y, cb, cr) =
                ((y - 16.0) * 255.0 / 219.0, (cb - 128.0) * 255.0 / 224.0, (cr - 128.0) * 255.0 / 224.0);
            let back = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
            for (back, expected) in back.iter().zip(expected) {
                assert!((back - f64::from(*expected)).abs() < 2.0, "{pixel}: {back} {expected}");
            }
        }
        assert!(decoder.read_frame().is_ok());
        assert!(matches!(decoder.read_frame(), Err(y4m::Error::EOF)));
    }
}
