"""The maze of many-rooms full of smoke: nearly all of 200 lamps are behind a wall from nearly all of the smoke."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *

scene = Scene("fog-rooms", "A corner of the maze of many-rooms full of smoke: 200 lamps, of which a place in the smoke sees a few.", 480,
              360, spp=16, maxdepth=5, integrator="volpath", iso=320, whitebalance=3700)
scene.camera((16.2, 2.0, 14.0), (17.4, 12.6, 0), 60)
scene.fog('"string type" "homogeneous" "rgb sigma_s" [ .06 .06 .06 ] "rgb sigma_a" [ .002 .002 .002 ] "float g" .2')
scene.raw('Include "../many-rooms/many-rooms-world.inc"')
scene.main(__file__)
