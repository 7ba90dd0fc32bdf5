"""Objects written once and placed often, and lamps of any colour, for scenes made with scenekit."""
import math

from scenekit import Mesh, join, number, numbers, ply


def define(scene, name, piece):
    """Writes the piece once, as a pbrt object about its own origin. Objects cannot hold lights."""
    scene.raw(f'\nObjectBegin "{name}"')
    scene.add(piece, "")
    scene.raw("ObjectEnd")


def place(scene, name, x=0.0, y=0.0, z=0.0, turn=0.0, scale=1.0):
    """Scaled, turned about z, then moved."""
    size = f" Scale {numbers((scale,) * 3)}" if scale != 1 else ""
    rotate = f" Rotate {number(turn, 2)} 0 0 1" if turn else ""
    scene.raw(f'AttributeBegin Translate {numbers((x, y, z))}{rotate}{size} ObjectInstance "{name}" AttributeEnd')


def rgb_light(scene, mesh, watts, rgb, label="", material="bulb-glass"):
    """Scene.light with an RGB colour in place of a temperature. watts: as there, for white; the colour filters it."""
    scene._use(material)
    scene.lights += 1
    radiance = watts / (math.pi * mesh.area())
    scene.raw(f"\n# light {scene.lights}: {label} ({number(watts, 2)} W)\nAttributeBegin\n"
              f'AreaLightSource "diffuse" "rgb L" [ {numbers(rgb, 3)} ] "float scale" {number(radiance, 3)}\n'
              f'NamedMaterial "{material}"')
    scene._shape(Mesh(mesh.vertices, mesh.faces), f"{scene.name}-light{scene.lights}")
    scene.raw("AttributeEnd")


def place_ply(scene, label, piece, x=0.0, y=0.0, z=0.0, turn=0.0, scale=1.0):
    """As add(), scaled, turned and moved; each mesh goes into a PLY file that every piece with this label shares, in
    any material."""
    size = f" Scale {numbers((scale,) * 3)}" if scale != 1 else ""
    groups = {}
    for material, mesh in piece.parts:
        groups.setdefault(material, []).append(mesh)
    for k, (material, meshes) in enumerate(groups.items()):
        scene._use(material)
        file = f"{scene.name}-{label}{'bcdefgh'[k - 1] if k else ''}.ply"
        scene.files.setdefault(file, ply(join(*meshes)))
        rotate = f" Rotate {number(turn, 2)} 0 0 1" if turn else ""
        scene.raw(f'AttributeBegin Translate {numbers((x, y, z))}{rotate}{size} NamedMaterial "{material}" '
                  f'Shape "plymesh" "string filename" "{file}" AttributeEnd')
