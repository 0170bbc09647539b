#!/usr/bin/env python3
"""Measures the tables of docs/transfer.md: what was learned in one look or world, tested in others.

    python3 docs/transfer/measure.py [--engine target/release/engine] [--out runs/transfer] [--only ROW] [--threads N]

Run it from the folder of the project. It needs nothing but the engine. Seeds 5100 to 5129; nothing was chosen by them.
Each line is one cell: median and worst failures in 1,000 steps, seeds that are a success, the median of the untrained robot.
"""

import argparse
import json
import pathlib
import re
import statistics
import subprocess

SEEDS = range(5100, 5130)
# Steps of a test in a look or world that is not the script's own; wall and wall-depth are tested over the script's 5,000.
SHORT = ("--steps", 2000)
OWN = pathlib.Path("docs/transfer")

TILES = 'texture = { kind = "tiles", amplitude = 6, scale_m = 0.5, joint_m = 0.012, joint = 48 }'
BRICKS = 'texture = { kind = "bricks", amplitude = 7, scale_m = 0.25, joint_m = 0.012, joint = 24 }'
SHADOWS = "light.shadows=true"
# A behaviour, and its world.
DEPTH = [("corridor-depth", "corridor"), ("platform-depth", "platform")]
SPEEDS = [("0.20", 1.0), ("0.25", 1.25), ("0.30", 1.5), ("0.33", 1.65)]


class Bench:
    def __init__(self, engine, out, threads):
        self.engine, self.out, self.threads = engine, pathlib.Path(out), threads
        (self.out / "worlds").mkdir(parents=True, exist_ok=True)

    def call(self, *arguments):
        done = subprocess.run([self.engine, *map(str, arguments), "--json"], capture_output=True, text=True)
        # A test that is no success ends with 1; whatever is worse is no figure.
        if done.returncode not in (0, 1):
            raise SystemExit(f"engine {' '.join(map(str, arguments))}: {done.stderr}")
        return json.loads(done.stdout)

    def run(self, name, script, *more):
        """Thirty seeds; one that stands there already is not learned again."""
        folder = self.out / name
        if not (folder / "summary.json").exists():
            self.call("run", script, "--seed", SEEDS[0], "--seeds", len(SEEDS), "--threads", self.threads,
                      "--out", folder, "--force", *more)
        return folder

    def test(self, row, look, folder, *more):
        tests = [self.call("test", folder / str(seed), *more) for seed in SEEDS]
        self.tell(row, look, tests)

    def tell(self, row, look, tests):
        failures = [test["failures_per_1000"] for test in tests]
        untrained = statistics.median(test["untrained"]["failures_per_1000"] for test in tests)
        success = sum(test["verdict"]["success"] is True for test in tests)
        clean = sum(test["failures"] == 0 for test in tests)
        print(f"| {row} | {look} | {statistics.median(failures):.1f} / {max(failures):.1f} | {success} | {clean} "
              f"| {untrained:.1f} |", flush=True)

    def world(self, name, *changes):
        """A shipped world with lines changed, written beside the runs."""
        text = pathlib.Path(f"worlds/{name}.toml").read_text()
        for old, new in changes:
            changed = re.sub(old, new, text)
            assert changed != text, f"{name}: {old}"
            text = changed
        path = self.out / "worlds" / f"{name}-{len(changes)}.toml"
        path.write_text(text)
        return path

    def tiled(self, name):
        floor, wall = ("track", None) if name == "platform" else ("floor", "wall")
        texture = lambda kind: rf"\1\n{kind}"
        material = lambda of: rf'(name = "{of}"\ncolour = [^\n]*)'
        changes = [(material(floor), texture(TILES))]
        return self.world(name, *changes, *([(material(wall), texture(BRICKS))] if wall else []))


def looks(bench, row, folder, name, more=()):
    tiled = bench.tiled(name)
    bench.test(row, "plain", folder, "--world", f"worlds/{name}.toml", *more)
    bench.test(row, "shadows", folder, "--world", f"worlds/{name}.toml", "--set", SHADOWS, *more)
    bench.test(row, "tiles", folder, "--world", tiled, *more)
    bench.test(row, "both", folder, "--world", tiled, "--set", SHADOWS, *more)


def edges(bench):
    looks(bench, "wall, edges", bench.run("wall", "scripts/wall.rhai"), "room")


def depth(bench):
    looks(bench, "wall-depth", bench.run("wall-depth", "scripts/wall-depth.rhai"), "room")
    for name, world in DEPTH:
        # No colour is drawn where only depth is asked for: the four looks are the same steps, as those of the wall show.
        folder = bench.run(name, OWN / f"{name}.rhai")
        bench.test(name, "plain", folder)
        bench.test(name, "both", folder, "--world", bench.tiled(world), "--set", SHADOWS)


def floor(bench):
    for name in ["wall-floor-looks"]:
        looks(bench, name, bench.run(name, OWN / f"{name}.rhai"), "room", SHORT)


def chroma(bench):
    looks(bench, "wall-chroma", bench.run("wall-chroma", "scripts/wall-chroma.rhai"), "room-coloured", SHORT)


def prey(bench):
    for name in ["object", "object-speeds"]:
        folder = bench.run(name, f"scripts/{name}.rhai")
        for speed, times in SPEEDS:
            bench.test(name, f"{speed} m/s", folder, "--plain", "--set", f"movers.speed={times}", *SHORT)


def hallway(bench):
    opaque = bench.world("hallway", (r"laser = false\n", ""))
    scripts = [("wall", "scripts"), ("wall-anywhere", "scripts"), ("wall-equal", OWN), ("wall-home-4", OWN)]
    for name, place in scripts:
        folder = bench.run(name, pathlib.Path(place) / f"{name}.rhai")
        bench.test(name, "room", folder, "--world", "room", *SHORT)
        bench.test(name, "opaque hallway", folder, "--world", opaque, *SHORT)


def integrated(bench):
    name = "follow-and-avoid-learned"
    folder = bench.run(name, f"scripts/{name}.rhai")
    bench.test(name, "its own world", folder)


def going_on(bench):
    """Failures in each 1,000 steps of learning in the hallway, from the room's policy and from nothing."""
    opaque = bench.world("hallway", (r"laser = false\n", ""))
    room = bench.run("wall", "scripts/wall.rhai")
    for name, start in [("from the room", ["--from", room]), ("from nothing", [])]:
        thousands = []
        for thousand in range(1, 5):
            # Windows of failures end at 400: a thousand is the difference of two runs.
            folder = bench.run(f"hallway {name} {thousand}000".replace(" ", "-"), "scripts/wall.rhai", "--world", opaque,
                               "--steps", 1000 * thousand, *start)
            seeds = json.loads((folder / "summary.json").read_text())["seeds"]
            thousands.append([seed["failures"] for seed in seeds])
        each = [[b - a for a, b in zip(before, after)] for before, after in zip([[0] * len(SEEDS), *thousands], thousands)]
        cells = ", ".join(f"{statistics.median(one):.1f} / {max(one):.0f}" for one in each)
        print(f"| wall, {name} into the opaque hallway | failures in each 1,000 steps, median / worst | {cells} |", flush=True)
        bench.test(f"wall, {name}, after 4,000 steps", "opaque hallway", folder, *SHORT)


ROWS = [edges, depth, prey, hallway, integrated, chroma, floor, going_on]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--engine", default="target/release/engine")
    parser.add_argument("--out", default="runs/transfer")
    parser.add_argument("--threads", default="1")
    parser.add_argument("--only", choices=[row.__name__ for row in ROWS])
    arguments = parser.parse_args()
    bench = Bench(arguments.engine, arguments.out, arguments.threads)
    print("| behaviour | tested in | failures per 1,000, median / worst | success | without a failure | untrained |")
    print("|---|---|---|---|---|---|")
    for row in ROWS:
        if arguments.only in (None, row.__name__):
            row(bench)


if __name__ == "__main__":
    main()
