"""The pictures of the gallery: a stage, and what each puts on it."""
import math
import random
from dataclasses import dataclass

PATCH = 'Translate 0 0 1 Rotate 15 0 0 1 Shape "bilinearmesh" "point3 P" [ -1 .3 -.8  1 .3 -.8  -1 -.1 .9  1 -.1 .9 ]'
EYE = "LookAt 0 -6.2 2.6  0 0 .85  0 0 1"
CAMERA = EYE + '\nCamera "perspective" "float fov" 26'
FILM = 'Film "rgb" "integer xresolution" 200 "integer yresolution" 150 "bool savefp16" false'
LIGHT = '''LightSource "infinite" "rgb L" [ .22 .25 .3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 11 10 8.5 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "bilinearmesh" "point3 P" [ 1.8 -2.6 4.2  1.8 -.8 5  3.6 -2.6 4.2  3.6 -.8 5 ]
AttributeEnd'''
FLOOR = '''AttributeBegin
Texture "tiles" "spectrum" "checkerboard" "float uscale" 16 "float vscale" 16
  "rgb tex1" [ .36 .36 .36 ] "rgb tex2" [ .48 .48 .48 ]
Material "diffuse" "texture reflectance" "tiles"
Shape "bilinearmesh" "point3 P" [ -8 -8 0  8 -8 0  -8 8 0  8 8 0 ]
AttributeEnd'''
CLAY = 'Material "diffuse" "rgb reflectance" [ .62 .4 .28 ]'
BALL = 'Translate 0 0 1 Shape "sphere"'
MESH = 'Shape "plymesh" "string filename" "knot.ply"'
KNOT = f"Translate 0 0 1 Rotate 70 1 0 0 Scale 1.15 1.15 1.15 {MESH}"
GOLD = '"spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k"'
IMAGE = '"spectrum" "imagemap" "string filename" "card.png"'
CARD = ('Texture "card" "spectrum" "imagemap" "string filename" "card.png"\n'
        'Material "diffuse" "texture reflectance" "card"\n')


@dataclass
class Picture:
    name: str
    title: str
    stage: str = ""             # inside the world
    camera: str = CAMERA
    film: str = FILM
    light: str = LIGHT
    floor: str = FLOOR
    integrator: str = 'Integrator "path" "integer maxdepth" 8'
    times: float = 1            # of the samples per pixel
    show: tuple = ()            # arguments of imgtool convert
    after: tuple = ()           # imgtool commands before that
    sampler: str = 'Sampler "zsobol" "integer pixelsamples" {}'
    of: tuple = ()              # family and name of what has this picture beside its parameters (pbrt --list FAMILY)

    def text(self, spp):
        samples = max(1, round(spp * self.times))
        return "\n".join([f"# {self.title}", self.camera, self.film,
                          self.sampler.format(samples), self.integrator, "WorldBegin",
                          self.light, self.floor, "AttributeBegin", self.stage, "AttributeEnd", ""])


def material(name, title, text, shape=BALL, **more):
    return Picture(name, title, f"Material {text}\n{shape}", **more)


def texture(name, title, text, shape=BALL):
    """A texture called t; colours come from a ramp if it is a float."""
    return Picture(name, title, f'Texture "t" {text}\nMaterial "diffuse" "texture reflectance" "t"\n{shape}')


def ramp(name, title, text):
    return Picture(name, title, f'Texture "f" {text}\nTexture "t" "spectrum" "mix" "rgb tex1" [ .08 .12 .25 ] '
                   '"rgb tex2" [ .85 .75 .5 ] "texture amount" "f"\n'
                   f'Material "diffuse" "texture reflectance" "t"\n{BALL}')


def numbers(values):
    return " ".join(f"{v:.4g}" for v in values)


def grass(kind):
    """Blades that bend outwards."""
    r, out = random.Random(4), []
    for _ in range(260):
        a, d = r.uniform(0, 2 * math.pi), .85 * math.sqrt(r.random())
        x, y, h, lean = d * math.cos(a), d * math.sin(a), r.uniform(.7, 1.7), r.uniform(.1, .7)
        points = [(x + lean * math.cos(a) * t * t, y + lean * math.sin(a) * t * t, h * t) for t in (0, .35, .7, 1)]
        normals = f' "normal N" [ {numbers((-math.sin(a), math.cos(a), 0) * 2)} ]' if kind == "ribbon" else ""
        out.append(f'Shape "curve" "string type" "{kind}" "point3 P" [ {numbers(sum(points, ()))} ] '
                   f'"float width0" .06 "float width1" .01{normals}')
    return "\n".join(out)


def wig():
    """Hair on a ball, combed."""
    r, out = random.Random(8), []
    for _ in range(1400):
        z, a = r.uniform(-.35, 1), r.uniform(0, 2 * math.pi)
        s = math.sqrt(1 - z * z)
        n = (s * math.cos(a), s * math.sin(a), z)
        points = []
        for t in (0, .33, .66, 1):
            k = 1 + .34 * t
            points.append((.75 * n[0] * k + .1 * t * n[1], .75 * n[1] * k - .1 * t * n[0], .75 * n[2] * k - .5 * t * t))
        out.append(f'Shape "curve" "string type" "cylinder" "point3 P" [ {numbers(sum(points, ()))} ] '
                   '"float width0" .022 "float width1" .012')
    return "Translate 0 0 1.05\n" + "\n".join(out)


OCTAHEDRON = '"point3 P" [ 1 0 0  -1 0 0  0 1 0  0 -1 0  0 0 1  0 0 -1 ] ' \
             '"integer indices" [ 0 2 4  2 1 4  1 3 4  3 0 4  2 0 5  1 2 5  3 1 5  0 3 5 ]'

SHAPES = [
    Picture("sphere", "sphere, with zmin, zmax, phimax",
            f'{CLAY}\nTranslate 0 0 1 Rotate -150 0 0 1\n'
            'Shape "sphere" "float zmin" -.8 "float zmax" .6 "float phimax" 270'),
    Picture("disk", "disk", f'{CLAY}\nTranslate 0 0 .9 Rotate 55 1 0 0\n'
            'Shape "disk" "float innerradius" .45 "float phimax" 300'),
    Picture("cylinder", "cylinder", f'{CLAY}\nRotate 200 0 0 1\n'
            'Shape "cylinder" "float radius" .8 "float zmin" 0 "float zmax" 1.5 "float phimax" 290'),
    Picture("trianglemesh", "trianglemesh",
            f'{CLAY}\nTranslate 0 0 1 Rotate 25 0 0 1\nShape "trianglemesh" {OCTAHEDRON}'),
    Picture("plymesh", "plymesh", f"{CLAY}\n{KNOT}"),
    Picture("bilinearmesh", "bilinearmesh", f'{CARD}Rotate 20 0 0 1\n'
            'Shape "bilinearmesh" "point3 P" [ -1 -1 .2  1 -1 1.3  -1 1 1.7  1 1 .5 ]'),
    Picture("loopsubdiv", "loopsubdiv", f'{CLAY}\nTranslate 0 0 .9 Scale 1.5 1.5 1.5 Rotate 25 0 0 1\n'
            f'Shape "loopsubdiv" "integer levels" 4 {OCTAHEDRON}'),
    Picture("displacement", "plymesh with displacement",
            'Texture "w" "float" "wrinkled"\nTexture "d" "float" "scale" "texture tex" "w" "float scale" .35\n'
            f'{CLAY}\nTranslate 0 0 .95 Shape "plymesh" "string filename" "ball.ply" "texture displacement" "d" '
            '"float edgelength" .03'),
    Picture("curve-flat", "curve, flat", 'Material "diffuse" "rgb reflectance" [ .25 .5 .15 ]\n' + grass("flat")),
    Picture("curve-cylinder", "curve, cylinder",
            'Material "coateddiffuse" "rgb reflectance" [ .5 .3 .1 ]\n' + grass("cylinder")),
    Picture("curve-ribbon", "curve, ribbon", 'Material "diffusetransmission" "rgb reflectance" [ .2 .4 .1 ] '
            '"rgb transmittance" [ .25 .4 .05 ]\n' + grass("ribbon")),
    Picture("alpha", "alpha texture", 'Texture "a" "float" "dots" "float uscale" 12 "float vscale" 8 "float inside" 1 '
            f'"float outside" 0\n{CLAY}\nTranslate 0 0 1 Shape "sphere" "texture alpha" "a"'),
    Picture("instances", "object instances", f'{CLAY}\nObjectBegin "knot"\nScale .42 .42 .42\n{MESH}\nObjectEnd\n'
            + "\n".join(
                f'AttributeBegin Translate {x} {y} {.35 + .3 * (y + 1)} Rotate {50 * x + 80 * y} 0 0 1 '
                'ObjectInstance "knot" AttributeEnd' for x in (-1.2, -.4, .4, 1.2) for y in (-.6, .3, 1.2))),
    Picture("motion", "moving shape", f'{CLAY}\nActiveTransform EndTime\nTranslate .8 0 0\nActiveTransform All\n'
            f'Translate -.4 0 .9 Rotate 80 1 0 0 {MESH}'),
    Picture("moving-instance", "turning instances", f'{CLAY}\nObjectBegin "bars"\nScale .9 .9 .9\n'
            'Shape "trianglemesh" "point3 P" [ -1 0 -.15  1 0 -.15  1 0 .15  -1 0 .15 ] "integer indices" '
            '[ 0 1 2 0 2 3 ]\nShape "sphere" "float radius" .25\nObjectEnd\n'
            + "\n".join(f'AttributeBegin Translate {x} 0 1\nRotate 20 0 1 0\nActiveTransform EndTime\n'
                        f'Rotate {turn} 0 1 0\nActiveTransform All\nObjectInstance "bars" AttributeEnd'
                        for x, turn in ((-1.05, 15), (1.05, 70)))),
]

MATERIALS = [
    material("diffuse", "diffuse", '"diffuse" "rgb reflectance" [ .3 .45 .65 ]'),
    material("conductor", "conductor", f'"conductor" {GOLD}'),
    material("conductor-rough", "conductor, uroughness, vroughness", '"conductor" "spectrum eta" "metal-Cu-eta" '
             '"spectrum k" "metal-Cu-k" "float uroughness" .02 "float vroughness" .3'),
    material("dielectric", "dielectric", '"dielectric"', times=4),
    material("dielectric-rough", "dielectric, rough", '"dielectric" "float roughness" .12', times=2),
    material("dispersion", "dielectric with a spectral eta", '"dielectric" "spectrum eta" "glass-F11"', KNOT, times=8),
    material("thindielectric", "thindielectric", '"thindielectric"', times=2),
    material("coateddiffuse", "coateddiffuse",
             '"coateddiffuse" "rgb reflectance" [ .55 .08 .06 ] "float roughness" .05'),
    material("coat-medium", "coateddiffuse, thickness, albedo, g", '"coateddiffuse" "rgb reflectance" [ .7 .7 .7 ] '
             '"float thickness" .5 "rgb albedo" [ .95 .6 .25 ] "float g" .3 "integer maxdepth" 40', times=2),
    material("coatedconductor", "coatedconductor", '"coatedconductor" "spectrum conductor.eta" "metal-Al-eta" '
             '"spectrum conductor.k" "metal-Al-k" "float conductor.roughness" .3 "float interface.roughness" .02 '
             '"float thickness" .1 "rgb albedo" [ .2 .5 .8 ]'),
    material("diffusetransmission", "diffusetransmission", '"diffusetransmission" "rgb reflectance" [ .3 .2 .1 ] '
             '"rgb transmittance" [ .5 .4 .15 ]'),
    Picture("hair", "hair", 'Material "hair" "float eumelanin" .6 "float pheomelanin" .5\n' + wig(), times=2,
            integrator='Integrator "path" "integer maxdepth" 12'),
    material("measured", "measured (a file that assets.py writes)", '"measured" "string filename" "film.bsdf"', KNOT,
             times=4),
    material("subsurface", "subsurface", '"subsurface" "string name" "Skin1" "float scale" 12', KNOT, times=2,
             integrator='Integrator "volpath" "integer maxdepth" 12'),
    Picture("mix", "mix by a texture",
            'Texture "a" "float" "checkerboard" "float uscale" 10 "float vscale" 6 "float tex1" 0 "float tex2" 1\n'
            f'MakeNamedMaterial "gold" "string type" "conductor" {GOLD} '
            '"float roughness" .05\nMakeNamedMaterial "paint" "string type" "diffuse" "rgb reflectance" [ .1 .2 .4 ]\n'
            f'Material "mix" "string materials" [ "paint" "gold" ] "texture amount" "a"\n{BALL}'),
    material("normalmap", "normalmap",
             '"coateddiffuse" "rgb reflectance" [ .3 .4 .2 ] "string normalmap" "pillows.png"'),
    Picture("bump", "bump map (displacement of a material)",
            'Texture "n" "float" "fbm"\nTexture "d" "float" "scale" "texture tex" "n" "float scale" .12\n'
            f'Material "conductor" "texture displacement" "d" "float roughness" .1\n{BALL}'),
    Picture("roughness-texture", "textured roughness",
            'Texture "r" "float" "checkerboard" "float uscale" 12 "float vscale" 8 "float tex1" .01 "float tex2" .3\n'
            f'Material "conductor" "texture roughness" "r"\n{BALL}'),
    Picture("interface", "interface: an invisible sphere around the knot", 'AttributeBegin Material "interface" '
            f'Translate 0 0 1 Shape "sphere" "float radius" 1.3 AttributeEnd\nMaterial "conductor" {GOLD}\n{KNOT}',
            integrator='Integrator "volpath" "integer maxdepth" 8'),
]

TEXTURES = [
    texture("bilerp", "bilerp", '"spectrum" "bilerp" "rgb v00" [ .8 .1 .1 ] "rgb v01" [ .1 .6 .2 ] '
            '"rgb v10" [ .1 .2 .8 ] "rgb v11" [ .9 .8 .1 ]', PATCH),
    texture("checkerboard", "checkerboard", '"spectrum" "checkerboard" "float uscale" 12 "float vscale" 8 '
            '"rgb tex1" [ .7 .65 .5 ] "rgb tex2" [ .1 .15 .3 ]'),
    Picture("checkerboard-3d", "checkerboard, dimension 3",
            'AttributeBegin Scale .4 .4 .4\nTexture "t" "spectrum" "checkerboard" "integer dimension" 3 "rgb tex1" '
            '[ .7 .65 .5 ] "rgb tex2" [ .3 .1 .1 ]\nAttributeEnd\n'
            f'Material "diffuse" "texture reflectance" "t"\n{BALL}'),
    texture("dots", "dots", '"spectrum" "dots" "float uscale" 16 "float vscale" 10 "rgb inside" [ .8 .3 .2 ] '
            '"rgb outside" [ .75 .75 .7 ]'),
    ramp("fbm", "fbm", '"float" "fbm" "integer octaves" 6'),
    ramp("wrinkled", "wrinkled", '"float" "wrinkled" "integer octaves" 6'),
    ramp("windy", "windy", '"float" "windy"'),
    texture("marble", "marble", '"spectrum" "marble" "float scale" 5 "float variation" .5'),
    texture("imagemap", "imagemap, uv", f'{IMAGE} "float uscale" 4 "float vscale" 2 '
            '"string filter" "ewa"'),
    Picture("mapping-planar", "imagemap, planar", f'Texture "t" {IMAGE} "string mapping" "planar" '
            '"vector3 v1" [ .6 0 0 ] "vector3 v2" [ 0 0 .6 ] "float udelta" .5 "float vdelta" -.1\n'
            f'Material "diffuse" "texture reflectance" "t"\n{BALL}'),
    Picture("mapping-spherical", "imagemap, spherical", f'Translate 0 0 1\nTexture "t" {IMAGE} '
            '"string mapping" "spherical"\nMaterial "diffuse" "texture reflectance" "t"\n'
            f'Rotate 70 1 0 0 Scale 1.15 1.15 1.15 {MESH}'),
    Picture("mapping-cylindrical", "imagemap, cylindrical", f'Texture "t" {IMAGE} '
            '"string mapping" "cylindrical"\nMaterial "diffuse" "texture reflectance" "t"\n'
            'Rotate 200 0 0 1 Shape "cylinder" "float radius" .8 "float zmin" 0 "float zmax" 1.6'),
    Picture("directionmix", "directionmix", 'Texture "t" "spectrum" "directionmix" "rgb tex1" [ .8 .8 .85 ] '
            '"rgb tex2" [ .25 .14 .08 ] "vector3 dir" [ 0 0 1 ]\n'
            f'Material "diffuse" "texture reflectance" "t"\n{KNOT}'),
    Picture("scale-mix", "scale and mix", 'Texture "c" "spectrum" "imagemap" "string filename" "card.png"\n'
            'Texture "m" "spectrum" "marble" "float scale" 5\n'
            'Texture "x" "spectrum" "mix" "texture tex1" "c" "texture tex2" "m"\n'
            'Texture "t" "spectrum" "scale" "texture tex" "x" "float scale" .8\n'
            f'Material "diffuse" "texture reflectance" "t"\n{BALL}'),
]

DIM = 'LightSource "infinite" "rgb L" [ .02 .022 .03 ]'
GREY = 'Material "diffuse" "rgb reflectance" [ .5 .5 .5 ]'
BEHIND = '''AttributeBegin
Material "diffuse" "rgb reflectance" [ .5 .5 .5 ]
Shape "bilinearmesh" "point3 P" [ -6 2 0  6 2 0  -6 2 6  6 2 6 ]
AttributeEnd
'''
CLOSED = '''AttributeBegin
Material "diffuse" "rgb reflectance" [ .6 .6 .58 ]
Shape "bilinearmesh" "point3 P" [ -2.2 2.2 0  2.2 2.2 0  -2.2 2.2 3  2.2 2.2 3 ]
Shape "bilinearmesh" "point3 P" [ -2.2 -7 0  -2.2 2.2 0  -2.2 -7 .9  -2.2 2.2 .9 ]
Shape "bilinearmesh" "point3 P" [ -2.2 -7 2.1  -2.2 2.2 2.1  -2.2 -7 3  -2.2 2.2 3 ]
Shape "bilinearmesh" "point3 P" [ -2.2 -7 .9  -2.2 -.6 .9  -2.2 -7 2.1  -2.2 -.6 2.1 ]
Shape "bilinearmesh" "point3 P" [ -2.2 1 .9  -2.2 2.2 .9  -2.2 1 2.1  -2.2 2.2 2.1 ]
Shape "bilinearmesh" "point3 P" [ 2.2 -7 0  2.2 2.2 0  2.2 -7 3  2.2 2.2 3 ]
Shape "bilinearmesh" "point3 P" [ -2.2 -7 3  2.2 -7 3  -2.2 2.2 3  2.2 2.2 3 ]
Shape "bilinearmesh" "point3 P" [ -2.2 -7 0  2.2 -7 0  -2.2 -7 3  2.2 -7 3 ]
AttributeEnd
'''


def light(name, title, text, stage=f"{GREY}\n{KNOT}", **more):
    return Picture(name, title, BEHIND + stage, light=f"{DIM}\nAttributeBegin\n{text}\nAttributeEnd", **more)


LIGHTS = [
    light("point", "point", 'LightSource "point" "point3 from" [ -1.6 -1.6 2.6 ] "rgb I" [ 9 8 6 ]',
          of=("lights", "point")),
    light("spot", "spot", 'LightSource "spot" "point3 from" [ -2.5 -3 4 ] "point3 to" [ 0 0 .8 ] "float coneangle" 18 '
          '"float conedeltaangle" 6 "rgb I" [ 60 55 45 ]', of=("lights", "spot")),
    light("distant", "distant", 'LightSource "distant" "point3 from" [ -2 -2 3 ] "rgb L" [ 3 2.8 2.4 ]',
          of=("lights", "distant")),
    light("goniometric", "goniometric", 'Translate 0 .9 1.2 Rotate 90 1 0 0\n'
          'LightSource "goniometric" "string filename" "lobes.png" "float scale" 4', stage="", show=("--exposure", "1.5"),
          of=("lights", "goniometric")),
    light("projection", "projection", 'Translate 0 -4 1.8 Rotate -90 1 0 0\n'
          'LightSource "projection" "string filename" "slide.png" "float fov" 34 "float scale" 60',
          stage=f"{GREY}\nScale .6 .6 .6 {KNOT}", show=("--exposure", "1"), of=("lights", "projection")),
    light("area", "diffuse area light", 'Translate -1.6 -.8 2.2 AreaLightSource "diffuse" "rgb L" [ 8 7 5 ]\n'
          'Shape "sphere" "float radius" .3', show=("--exposure", "1"), of=("arealights", "diffuse")),
    light("area-image", "area light with an image",
          'AreaLightSource "diffuse" "string filename" "slide.png" "float scale" 3\n'
          'Shape "bilinearmesh" "string emissionfilename" "slide.png" '
          '"point3 P" [ .7 1.9 .5  1.9 .6 .5  .7 1.9 1.9  1.9 .6 1.9 ]', stage=f"{GREY}\nTranslate -.6 -.3 0 {KNOT}",
          show=("--exposure", "1.5")),
    light("area-invisible", "area light, alpha 0",
          'Translate -1.6 -.8 2.2 AreaLightSource "diffuse" "rgb L" [ 8 7 5 ]\n'
          'Shape "sphere" "float radius" .3 "float alpha" 0', show=("--exposure", "1")),
    Picture("infinite", "infinite, imgtool makesky", f'Material "conductor" "float roughness" .01\n{KNOT}',
            camera='LookAt 0 -6.2 1  0 0 1.3  0 0 1\nCamera "perspective" "float fov" 32',
            light='AttributeBegin Rotate 120 0 0 1\nLightSource "infinite" "string filename" "sky.exr" '
                  '"float scale" 4\nAttributeEnd', of=("lights", "infinite")),
    Picture("portal", "infinite with a portal", f"{CLOSED}{GREY}\n{KNOT}", times=4,
            camera='LookAt .6 -6.2 1.7  0 0 1.1  0 0 1\nCamera "perspective" "float fov" 34',
            light='AttributeBegin LightSource "infinite" "rgb L" [ .7 .85 1 ] "float scale" 9 '
                  '"point3 portal" [ -2.2 -.6 .9  -2.2 1 .9  -2.2 1 2.1  -2.2 -.6 2.1 ] AttributeEnd'),
    light("blackbody", "blackbody spectra", "\n".join(
        f'AttributeBegin Translate {x} 1.6 .9 LightSource "point" "blackbody I" {t} "float scale" 1.2 AttributeEnd'
        for x, t in ((-1.5, 1800), (-.5, 3000), (.5, 5000), (1.5, 12000))), stage=""),
]

ROW = "\n".join(
    f'AttributeBegin Material "coateddiffuse" "rgb reflectance" [ {c} ]\n'
    f'Translate {x} {y} .5 Shape "sphere" "float radius" .5 AttributeEnd'
    for x, y, c in ((-1.5, -1.6, ".6 .2 .1"), (-.5, -.2, ".6 .5 .1"), (.5, 1.4, ".2 .5 .2"), (1.7, 3.4, ".15 .3 .6")))
AROUND = "\n".join(
    f'AttributeBegin Rotate {60 * k} 0 0 1 Translate 2 0 .8 Rotate 70 1 0 0\n'
    f'Material "diffuse" "rgb reflectance" [ {c} ] {MESH} AttributeEnd'
    for k, c in enumerate((".7 .2 .1", ".7 .6 .1", ".2 .6 .2", ".1 .5 .6", ".2 .2 .7", ".6 .2 .6")))
MIDDLE = 'LookAt 0 0 1  0 1 1  0 0 1\nCamera "spherical" "string mapping" '
CAMERAS = [
    Picture("perspective", "perspective", ROW),
    Picture("depth-of-field", "perspective, lensradius", ROW, times=2,
            camera=CAMERA + ' "float lensradius" .3 "float focaldistance" 6.2'),
    Picture("orthographic", "orthographic", ROW, camera=f'{EYE}\n'
            'Camera "orthographic" "float screenwindow" [ -2.4 2.4 -1.8 1.8 ]'),
    Picture("realistic", "realistic (one lens)", ROW, times=4, camera=f'{EYE}\n'
            'Camera "realistic" "string lensfile" "lens.dat" "float aperturediameter" 14 "float focusdistance" 6.2',
            film=FILM + ' "float iso" 2000'),
    Picture("equirectangular", "spherical, equirectangular", AROUND, camera=MIDDLE + '"equirectangular"'),
    Picture("equalarea", "spherical, equalarea", AROUND, camera=MIDDLE + '"equalarea"'),
    Picture("moving-camera", "moving camera", ROW,
            camera=f'{EYE}\nActiveTransform EndTime\nTranslate .25 0 0\nActiveTransform All\n'
                   'Camera "perspective" "float fov" 26'),
]

GBUFFER = FILM.replace('"rgb"', '"gbuffer"')
FILMS = [
    Picture("gbuffer-albedo", "gbuffer: albedo", f"{CARD}{KNOT}", film=GBUFFER,
            show=("--channels", "Albedo.R,Albedo.G,Albedo.B")),
    Picture("gbuffer-normal", "gbuffer: shading normal", f"{CARD}{KNOT}", film=GBUFFER,
            show=("--channels", "Ns.X,Ns.Y,Ns.Z", "--clamp", "1")),
    Picture("spectral", "spectral: 650, 550 and 450 nm as red, green, blue", f"{CARD}{KNOT}",
            film=FILM.replace('"rgb"', '"spectral"') + ' "integer nbuckets" 3 "float lambdamin" 400 '
                 '"float lambdamax" 700',
            show=("--channels", "S0.650,000nm,S0.550,000nm,S0.450,000nm")),
    Picture("sensor", "sensor of a camera, white balance", f"{CARD}{KNOT}",
            film=FILM + ' "string sensor" "nikon_d850" "float whitebalance" 4200'),
    Picture("bloom", "imgtool bloom", f"{GREY}\n{KNOT}",
            after=(("bloom", "--level", "3", "--width", "25", "--scale", ".5"),), show=("--exposure", "2"),
            light='AttributeBegin Translate -.9 1.2 2 AreaLightSource "diffuse" "rgb L" [ 18 14 9 ]\n'
                  'Shape "sphere" "float radius" .18 AttributeEnd'),
    Picture("whitebalance", "imgtool whitebalance to the light", f"{GREY}\n{KNOT}",
            after=(("whitebalance", "--temperature", "2700"),), show=("--exposure", "2"),
            light='AttributeBegin Translate -1.6 -1.8 3 AreaLightSource "diffuse" "blackbody L" 2700 "float scale" 12\n'
                  'Shape "sphere" "float radius" .4 AttributeEnd'),
]



def medium(name, title, parameters, shape='Shape "sphere"', more="", **others):
    """A medium inside a shape that is no surface."""
    others.setdefault("integrator", 'Integrator "volpath" "integer maxdepth" 60')
    return Picture(name, title, f'Translate 0 0 1 {more}\nMakeNamedMedium "m" {parameters}\nMediumInterface "m" ""\n'
                   f'Material "interface"\n{shape}', times=4, **others)


def densities(count, value):
    """Values on a grid of count voxels a side; value(x, y, z) with coordinates from -1 to 1."""
    at = [(2 * i + 1) / count - 1 for i in range(count)]
    return numbers(round(value(x, y, z), 3) for z in at for y in at for x in at)


BOX = '"point3 p0" [ -1 -1 -1 ] "point3 p1" [ 1 1 1 ]'
WHITE = '"rgb sigma_a" [ 0 0 0 ] "rgb sigma_s"'
GLASS_BALL = ('MakeNamedMedium "m" "string type" "homogeneous" "string preset" "{}" "float scale" {}\nMediumInterface "m" ""\n'
              'Material "dielectric" "float eta" 1.4\nTranslate 0 0 1 Shape "sphere"')
MEDIA = [
    medium("medium-even", "homogeneous", f'"string type" "homogeneous" {WHITE} [ 1.5 1.2 .8 ]'),
    medium("medium-forward", "homogeneous, g 0.8", f'"string type" "homogeneous" {WHITE} [ 4 4 4 ] "float g" .8'),
    medium("medium-absorbs", "homogeneous, absorption only",
           '"string type" "homogeneous" "rgb sigma_s" [ 0 0 0 ] "rgb sigma_a" [ .3 .8 1.6 ]'),
    Picture("medium-preset", "preset Apple in a body of glass", GLASS_BALL.format("Apple", 4), times=4,
            integrator='Integrator "volpath" "integer maxdepth" 100'),
    medium("medium-grid", "uniformgrid", f'"string type" "uniformgrid" "integer nx" 12 "integer ny" 12 "integer nz" 12 {BOX} '
           f'{WHITE} [ 9 9 9 ] "float density" [ '
           + densities(12, lambda x, y, z: max(0, 1 - abs(math.hypot(x, y) - .6) * 5) * max(0, 1 - z * z)) + " ]"),
    medium("medium-rgbgrid", "rgbgrid", f'"string type" "rgbgrid" "integer nx" 4 "integer ny" 4 "integer nz" 4 {BOX} '
           '"float scale" 8 "rgb sigma_a" [ ' + numbers([0] * 192) + ' ] "rgb sigma_s" [ '
           + numbers(c for i in range(64) for c in ((1, .2, .1), (.2, .9, .2), (.15, .3, 1))[(i + i // 4 + i // 16) % 3]) + " ]"),
    medium("medium-cloud", "cloud", f'"string type" "cloud" {BOX} {WHITE} [ 14 14 14 ] "float density" .8 "float g" .5',
           more="Rotate 90 1 0 0"),
    medium("medium-temperature", "uniformgrid with temperatures", '"string type" "uniformgrid" "integer nx" 8 "integer ny" 8 '
           f'"integer nz" 8 {BOX} "rgb sigma_a" [ 4 4 4 ] "rgb sigma_s" [ 1 1 1 ] "float density" [ '
           + densities(8, lambda x, y, z: max(0, 1 - math.hypot(x, y) / (.7 - .5 * z) * .9)) + ' ] "float temperature" [ '
           + densities(8, lambda x, y, z: 1750 - 450 * z) + " ]"),
    Picture("medium-fog", "fog around the camera", f"{GREY}\n{KNOT}", times=4, floor=FLOOR,
            camera='MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ .005 .005 .005 ] "rgb sigma_s" [ .06 .06 .06 ]\n'
                   f'MediumInterface "fog" "fog"\n{CAMERA}',
            integrator='Integrator "volpath" "integer maxdepth" 12'),
]

LAMP = '''LightSource "infinite" "rgb L" [ .03 .03 .04 ]
AttributeBegin Translate -2.6 1.9 4.4
AreaLightSource "diffuse" "rgb L" [ 5600 5200 4400 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "sphere" "float radius" .08
AttributeEnd'''
CAUSTICS = ('AttributeBegin Material "dielectric" "float eta" 1.5 Translate -.7 -.3 .7 Shape "sphere" "float radius" .7 AttributeEnd\n'
            f'Material "conductor" {GOLD} "float roughness" .03\n'
            'Translate .95 .2 0 Shape "cylinder" "float radius" .62 "float zmin" 0 "float zmax" .7')
GREY_FLOOR = 'AttributeBegin Material "diffuse" "rgb reflectance" [ .45 .45 .45 ]\n' \
             'Shape "bilinearmesh" "point3 P" [ -8 -8 0  8 -8 0  -8 8 0  8 8 0 ] AttributeEnd'


def integrator(name, title, parameters="", times=1):
    """A ball of glass and a golden ring under a small lamp."""
    return Picture(f"integrator-{name}", title, CAUSTICS, light=LAMP, floor=GREY_FLOOR, times=times,
                   integrator=f'Integrator "{name}" "integer maxdepth" 8 {parameters}', of=("integrators", name))


def simple(name, title, parameters='"integer maxdepth" 5'):
    """A knot under a large lamp, which is found without light sampling too."""
    return Picture(f"integrator-{name}", title, f"{CLAY}\n{KNOT}", times=2, integrator=f'Integrator "{name}" {parameters}',
                   of=("integrators", name))


FOG = ('MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 1.6 1.9 2.4 ] '
       '"rgb sigma_a" [ .3 .1 0 ]')
FOG_BALL = f'Material "interface" MediumInterface "fog" "" {BALL}'
INTEGRATORS = [
    integrator("path", "path: caustics by BSDF sampling only"),
    Picture("integrator-volpath", "volpath: media and surfaces", FOG_BALL, light=f"{LIGHT}\n{FOG}", times=2,
            integrator='Integrator "volpath" "integer maxdepth" 30', of=("integrators", "volpath")),
    integrator("lightpath", "lightpath: no camera path through glass", times=4),
    integrator("bdpt", "bdpt"),
    integrator("sppm", "sppm", '"float radius" .08 "integer photonsperiteration" 60000'),
    integrator("mlt", "mlt", '"integer mutationsperpixel" 96'),
    simple("simplepath", "simplepath: no MIS"),
    Picture("integrator-simplevolpath", "simplevolpath: media without surfaces", FOG_BALL, floor="", times=2,
            light='LightSource "infinite" "rgb L" [ .75 .8 .85 ]\n' + FOG,
            integrator='Integrator "simplevolpath" "integer maxdepth" 30', of=("integrators", "simplevolpath")),
    simple("randomwalk", "randomwalk: uniform directions"),
    simple("ambientocclusion", "ambientocclusion", ""),
]


def sampler(name, parameters='"integer pixelsamples" 4'):
    """Four samples per pixel, one bounce of light."""
    return Picture(f"sampler-{name}", name, f"{CLAY}\n{KNOT}", sampler=f'Sampler "{name}" {parameters}',
                   integrator='Integrator "path" "integer maxdepth" 2', of=("samplers", name))


SAMPLERS = [*(sampler(name) for name in ("independent", "halton", "paddedsobol", "pmj02bn", "sobol")),
            sampler("stratified", '"integer xsamples" 2 "integer ysamples" 2'), sampler("zsobol")]

GROUPS = [("Shapes", SHAPES), ("Materials", MATERIALS), ("Textures", TEXTURES), ("Lights", LIGHTS),
          ("Media", MEDIA), ("Cameras", CAMERAS), ("Integrators", INTEGRATORS), ("Samplers", SAMPLERS),
          ("Film and tools", FILMS)]
