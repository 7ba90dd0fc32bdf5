"""A hall whose door to the outside swings open while the shutter is: how much sky it lets in depends on the time."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import cupboard, door_frame, door_leaf, picture, plant, rug, stool, vase
from scenekit import Scene, diffuse, numbers, planks, room, skirting
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 3.6, 4.2, 2.6, .3
DOOR = (1.2, 2.2, 2.08)        # in the north wall: from, to, top
SWING = (4, 78)                # degrees from closed, inwards, at times 0 and 1

scene = Scene("moving-door", "A hall whose door to the outside swings open during the exposure; sun and sky only.", 480,
              320, spp=64, maxdepth=8, iso=800, whitebalance=5600)
scene.camera((3.2, .3, 1.5), (1.45, 3.7, 1.0), 60)
scene.material("wall-soft", diffuse(.8, .77, .7))
scene.material("wall-sage", diffuse(.55, .62, .55))
scene.material("doorstep", diffuse(.4, .39, .37))
sun = Sun(112, 42)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")

scene.add(room(W, D, H, {"n": [(DOOR[0], DOOR[1], 0, DOOR[2])]}, T,
               paint={"s": "wall-soft", "w": "wall-sage", "n": "wall-soft", "e": "wall-soft"}), "shell")
scene.add(planks(0, 0, W, D, width=.16, length=1.9, seed=5), "floor boards")
scene.add(planks(DOOR[0] + .012, D, DOOR[1] - .012, D + T, width=.3, materials=("doorstep",), seed=2), "doorstep")
scene.add(skirting(W, D, {"n": [(DOOR[0] - .07, DOOR[1] + .07)]}), "skirting")
scene.add(door_frame(DOOR[1] - DOOR[0], DOOR[2], T).at(DOOR[0], D + T / 2), "door frame")

# The hinge is at the frame's inner edge; both transforms move the leaf there, then each turns it by its own angle.
scene.raw(f"\nAttributeBegin\nTranslate {numbers((DOOR[0] + .014, D + .022, .004))}\n"
          f"ActiveTransform StartTime Rotate {-SWING[0]} 0 0 1\n"
          f"ActiveTransform EndTime Rotate {-SWING[1]} 0 0 1\nActiveTransform All")
scene.add(door_leaf(DOOR[1] - DOOR[0] - .028, DOOR[2] - .02, "paint-teal", handles="brass"), "the door, in motion")
scene.raw("AttributeEnd")

scene.add(rug(1.3, 2.0, "carpet-red", "carpet-sand").at(1.75, 2.0, 0, 2), "rug")
scene.add(cupboard(1.0, .36, .82, "walnut", 2, 1).turn(90).at(.21, 2.1, .003), "cupboard")
scene.add(vase(.34, "ceramic-blue").at(.2, 1.9, .8235), "vase")
scene.add(picture(.8, .55, "oak", 3).turn(90).at(.0006, 2.1, 1.6), "picture")
scene.add(picture(.5, .65, "walnut", 12).at(2.85, D - .0006, 1.6), "second picture")
scene.add(stool(.18, .45).at(2.85, 3.8, .003), "stool")
scene.add(plant(1.0, 14, .17, 3).at(.42, 3.75, .003), "plant")
scene.main(__file__)
