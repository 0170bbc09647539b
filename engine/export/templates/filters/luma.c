/* Brightness of colour pixels: (77 R + 150 G + 29 B) / 256, rounded down. */
static void luma(const uint8_t *rgb, uint8_t *out)
{
    for (int i = 0; i < PIXELS; i++)
        out[i] = (uint8_t)((77 * rgb[3 * i] + 150 * rgb[3 * i + 1] + 29 * rgb[3 * i + 2]) >> 8);
}
