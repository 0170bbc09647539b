
/* A bit for each occupied cell, the top left one the lowest. */
static uint32_t cell_number(const uint32_t *count, const uint32_t *least, int cells)
{
    uint32_t number = 0;
    for (int cell = cells - 1; cell >= 0; cell--)
        number = number * 2 + (count[cell] >= least[cell]);
    return number;
}
