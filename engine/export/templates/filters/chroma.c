/* Pixels whose shares of red and blue, in 1/4096, are off those of the strip at the bottom middle. */
static void chroma(const uint8_t *rgb, uint8_t *out, int rows, int columns, int left, int32_t tolerance)
{
    uint64_t sums[3] = {0, 0, 0};
    for (int y = HEIGHT - rows; y < HEIGHT; y++)
        for (int x = left; x < left + columns; x++)
            for (int c = 0; c < 3; c++)
                sums[c] += rgb[3 * (y * WIDTH + x) + c];
    uint64_t all = sums[0] + sums[1] + sums[2];
    int32_t floor_red = all ? (int32_t)((sums[0] * 4096 + all / 2) / all) : 4096 / 3;
    int32_t floor_blue = all ? (int32_t)((sums[2] * 4096 + all / 2) / all) : 4096 / 3;
    for (int i = 0; i < PIXELS; i++) {
        int32_t red = rgb[3 * i], blue = rgb[3 * i + 2], light = red + rgb[3 * i + 1] + blue;
        int32_t off_red = 4096 * red - floor_red * light, off_blue = 4096 * blue - floor_blue * light;
        int32_t off = (off_red < 0 ? -off_red : off_red) + (off_blue < 0 ? -off_blue : off_blue);
        out[i] = off > tolerance * light ? 255 : 0;
    }
}
