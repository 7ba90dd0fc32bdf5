"""The hotel corridor full of thin fog: the lights of its rooms shine through the doors onto the fog of the corridor."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *

scene = Scene("fog-hotel", "The hotel corridor full of thin fog: most of its nine lights are behind a wall from most of the fog.", 480,
              360, spp=16, maxdepth=6, integrator="volpath", iso=300, whitebalance=3300)
scene.camera((0.62, 0.35, 1.58), (1.5, 4.4, 1.25), 60)
scene.fog('"string type" "homogeneous" "rgb sigma_s" [ .08 .08 .08 ] "rgb sigma_a" [ .002 .002 .002 ] "float g" .4')
scene.raw('Include "../hotel/hotel-world.inc"')
scene.main(__file__)
