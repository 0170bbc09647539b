#!/usr/bin/env python3
"""Draws the frames of tests/fixtures/rendered: what PyBullet's own renderer sees of worlds of this project.

    python3 docs/transfer/render.py OUT        # needs pybullet 3.2.7, numpy, pillow

The worlds are built from their TOML files by worlds/README.md alone: walls as boxes, a floor, one sun without shadows. Each frame is
named after its world and pose (x, y in centimetres, yaw in degrees).
"""

import math
import pathlib
import sys
import tomllib

import numpy as np
import pybullet as bullet
from PIL import Image

# The camera of scripts/wall.rhai, and the image.
FORWARD_M, HEIGHT_M, TILT_DEG, WIDE_DEG, SIZE = 0.10, 0.675, 42.0, 80.0, (160, 120)
# x, y, yaw: along the laps, near and far, straight and askew.
POSES = {
    "room": [(3.0, 0.6, 0), (6.9, 0.9, 30), (11.3, 5.0, 75), (8.0, 8.2, 200), (3.6, 7.5, 250)],
    "corridor": [(2.0, 0.3, 10), (9.2, 2.0, 95), (14.6, 10.6, 130), (0.4, 7.6, 215), (5.5, 11.2, 170)],
}


def box(half, centre, yaw, colour):
    shape = bullet.createVisualShape(bullet.GEOM_BOX, halfExtents=half, rgbaColor=[*(c / 255 for c in colour), 1],
                                     specularColor=[0, 0, 0])
    turn = bullet.getQuaternionFromEuler([0, 0, yaw])
    bullet.createMultiBody(0, baseVisualShapeIndex=shape, basePosition=centre, baseOrientation=turn)


def build(world):
    colours = {material["name"]: material["colour"] for material in world["material"]}
    box([40, 40, 0.5], [0, 0, -0.5], 0, colours[world["floor"]["material"]])
    for wall in world["wall"]:
        points = wall["points_m"] + wall["points_m"][:1] * wall.get("closed", False)
        thick, high = wall.get("thickness_m", 0.1), wall.get("height_m", 1.0)
        for (x, y), (to_x, to_y) in zip(points, points[1:]):
            # Up to the outer faces of the walls that it meets.
            half = [math.dist((x, y), (to_x, to_y)) / 2 + thick / 2, thick / 2, high / 2]
            box(half, [(x + to_x) / 2, (y + to_y) / 2, high / 2], math.atan2(to_y - y, to_x - x), colours[wall["material"]])


def see(light, x, y, yaw_deg):
    yaw, tilt = math.radians(yaw_deg), math.radians(TILT_DEG)
    eye = [x + FORWARD_M * math.cos(yaw), y + FORWARD_M * math.sin(yaw), HEIGHT_M]
    ahead = [math.cos(yaw) * math.cos(tilt), math.sin(yaw) * math.cos(tilt), -math.sin(tilt)]
    view = bullet.computeViewMatrix(eye, [e + a for e, a in zip(eye, ahead)], [0, 0, 1])
    width, height = SIZE
    high_deg = math.degrees(2 * math.atan(math.tan(math.radians(WIDE_DEG / 2)) * height / width))
    lens = bullet.computeProjectionMatrixFOV(high_deg, width / height, 0.02, 100)
    ambient = light["ambient"]
    pixels = bullet.getCameraImage(
        width, height, view, lens, lightDirection=light["towards"], lightColor=[1, 1, 1], lightDistance=1000, shadow=0,
        lightAmbientCoeff=ambient, lightDiffuseCoeff=1 - ambient, lightSpecularCoeff=0, renderer=bullet.ER_TINY_RENDERER)[2]
    return np.reshape(pixels, (height, width, 4))[:, :, :3].astype(np.uint8)


def main():
    out = pathlib.Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    for name, poses in POSES.items():
        bullet.connect(bullet.DIRECT)
        world = tomllib.loads(pathlib.Path(f"worlds/{name}.toml").read_text())
        build(world)
        for x, y, yaw_deg in poses:
            grey = see(world["light"], x, y, yaw_deg)
            assert (grey[:, :, 0] == grey[:, :, 2]).all(), "these worlds are grey"
            file = f"{name}-{round(100 * x)}-{round(100 * y)}-{yaw_deg}.png"
            Image.fromarray(grey[:, :, 0]).save(out / file, optimize=True)
        bullet.disconnect()


if __name__ == "__main__":
    main()
