#!/usr/bin/env python3
"""Writes pool.pbrt: a pool in the sun, seen through the open side of a house in which lamps shine.

The sun, a spot in the image of the sky, lights the pool's floor through the waves and draws their light on the garden
wall; half of the lamps are in a room behind the camera. No ray towards a light passes the water, so what the pool's
floor looks like is for integrators that follow light from the lights."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import armchair, plant, round_table, rug
from scenekit import Mesh, Piece, Scene, box, diffuse, panel, quad, wall
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 6.0, 4.5, 2.7, .2               # the room; its north side, at y = D, is open
X0, X1, Y0, Y1, DEEP = .8, 5.2, 5.9, 9.2, 1.1  # the pool
WATER = -.12
GARDEN, WALL = 10.2, 2.4                     # the garden wall behind the pool, and the one in the east


def waves(nx, ny):
    """The water's surface: some waves of different lengths and directions."""
    trains = [(2.3, 25, .011, .3), (1.3, 70, .007, 1.9), (.85, -20, .0045, 4.1), (.55, 50, .0025, 2.6),
              (.45, 110, .0018, 5.2)]

    def height(x, y):
        return sum(a * math.sin(2 * math.pi * (x * math.cos(math.radians(t)) + y * math.sin(math.radians(t))) / length
                                + phase) for length, t, a, phase in trains)

    def slope(x, y, step=1e-3):
        return ((height(x + step, y) - height(x - step, y)) / (2 * step),
                (height(x, y + step) - height(x, y - step)) / (2 * step))

    mesh = Mesh(normals=[])
    for k in range(ny + 1):
        for i in range(nx + 1):
            x, y = X0 + (X1 - X0) * i / nx, Y0 + (Y1 - Y0) * k / ny
            mesh.vertices.append((x, y, WATER + height(x, y)))
            sx, sy = slope(x, y)
            length = math.sqrt(sx * sx + sy * sy + 1)
            mesh.normals.append((-sx / length, -sy / length, 1 / length))
    for k in range(ny):
        for i in range(nx):
            a = k * (nx + 1) + i
            b, c, d = a + 1, a + nx + 2, a + nx + 1
            mesh.faces += [(a, b, c), (a, c, d)]
    return mesh


scene = Scene("pool", "A pool in the sun, seen out of a house in which lamps shine.", 480, 320, spp=64, maxdepth=8,
              integrator="sppm")
scene.render[-1] += ' "float radius" .06 "integer photonsperiteration" 100000'
scene.camera((.7, 1.5, 1.7), (3.4, 7.4, .05), 58)
scene.material("paint", diffuse(.75, .72, .66))
scene.material("floor", diffuse(.42, .3, .2))
scene.material("ceiling", diffuse(.8, .8, .78))
scene.material("stone", diffuse(.62, .58, .5))
scene.material("tiles", diffuse(.35, .62, .7))
scene.material("garden-wall", diffuse(.78, .74, .68))
scene.material("lawn", diffuse(.14, .24, .07))
scene.material("water", '"string type" "dielectric" "float eta" 1.33')
sun = Sun(205, 43, share=.8, radius=1.2)
sky_light(scene, sky_image(128, clear_sky(sun), sun), scale=.22, label="the sky with the sun")

# The house: two rooms, the northern one open to the garden.
scene.add(box((-T, -4, -.2), (W + T, D, 0)), "floor", material="floor")
scene.add(box((-T, -4, H), (W + T, D, H + .2)), "ceiling", material="ceiling")
for label, start, end, openings in (
        ("west wall", (-T / 2, -4), (-T / 2, D), ()), ("east wall", (W + T / 2, -4), (W + T / 2, D), ()),
        ("south wall", (-T, -4 + T / 2), (W + T, -4 + T / 2), ()),
        ("wall between the rooms", (0, -.1), (W, -.1), ((4.4, 5.3, 0, 2.05),))):
    scene.add(wall(start, end, T, H, openings), label, material="paint")
scene.add(wall((0, D - .1), (W, D - .1), T, H, ((.4, 5.6, 0, 2.35),)), "the open side", material="paint")

# The pool and the garden.
scene.add(box((-4, D, -.2), (W + 4, Y0, 0)), "terrace", material="stone")
scene.add(box((-4, Y0, -.2), (X0, Y1, 0)), material="stone")
scene.add(box((X1, Y0, -.2), (W + 4, Y1, 0)), material="stone")
scene.add(box((-4, Y1, -.2), (W + 4, GARDEN + .3, 0)), "behind the pool", material="lawn")
scene.add(quad((X0, Y0, -DEEP), (X1, Y0, -DEEP), (X1, Y1, -DEEP), (X0, Y1, -DEEP)), "pool", material="tiles")
scene.add(quad((X0, Y1, -DEEP), (X1, Y1, -DEEP), (X1, Y1, 0), (X0, Y1, 0)), material="tiles")
scene.add(quad((X1, Y0, -DEEP), (X0, Y0, -DEEP), (X0, Y0, 0), (X1, Y0, 0)), material="tiles")
scene.add(quad((X0, Y0, -DEEP), (X0, Y1, -DEEP), (X0, Y1, 0), (X0, Y0, 0)), material="tiles")
scene.add(quad((X1, Y1, -DEEP), (X1, Y0, -DEEP), (X1, Y0, 0), (X1, Y1, 0)), material="tiles")
scene.add(waves(88, 66), "water", material="water")
scene.add(box((-4, GARDEN, 0), (W + 4, GARDEN + .2, WALL)), "garden wall", material="garden-wall")
scene.add(box((W + .6, D + .2, 0), (W + .8, GARDEN, WALL)), "eastern garden wall", material="garden-wall")
scene.add(plant(1.5, 16, .2, 5).at(.2, 9.7, .003), "plant")
scene.add(plant(1.2, 14, .18, 6).at(5.9, 5.2, .003), "plant")

scene.add(rug(2.2, 1.6, "carpet-sand", "carpet-red").at(3.6, 2.9), "rug")
scene.add(armchair("fabric-blue", "linen").at(4.9, 3.1, .003, -60), "armchair")
scene.add(round_table(.4, .42, "walnut").at(3.4, 3.3, .015), "table")
for k, (x, y) in enumerate([(x, y) for y in (1.2, 3.2) for x in (1, 3, 5)] +
                           [(x, y) for y in (-3.2, -1.4) for x in (1, 3, 5)]):
    room = "" if y > 0 else " of the room behind"
    scene.light(panel(.3, .3, down=True).at(x, y, H - .01), 9, label=f"lamp {k + 1}{room}")
scene.main(__file__)
