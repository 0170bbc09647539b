/* Whether the squared gradient of a pixel among its neighbours reaches `least`; kernels [side middle side]. */
static inline uint8_t edge(const uint8_t *above, const uint8_t *row, const uint8_t *below, int left, int x, int right,
                           int32_t side, int32_t middle, int32_t least)
{
    int32_t gx = side * (above[right] - above[left] + below[right] - below[left]) + middle * (row[right] - row[left]);
    int32_t gy = side * (below[left] - above[left] + below[right] - above[right]) + middle * (below[x] - above[x]);
    return gx * gx + gy * gy >= least ? 255 : 0;
}

/* Sobel (1, 2) or Scharr (3, 10); outside of the frame is the nearest pixel inside. */
static void edges(const uint8_t *in, uint8_t *out, int32_t side, int32_t middle, int32_t least)
{
    for (int y = 0; y < HEIGHT; y++) {
        const uint8_t *row = in + y * WIDTH;
        const uint8_t *above = y > 0 ? row - WIDTH : row;
        const uint8_t *below = y + 1 < HEIGHT ? row + WIDTH : row;
        uint8_t *to = out + y * WIDTH;
        for (int x = 1; x + 1 < WIDTH; x++)
            to[x] = edge(above, row, below, x - 1, x, x + 1, side, middle, least);
        to[0] = edge(above, row, below, 0, 0, WIDTH > 1 ? 1 : 0, side, middle, least);
        to[WIDTH - 1] = edge(above, row, below, WIDTH > 1 ? WIDTH - 2 : 0, WIDTH - 1, WIDTH - 1, side, middle, least);
    }
}
