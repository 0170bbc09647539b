"""{{BEHAVIOUR}}: what was learned, for a program of your own. Written by a program: change nothing here. Needs numpy alone.

    policy = Policy()                       # before the first image; policy.start() whenever the robot was put somewhere else
    state = policy.state(image{{DIGITS_ARGUMENT}})
    linear, angular = ACTIONS[policy.action(state{{GUARDS_ARGUMENT}})]   # m/s, rad/s; hold them for PERIOD_S seconds
"""

import numpy

NAME = "{{BEHAVIOUR}}"
# The image: an array of bytes, HEIGHT x WIDTH for brightness (CHANNELS 1), HEIGHT x WIDTH x 3 for red, green and blue.
WIDTH, HEIGHT, CHANNELS = {{WIDTH}}, {{HEIGHT}}, {{CHANNELS}}
PERIOD_S = {{PERIOD}}
STATES = {{STATES}}
# Forward speed in m/s, turning speed in rad/s, anticlockwise positive.
ACTIONS = [
{{ACTION_ROWS}}]
{{DIGITS}}{{GUARDS}}
{{TABLE}}# A bit for each state that learning came to. Where others are frequent, the robot sees what it was not taught: slow down, or stop.
MET = bytes.fromhex("""
{{MET}}""")
{{FORBIDS}}

{{FILTERS}}

class View:
    """Filters, and a grid over what they leave: cells, and the number that they make."""

    def __init__(self, filters, rows, columns, fill, base, least, remembered_steps):
        self.filters, self.rows, self.columns, self.fill, self.base = filters, rows, columns, fill, base
        self.least, self.remembered_steps = numpy.array(least).reshape(rows, columns), remembered_steps
        self.start()

    def start(self):
        self.since = [None] * self.columns

    def number(self, image):
        for one in self.filters:
            image = one(image)
        self.mask = image
        rows = [row * HEIGHT // self.rows for row in range(self.rows + 1)]
        columns = [column * WIDTH // self.columns for column in range(self.columns + 1)]
        self.count = numpy.array([[int((image[top:bottom, left:right] == 255).sum()) for left, right in zip(columns, columns[1:])]
                                  for top, bottom in zip(rows, rows[1:])])
        occupied = self.count >= self.least
        if not self.fill:
            return sum(1 << cell for cell in range(occupied.size) if occupied.flat[cell])
        number = 0
        for column in range(self.columns):
            height = max((row + 1 for row in range(self.rows) if occupied[row, column]), default=0)
            number += self.digit(column, height) * self.base ** column
        return number

    def digit(self, column, height):
        """The height; the greatest digit where the column is empty and was not a while ago."""
        since = self.since[column]
        self.since[column] = 0 if height else None if since is None else since + 1
        gone = self.remembered_steps and not height and since is not None and since + 1 <= self.remembered_steps
        return self.base - 1 if gone else height


class Policy:
    """One robot's."""

    def __init__(self):
        self.views = [
{{VIEWS}}        ]

    def start(self):
        """The robot was put somewhere else."""
        for view in self.views:
            view.start()

    def state(self, image{{DIGITS_PARAMETER}}):
        """The number of the state that an image shows."""
        numbers = [view.number(image) for view in self.views]
        return {{STATE}}

    def action(self, state{{GUARDS_PARAMETER}}):
        """The best action of a state{{OF_ALLOWED}}; the slowest where nothing is known of it."""
{{CHOICE}}
    def met(self, state):
        """Whether learning came to this state."""
        return MET[state >> 3] >> (state & 7) & 1 == 1
{{EDGES}}
