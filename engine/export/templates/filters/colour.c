/* Pixels of one hue, counted in 1/256 of a sixth of the circle; saturation in 1/256. */
static void colour(const uint8_t *rgb, uint8_t *out, int32_t hue, int32_t width, int32_t saturation, int32_t dark)
{
    for (int i = 0; i < PIXELS; i++) {
        int32_t red = rgb[3 * i], green = rgb[3 * i + 1], blue = rgb[3 * i + 2];
        int32_t max = red > green ? red : green, min = red < green ? red : green;
        max = max > blue ? max : blue;
        min = min < blue ? min : blue;
        int32_t spread = max - min;
        out[i] = 0;
        if (spread == 0 || max < dark || spread * 256 < saturation * max)
            continue;
        int32_t own = max == red     ? (green - blue) * 256 / spread
                      : max == green ? 512 + (blue - red) * 256 / spread
                                     : 1024 + (red - green) * 256 / spread;
        int32_t apart = own > hue ? own - hue : hue - own;
        int32_t other = apart > 1536 ? apart - 1536 : 1536 - apart;
        out[i] = apart <= width || other <= width ? 255 : 0;
    }
}
