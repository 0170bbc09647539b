/* Pixels at least so bright get one mark, the others the other. */
static void threshold(const uint8_t *in, uint8_t *out, uint8_t least, uint8_t bright, uint8_t dark)
{
    for (int i = 0; i < PIXELS; i++)
        out[i] = in[i] >= least ? bright : dark;
}
