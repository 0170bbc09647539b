
/* The heights of the columns, the left one the lowest digit. */
static uint32_t height_number(const uint32_t *count, const uint32_t *least, int rows, int columns, uint32_t base)
{
    uint32_t number = 0;
    for (int column = columns - 1; column >= 0; column--) {
        int height = 0;
        for (int row = 0; row < rows; row++)
            if (count[row * columns + column] >= least[row * columns + column])
                height = row + 1;
        number = number * base + (uint32_t)height;
    }
    return number;
}
