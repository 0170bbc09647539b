//! Brightness, hue and saturation of a colour, as the filters count them.

/// The luma of a colour, 0 to 255: `(77 R + 150 G + 29 B) / 256`, as filters weigh colours.
pub(super) fn brightness([red, green, blue]: [u8; 3]) -> f64 {
    f64::from((u32::from(red) * 77 + u32::from(green) * 150 + u32::from(blue) * 29) >> 8)
}

/// The angle on the colour circle, degrees: red 0, green 120, blue 240; 0 of grey.
pub(super) fn hue_deg(colour: [u8; 3]) -> f64 {
    let [red, green, blue] = colour.map(f64::from);
    let (max, min) = (red.max(green).max(blue), red.min(green).min(blue));
    let spread = max - min;
    if spread == 0.0 {
        return 0.0;
    }
    let sixth = match () {
        () if max == red => (green - blue) / spread,
        () if max == green => 2.0 + (blue - red) / spread,
        () => 4.0 + (red - green) / spread,
    };
    (60.0 * sixth + 360.0) % 360.0
}

/// `(max - min) / max`, 0 to 1; 0 of black.
pub(super) fn saturation(colour: [u8; 3]) -> f64 {
    let [red, green, blue] = colour.map(f64::from);
    let (max, min) = (red.max(green).max(blue), red.min(green).min(blue));
    if max == 0.0 { 0.0 } else { (max - min) / max }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_told_as_filters_count_them() {
        // 77 * 200 + 150 * 100 = 30,400, divided by 256: 118.75, rounded down.
        assert_eq!(brightness([200, 100, 0]), 118.0);
        assert_eq!((hue_deg([200, 100, 0]), hue_deg([0, 0, 9]), hue_deg([200, 0, 100])), (30.0, 240.0, 330.0));
        assert_eq!((hue_deg([5, 5, 5]), saturation([0, 0, 0]), saturation([200, 100, 50])), (0.0, 0.0, 0.75));
    }
}
