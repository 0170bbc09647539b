/* Holds policy.c against what the engine saw: cc -O3 -o check check.c policy.c && ./check conformance.bin
 * For a port of your own put it in the place of policy.c. README.md says what is in the file. */
#include "policy.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS = BEHAVIOUR_WIDTH * BEHAVIOUR_HEIGHT, DIGITS = {{DIGIT_COUNT}} };

static behaviour_robot robot;
static uint8_t image[PIXELS * BEHAVIOUR_CHANNELS], mask[BEHAVIOUR_VIEWS * PIXELS], digits[DIGITS + 1];

static void take(FILE *file, void *to, size_t bytes)
{
    if (fread(to, 1, bytes, file) != bytes) {
        fprintf(stderr, "check: the file ends too early\n");
        exit(2);
    }
}

static uint32_t number(FILE *file)
{
    uint8_t b[4];
    take(file, b, 4);
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

int main(int arguments, char **argument)
{
    FILE *file = fopen(arguments > 1 ? argument[1] : "conformance.bin", "rb");
    char magic[8];
    if (!file) {
        fprintf(stderr, "check: cannot open the file\n");
        return 2;
    }
    take(file, magic, 8);
    uint32_t frames = number(file), head[6];
    for (int i = 0; i < 6; i++)
        head[i] = number(file);
    if (memcmp(magic, "BEHAVE1\n", 8) || head[0] != BEHAVIOUR_WIDTH || head[1] != BEHAVIOUR_HEIGHT ||
        head[2] != BEHAVIOUR_CHANNELS || head[3] != BEHAVIOUR_VIEWS || head[4] != BEHAVIOUR_CELLS || head[5] != DIGITS) {
        fprintf(stderr, "check: the file belongs to another policy\n");
        return 2;
    }
    uint32_t wrong = 0;
    behaviour_start(&robot);
    for (uint32_t frame = 0; frame < frames; frame++) {
        uint32_t anew = number(file), guards = number(file), faults = 0;
        take(file, image, sizeof image);
        take(file, digits, DIGITS);
        take(file, mask, sizeof mask);
        if (anew)
            behaviour_start(&robot);
        uint32_t state = behaviour_state(&robot, image{{DIGITS_PASSED}});
        faults |= memcmp(robot.mask, mask, sizeof mask) ? 1 : 0;
        for (int cell = 0; cell < BEHAVIOUR_CELLS; cell++)
            faults |= robot.count[cell] != number(file) ? 2 : 0;
        faults |= state != number(file) ? 4 : 0;
        faults |= (uint32_t)behaviour_action(state{{GUARDS_PASSED}}) != number(file) ? 8 : 0;
        if (faults) {
            wrong++;
            printf("frame %lu differs in:%s%s%s%s\n", (unsigned long)frame, faults & 1 ? " mask" : "",
                   faults & 2 ? " cells" : "", faults & 4 ? " state" : "", faults & 8 ? " action" : "");
        }
        (void)guards;
    }
    printf("%lu of %lu frames: mask, cells, state and action alike\n", (unsigned long)(frames - wrong), (unsigned long)frames);
    return wrong ? 1 : 0;
}
