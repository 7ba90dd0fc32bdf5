"""A glass of diluted milk on a table: the bodies of glass, milk and air share their faces, each written once."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *

scene = Scene("milk-glass", "A glass of diluted milk and a ball of clouded glass on a table between three lamps.", 420, 420, spp=16, maxdepth=100,
              integrator="volpath", iso=100, whitebalance=3800)
scene.camera((0.05, -.52, .3), (0.012, 0, .062), 27)
# Not coated: coats scatter more light by light sampling than by directions, as in stock pbrt-v4, which would look like
# a bias of light samplers.
scene.material("table", diffuse(.32, .2, .11))
scene.material("back", diffuse(.35, .42, .46))
scene.material("glass", '"string type" "dielectric" "float eta" 1.5')
scene.material("milk-air", '"string type" "dielectric" "float eta" 1.33')
scene.material("milk-glass", '"string type" "dielectric" "float eta" .8867')
scene.material("clouded", '"string type" "dielectric" "float eta" 1.5 "float roughness" .05')
scene.add(slab(-1, -1, 1, 1, -.04, 0), "table", "table")
scene.add(box((-1, .6, 0), (1, .65, 1)), "wall", "back")
# One thousandth of a metre is the unit of the presets; the milk is a part of milk in ten of water.
scene.raw('MakeNamedMedium "milk" "string type" "homogeneous" "string preset" "Wholemilk" "float scale" 100')
scene.raw('MakeNamedMedium "cloud" "string type" "homogeneous" "rgb sigma_s" [ 60 75 95 ] "rgb sigma_a" [ 1 .6 .2 ] "float g" .3')
LEVEL = .085
outer = [(0, .0005), (.03, .0005), (.0315, .003), (.036, .11), (.0355, .1115)]
inside_above = [(.0355, .1115), (.034, .11), (.0331, LEVEL)]
# Downwards, so the outside of the glass's body is the inside of the vessel.
scene.add(lathe(outer + inside_above[1:], 64), "glass and air", "glass")
# Up and outwards: the outside of the milk's body is glass.
scene.raw('AttributeBegin\nMediumInterface "milk" ""')
scene.add(lathe([(0, .008), (.028, .008), (.0295, .011), (.0331, LEVEL)], 64), "milk and glass", "milk-glass")
scene.add(lathe([(.0331, LEVEL), (0, LEVEL)], 64), "milk and air", "milk-air")
scene.raw('AttributeEnd')
scene.raw('AttributeBegin\nMediumInterface "cloud" ""')
scene.add(sphere(.022, 4).at(.075, -.03, .0222), "ball", "clouded")
scene.raw('AttributeEnd')
scene.light(panel(.9, .6, 1, 1, down=True).at(-.2, -.1, .9), 16, 4200, "ceiling")
scene.light(quad((.9, -.5, .1), (.9, .5, .1), (.9, .5, .7), (.9, -.5, .7)).flip(), 6, 2900, "window at the right")
scene.light(bulb(.03, 2).at(-.3, .35, .12), 1.5, 3000, "lamp at the back")
scene.main(__file__)
