/* {{BEHAVIOUR}}: what was learned, for a program of your own. Written by a program: change nothing here.
 *
 * In every control period of BEHAVIOUR_PERIOD_S seconds:
 *
 *     uint32_t state = behaviour_state(&robot, pixels{{DIGITS_ARGUMENT}});
 *     int action = behaviour_action(state{{GUARDS_ARGUMENT}});
 *     drive(behaviour_actions[action][0], behaviour_actions[action][1]);
 *
 * Call behaviour_start before the first image, and whenever the robot was put somewhere else. Send the speeds again ten times a
 * second or more, and let the base stop by itself where they fail to come.
 */
#ifndef BEHAVIOUR_POLICY_H
#define BEHAVIOUR_POLICY_H

#include <stdint.h>

#define BEHAVIOUR_NAME "{{BEHAVIOUR}}"
/* The image: row-major from the top left; bytes of a pixel 1 (brightness) or 3 (red, green, blue). */
#define BEHAVIOUR_WIDTH {{WIDTH}}
#define BEHAVIOUR_HEIGHT {{HEIGHT}}
#define BEHAVIOUR_CHANNELS {{CHANNELS}}
#define BEHAVIOUR_PERIOD_S {{PERIOD}}
#define BEHAVIOUR_STATES {{STATES}}
#define BEHAVIOUR_ACTIONS {{ACTIONS}}
#define BEHAVIOUR_VIEWS {{VIEWS}}
#define BEHAVIOUR_CELLS {{CELLS}}
{{DIGITS}}{{GUARDS}}
/* Forward speed in m/s, turning speed in rad/s, anticlockwise positive. */
extern const double behaviour_actions[BEHAVIOUR_ACTIONS][2];

/* What one robot needs. Its fields may be read after behaviour_state: the mask of each view, 0 or 255, and of each cell, row by
 * row and view by view, how many pixels of it are set. */
typedef struct {
    uint8_t mask[BEHAVIOUR_VIEWS][BEHAVIOUR_WIDTH * BEHAVIOUR_HEIGHT];
    uint32_t count[BEHAVIOUR_CELLS];
{{ROOM}}} behaviour_robot;

void behaviour_start(behaviour_robot *robot);
/* The number of the state that an image shows, below BEHAVIOUR_STATES. */
uint32_t behaviour_state(behaviour_robot *robot, const uint8_t *pixels{{DIGITS_PARAMETER}});
/* The best action of a state{{OF_ALLOWED}}; the slowest where nothing is known of it. */
int behaviour_action(uint32_t state{{GUARDS_PARAMETER}});
/* 1 if learning came to this state. Where that is rare, the robot sees what it was not taught: slow down, or stop. */
int behaviour_met(uint32_t state);
{{EDGES_DECLARED}}
#endif
