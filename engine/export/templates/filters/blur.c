/* The mean around each pixel, with these weights in both directions; outside of the frame is the nearest pixel inside. */
static void blur(const uint8_t *in, uint8_t *out, uint32_t *sums, const uint32_t *weights, int radius)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint32_t sum = 0;
            for (int k = -radius; k <= radius; k++) {
                int from = x + k < 0 ? 0 : x + k >= WIDTH ? WIDTH - 1 : x + k;
                sum += weights[k + radius] * in[y * WIDTH + from];
            }
            sums[y * WIDTH + x] = sum;
        }
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint64_t total = ((uint64_t)1 << (4 * radius)) >> 1;
            for (int k = -radius; k <= radius; k++) {
                int from = y + k < 0 ? 0 : y + k >= HEIGHT ? HEIGHT - 1 : y + k;
                total += (uint64_t)weights[k + radius] * sums[from * WIDTH + x];
            }
            out[y * WIDTH + x] = (uint8_t)(total >> (4 * radius));
        }
}
