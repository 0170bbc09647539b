/* {{BEHAVIOUR}}: what was learned, for a program of your own. Written by a program: change nothing here.
 * C99, without any library but memset. policy.h says how it is used. */
#include "policy.h"

#include <string.h>

#define WIDTH BEHAVIOUR_WIDTH
#define HEIGHT BEHAVIOUR_HEIGHT
#define PIXELS (BEHAVIOUR_WIDTH * BEHAVIOUR_HEIGHT)

const double behaviour_actions[BEHAVIOUR_ACTIONS][2] = {
{{ACTION_ROWS}}};

{{TABLES}}
{{FILTERS}}
/* Counts the set pixels of each cell, from one edge to the next. */
static void count_cells(const uint8_t *mask, uint32_t *count, int rows, int columns, const uint16_t *row_edges,
                        const uint16_t *column_edges)
{
    for (int cell = 0; cell < rows * columns; cell++)
        count[cell] = 0;
    for (int row = 0; row < rows; row++)
        for (int y = row_edges[row]; y < row_edges[row + 1]; y++)
            for (int column = 0; column < columns; column++) {
                uint32_t sum = 0;
                for (int x = column_edges[column]; x < column_edges[column + 1]; x++)
                    sum += mask[y * WIDTH + x] & 1;
                count[row * columns + column] += sum;
            }
}
{{NUMBERS}}
void behaviour_start(behaviour_robot *robot)
{
    memset(robot, 0, sizeof *robot);
{{START}}}

uint32_t behaviour_state(behaviour_robot *robot, const uint8_t *pixels{{DIGITS_PARAMETER}})
{
{{STATE}}}

int behaviour_action(uint32_t state{{GUARDS_PARAMETER}})
{
{{ACTION}}}

int behaviour_met(uint32_t state)
{
    return state < BEHAVIOUR_STATES && (met[state >> 3] >> (state & 7)) & 1;
}
{{EDGES_DEFINED}}
