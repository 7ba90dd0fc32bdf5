"""Two clouds over a field, under sun and sky."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from skykit import Sun, clear_sky, sky_image, sky_light

scene = Scene("cloud-sky", "Two clouds over a field under sun and sky.", 480, 320, spp=16, maxdepth=50, integrator="volpath", iso=60, whitebalance=5800)
scene.camera((0, -9, 1.2), (0, 0, 2.7), 42)
scene.material("field", diffuse(.2, .26, .1))
scene.material("tower", diffuse(.6, .56, .5))
sun = Sun(235, 28)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")
scene.add(slab(-80, -20, 80, 120, -.3, 0), "field", "field")
scene.add(join(box((-.3, 2, 0), (.3, 2.6, 1.7)), box((-.4, 1.9, 1.7), (.4, 2.7, 1.85))), "tower", "tower")


def cloud(name, centre, size, density, frequency):
    """Its own box is the unit cube with y up; an ellipsoid is cut out of it."""
    scene.raw(f'AttributeBegin\nTranslate {numbers(centre)}\nScale {numbers(size)}\nRotate 90 1 0 0\nTranslate -.5 -.5 -.5\n'
              f'MakeNamedMedium "{name}" "string type" "cloud" "float density" {number(density)} "float wispiness" .6 '
              f'"float frequency" {number(frequency)} "rgb sigma_s" [ 12 12 12 ] "rgb sigma_a" [ 0 0 0 ] "float g" .6\n'
              f'MediumInterface "{name}" ""\nMaterial "interface"\nTranslate .5 .5 .5\nScale .499 .499 .499\n'
              f'Shape "sphere"\nAttributeEnd')


cloud("near", (-1.5, .5, 3.2), (3.8, 2.4, 1.9), 1, 5)
cloud("far", (2.3, 2.5, 3.9), (3.0, 2.4, 1.5), .9, 6)
scene.main(__file__)
