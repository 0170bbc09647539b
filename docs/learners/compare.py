"""Lets DQN and PPO of Stable-Baselines3 learn a shipped behaviour, to compare them with the learners of the engine.

    cargo build --release -p engine --example outside
    python3 -m venv sb3 && sb3/bin/pip install stable-baselines3
    sb3/bin/python docs/learners/compare.py scripts/wall.rhai 5200 7600 10

The arguments: script, steps of learning, first seed, how many seeds. The program `outside` lends the robot of the script; the network sees
either which of the states it is in (one of 64, as the engine's learners do) or the share of each cell of the grid that is filled. One
line of JSON for each seed, on standard output: punishments until step 400, 2,000, 4,000 and the end, failures per 1,000 steps of
the test, and the processor seconds that the learner took, the robot's own not counted.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import gymnasium
import numpy
import torch
from stable_baselines3 import DQN, PPO

OUTSIDE = Path(__file__).parents[2] / "target/release/examples/outside"
TEST_STEPS = 5_000
PUNISHED_BY = (400, 2_000, 4_000)
# Chosen once, for few steps: small batches, a replay buffer that holds everything, an update in each step. Discount and net are alike.
NET = {"net_arch": [64, 64]}
DQN_SETTINGS = dict(learning_rate=1e-3, buffer_size=50_000, learning_starts=100, train_freq=1, batch_size=64, gamma=0.98,
                    target_update_interval=250, exploration_fraction=0.3, exploration_final_eps=0.01, policy_kwargs=NET)
PPO_SETTINGS = dict(learning_rate=1e-3, n_steps=200, batch_size=50, gamma=0.98, policy_kwargs=NET)


class Lent(gymnasium.Env):
    """The robot of a script: a step is an action of its list, an episode an attempt."""

    def __init__(self, script, seed, phase, sees):
        self.link = subprocess.Popen([OUTSIDE, script, str(seed), phase], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        words = self.link.stdout.readline().split()
        actions, cells, self.states = int(words[1]), int(words[3]), int(words[5])
        self.sees = sees
        size = cells if sees == "cells" else self.states
        self.action_space = gymnasium.spaces.Discrete(actions)
        self.observation_space = gymnasium.spaces.Box(0.0, 1.0, (size,), numpy.float32)
        self.punished_at, self.steps = [], 0
        self.seen = self.hear()[2]

    def hear(self):
        words = self.link.stdout.readline().split()
        if self.sees == "cells":
            seen = numpy.array(words[3:], numpy.float32)
        else:
            seen = numpy.zeros(self.states, numpy.float32)
            seen[int(words[2])] = 1.0
        return float(words[0]), words[1] == "1", seen

    def reset(self, *, seed=None, options=None):
        return self.seen, {}

    def step(self, action):
        self.link.stdin.write(f"{int(action)}\n")
        self.link.stdin.flush()
        reward, ended, self.seen = self.hear()
        self.steps += 1
        if ended and reward < 0.0:
            self.punished_at.append(self.steps)
        return self.seen, reward, ended, False, {}

    def close(self):
        self.link.stdin.close()
        self.link.wait()


def one(script, steps, seed, sees, kind):
    robot = Lent(script, seed, "learning", sees)
    make, settings = {"DQN": (DQN, DQN_SETTINGS), "PPO": (PPO, PPO_SETTINGS)}[kind]
    began = time.process_time()
    model = make("MlpPolicy", robot, seed=seed, device="cpu", **settings).learn(steps)
    seconds = time.process_time() - began
    robot.close()
    tested = Lent(script, seed, "test", sees)
    for _ in range(TEST_STEPS):
        tested.step(model.predict(tested.seen, deterministic=True)[0])
    tested.close()
    punished = [sum(at <= by for at in robot.punished_at) for by in PUNISHED_BY]
    return dict(script=Path(script).stem, learner=kind, sees=sees, seed=seed, steps=robot.steps, punished=punished,
                punished_in_all=len(robot.punished_at), test_per_1000=len(tested.punished_at) * 1_000 / TEST_STEPS,
                learner_s=round(seconds, 2))


def main():
    script, steps, first, count = sys.argv[1], *map(int, sys.argv[2:5])
    torch.set_num_threads(1)
    for seed in range(first, first + count):
        for kind in ("DQN", "PPO"):
            for sees in ("states", "cells"):
                print(json.dumps(one(script, steps, seed, sees, kind)), flush=True)


if __name__ == "__main__":
    main()
