/* Keeps of each row what lies between so many pixels on the left and on the right. */
static void horizon(const uint8_t *in, uint8_t *out, const uint16_t *cleared)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            out[y * WIDTH + x] = x < cleared[y] || x >= WIDTH - cleared[y] ? 0 : in[y * WIDTH + x];
}
