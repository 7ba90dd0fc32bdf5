#!/usr/bin/env python3
"""Writes bathroom.pbrt: white tiles, a mirror, and three small lamps inside globes of frosted glass.

No light sample passes the glass: light is found by paths that hit a globe and, inside it, the bulb. What choice of
lights cannot help, guided bounces might."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import bottle, cup, cupboard, door_frame, door_leaf, mirror, plant, rug, stool
from scenekit import Mesh, Piece, Scene, bulb, beveled_box, coated, cylinder, lathe, room, sphere, tube

W, D, H = 2.6, 3.0, 2.45
TILE, GROUT, TOP = .2, .004, 2.0


def tiles(origin, u, v, nu, nv, out):
    """nu x nv tiles from `origin` along the unit vectors u and v, a little proud of the wall towards `out`."""
    mesh, half = Mesh(), GROUT / 2

    def place(a, b):
        return tuple(origin[k] + a * u[k] + b * v[k] + .003 * out[k] for k in range(3))

    for i in range(nu):
        for j in range(nv):
            a0, a1, b0, b1 = i * TILE + half, (i + 1) * TILE - half, j * TILE + half, (j + 1) * TILE - half
            n = len(mesh.vertices)
            mesh.vertices += [place(a0, b0), place(a1, b0), place(a1, b1), place(a0, b1)]
            mesh.faces += [(n, n + 1, n + 2), (n, n + 2, n + 3)]
    return mesh


def tub():
    """A bath tub, the long way along y; the hollow is half an egg."""
    shell = lathe([(.30, 0), (.33, .03), (.40, .52), (.42, .56), (.405, .575), (.38, .56), (.345, .3), (.27, .12), (0, .1)], 40)
    return Piece(("tub", Mesh([(x, 1.95 * y, z) for x, y, z in shell.vertices], shell.faces,
                              [(nx, ny / 1.95, nz) for nx, ny, nz in shell.normals])))


def basin():
    """A washbasin on a column, its back near y = 0."""
    dish = lathe([(.06, .0), (.2, .05), (.25, .13), (.255, .15), (.24, .152), (.18, .07), (.0, .035)], 36)
    return (Piece().add("porcelain", dish.at(0, -.26, .72), cylinder(.075, 0, .74, 24, .095).at(0, -.22, 0))
            .add("chrome", tube((0, -.04, .93), (0, -.2, .93), .012), tube((0, -.04, .83), (0, -.04, .945), .014)))


def globe(radius):
    """A lamp's globe of frosted glass, hollow."""
    return Piece(("frosted", sphere(radius, 3)), ("frosted", sphere(radius - .004, 3).flip()))


scene = Scene("bathroom", "White tiles, a mirror, and three small lamps inside globes of frosted glass.", 320, 240, spp=64,
              maxdepth=16, iso=300, whitebalance=3300)
scene.camera((2.3, .25, 1.5), (.95, 2.5, .98), 62)
scene.material("tile-white", coated(.82, .82, .8, .05))
scene.material("floor", coated(.3, .31, .33, .15))
scene.material("tub", coated(.84, .84, .82, .02))
scene.material("porcelain", coated(.84, .84, .82, .02))
scene.material("chrome", '"string type" "conductor" "spectrum eta" "metal-Al-eta" "spectrum k" "metal-Al-k" "float roughness" .04')
scene.material("frosted", '"string type" "dielectric" "float eta" 1.5 "float roughness" .5')
scene.material("towel", '"string type" "diffuse" "rgb reflectance" [ .2 .45 .5 ]')

scene.add(room(W, D, H, paint="wall"), "shell")
scene.add(tiles((0, D, 0), (1, 0, 0), (0, 0, 1), 13, 10, (0, -1, 0)), "tiles, north", material="tile-white")
scene.add(tiles((0, 0, 0), (0, 1, 0), (0, 0, 1), 15, 10, (1, 0, 0)), "tiles, west", material="tile-white")
scene.add(tiles((W, D, 0), (0, -1, 0), (0, 0, 1), 15, 10, (-1, 0, 0)), "tiles, east", material="tile-white")
scene.add(tub().at(.47, 2.06, .004), "tub")
scene.add(basin().at(1.75, D - .004, 0), "washbasin")
scene.add(mirror(.62, .8, "steel").at(1.75, D - .01, 1.5), "mirror")
scene.add(Piece().include(cup().at(1.6, D - .1, .875), bottle(.2, "ceramic-blue").at(1.93, D - .1, .875)), "on the washbasin")
scene.add(rug(.9, .6, "carpet-blue", "carpet-sand").at(1.65, 2.0, .003), "rug")
scene.add(stool().at(1.05, 1.45, .003), "stool")
scene.add(Piece(("towel", beveled_box((-.17, -.12, .453), (.17, .12, .52), .02))).at(1.05, 1.45, .003, 20), "towel")
scene.add(cupboard(.7, .35, .9, "oak", 2, 1).turn(-90).at(W - .19, 1.35, .003), "cupboard")
scene.add(plant(.4, 12, .08, 8).at(W - .2, 1.35, .91), "plant")
scene.add(Piece().include(door_frame(.8, 2.02, .06), door_leaf(.77, 2.0).at(.015, .01, .004)).at(.8, .02), "door")
for k, (x, y, z, r, watts) in enumerate(((1.3, D - .13, 1.72, .09, 6), (2.2, D - .13, 1.72, .09, 6), (1.2, 1.5, H - .22, .15, 12))):
    scene.add(globe(r).at(x, y, z), f"globe {k + 1}")
    holder = tube((x, y, z + r), (x, y, H), .01) if k == 2 else tube((x, y + r, z), (x, D, z), .012)
    scene.add(Piece(("steel", holder)), f"holder {k + 1}")
    scene.light(bulb(.7 * r, 2).at(x, y, z), watts, label=f"bulb {k + 1}")
scene.main(__file__)
