
/* A column that is empty now and was not in one of the last steps is gone: the greatest digit. */
static uint32_t with_gone(uint32_t heights, uint32_t *since, int columns, uint32_t base, uint32_t steps)
{
    uint32_t rest = heights, place = 1, added = 0;
    for (int column = 0; column < columns; column++) {
        uint32_t height = rest % base;
        if (height > 0)
            since[column] = 0;
        else if (since[column] < UINT32_MAX)
            since[column]++;
        if (height == 0 && since[column] <= steps)
            added += place * (base - 1);
        rest /= base;
        place *= base;
    }
    return heights + added;
}
