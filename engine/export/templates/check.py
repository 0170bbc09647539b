"""Holds policy.py against what the engine saw: python3 check.py [conformance.bin]. README.md says what is in the file."""

import sys

import numpy

import policy


def main():
    with open(sys.argv[1] if len(sys.argv) > 1 else "conformance.bin", "rb") as file:
        content = file.read()
    place = 8

    def numbers(count):
        nonlocal place
        place += 4 * count
        return [int(number) for number in numpy.frombuffer(content, "<u4", count, place - 4 * count)]

    def taken(count):
        nonlocal place
        place += count
        return numpy.frombuffer(content, numpy.uint8, count, place - count)

    own = policy.Policy()
    frames, width, height, channels, views, cells, digits = numbers(7)
    if content[:8] != b"BEHAVE1\n" or (width, height, channels) != (policy.WIDTH, policy.HEIGHT, policy.CHANNELS):
        sys.exit("check: the file belongs to another policy")
    wrong = 0
    for frame in range(frames):
        anew, guards = numbers(2)
        image = taken(width * height * channels).reshape((height, width) if channels == 1 else (height, width, 3))
        told, mask = taken(digits), taken(views * width * height)
        counts, [state, action] = numbers(cells), numbers(2)
        if anew:
            own.start()
        found = own.state(image{{DIGITS_TOLD}})
        faults = [
            ("mask", views and not numpy.array_equal(numpy.concatenate([view.mask.ravel() for view in own.views] or [mask]), mask)),
            ("cells", [int(count) for view in own.views for count in view.count.ravel()] != counts[:cells if own.views else 0]),
            ("state", found != state),
            ("action", own.action(found{{GUARDS_TOLD}}) != action),
        ]
        if any(differs for _, differs in faults):
            wrong += 1
            print(f"frame {frame} differs in: {' '.join(what for what, differs in faults if differs)}")
    print(f"{frames - wrong} of {frames} frames: mask, cells, state and action alike")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
