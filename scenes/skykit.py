"""Images of the sky for infinite lights, in the square equal-area octahedral layout that pbrt-v4 reads, as PFM files.

Directions have z up; angles are degrees, azimuths run from +x to +y. A sky is a function from the direction to red,
green and blue: clear_sky(), overcast_sky() and studio() make such functions, sky_image() makes the picture, sky_light()
hangs it over a Scene, and portal_variant() writes the scene a second time with a portal."""
import math
import struct

from scenekit import cross, normalized, number, numbers


def square_to_sphere(u, v):
    """Clarberg's equal-area octahedral mapping, the one pbrt-v4 uses: [0,1]^2 to directions, z up."""
    a, b = 2 * u - 1, 2 * v - 1
    d = 1 - abs(a) - abs(b)
    r = 1 - abs(d)
    turn = math.pi / 4 * ((abs(b) - abs(a)) / r + 1 if r else 1)
    s = r * math.sqrt(2 - r * r)
    return (math.copysign(s * math.cos(turn), a), math.copysign(s * math.sin(turn), b), math.copysign(1 - r * r, d))


def direction(azimuth, elevation):
    a, e = math.radians(azimuth), math.radians(elevation)
    return (math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def angle(a, b):
    """Degrees between unit vectors."""
    return math.degrees(math.acos(max(min(dot(a, b), 1.0), -1.0)))


def mixed(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def luminance(rgb):
    return .2126 * rgb[0] + .7152 * rgb[1] + .0722 * rgb[2]


class Sun:
    """A disc of `radius` degrees, as bright as it takes for `share` of all light on the level ground."""

    def __init__(self, azimuth, elevation, share=.6, radius=1.5, colour=(1, .9, .74)):
        self.direction, self.share, self.radius, self.colour = direction(azimuth, elevation), share, radius, colour


# ---- skies: functions from a direction to its radiance ---------------------------------------------------------------

def clear_sky(sun=None, zenith=(.24, .42, .9), horizon=(.86, .93, 1.0), ground=(.3, .33, .2), far=(.36, .45, .4)):
    """Blue above, bright at the horizon, a glow around the sun (its disc is not in it). Below the horizon a band of
    distant woods, `far`, turns into the ground."""
    def radiance(d):
        if d[2] < 0:
            return mixed(far, ground, min(-d[2] / .12, 1.0))
        base = mixed(horizon, zenith, d[2] ** .45)
        if sun:
            a = angle(d, sun.direction)
            glow = 1.1 * math.exp(-a / 7) + .35 * math.exp(-a / 30)
            base = tuple(b + glow * c for b, c in zip(base, (1, .86, .64)))
        return base
    return radiance


def overcast_sky(zenith=(1, 1.02, 1.06), ground=(.16, .18, .13), far=(.2, .23, .24)):
    """The CIE's overcast sky: three times as bright at the zenith as at the horizon, and no sun."""
    def radiance(d):
        if d[2] < 0:
            return mixed(far, ground, min(-d[2] / .12, 1.0))
        return tuple(c * (1 + 2 * d[2]) / 3 for c in zenith)
    return radiance


def studio(boxes, above=(.05, .05, .055), below=(.02, .02, .02)):
    """A dark dome with softboxes: (azimuth, elevation, width, height, roll, rgb), sizes in degrees as seen from inside;
    each is a flat rectangle that faces the middle."""
    panels = []
    for azimuth, elevation, width, height, roll, rgb in boxes:
        n = direction(azimuth, elevation)
        right = normalized(cross((0, 0, 1), n)) if abs(n[2]) < .999 else (1.0, 0.0, 0.0)
        up = cross(n, right)
        c, s = math.cos(math.radians(roll)), math.sin(math.radians(roll))
        x = tuple(c * r + s * u for r, u in zip(right, up))
        y = tuple(c * u - s * r for r, u in zip(right, up))
        panels.append((n, x, y, math.tan(math.radians(width / 2)), math.tan(math.radians(height / 2)), rgb))

    def radiance(d):
        total = mixed(below, above, min(max(.5 + 2 * d[2], 0.0), 1.0))
        for n, x, y, w, h, rgb in panels:
            front = dot(d, n)
            if front > 0 and abs(dot(d, x)) < w * front and abs(dot(d, y)) < h * front:
                total = tuple(t + c for t, c in zip(total, rgb))
        return total
    return radiance


# ---- pictures and lights ---------------------------------------------------------------------------------------------

def sky_image(side, radiance, sun=None, fine=3):
    """A PFM of side x side pixels, each the mean of fine x fine directions (of more where the sun's disc may be)."""
    def sampled(row, column, fine, f, channels):
        total = [0.0] * channels
        for k in range(fine * fine):
            u, v = (column + (k % fine + .5) / fine) / side, (row + (k // fine + .5) / fine) / side
            total = [t + c for t, c in zip(total, f(square_to_sphere(u, v)))]
        return [t / fine ** 2 for t in total]

    pixels = [[sampled(row, column, fine, radiance, 3) for column in range(side)] for row in range(side)]
    if sun:
        level = of_sun = 0.0
        discs = []
        for row in range(side):
            for column in range(side):
                d = square_to_sphere((column + .5) / side, (row + .5) / side)
                level += max(d[2], 0) * luminance(pixels[row][column])
                if angle(d, sun.direction) > sun.radius + 300 / side:
                    continue
                part, = sampled(row, column, 16, lambda e: (float(angle(e, sun.direction) < sun.radius),), 1)
                if part:
                    discs.append((row, column, part))
                    of_sun += part * max(d[2], 0) * luminance(sun.colour)
        strength = sun.share / (1 - sun.share) * level / of_sun
        for row, column, part in discs:
            pixels[row][column] = [p + strength * part * c for p, c in zip(pixels[row][column], sun.colour)]

    out = bytearray(f"PF\n{side} {side}\n-1.0\n".encode())
    for row in reversed(pixels):  # bottom row first; v = 0 is the top row
        for pixel in row:
            out += struct.pack("<3f", *(float(number(c, 3)) for c in pixel))
    return bytes(out)


def sky_light(scene, image, scale=1.0, label="the sky"):
    """The scene's infinite light, with its image in a file of its own."""
    file = f"{scene.name}-sky.pfm"
    scene.files[file] = image
    scene.lights += 1
    scene.raw(f'# light {scene.lights}: {label}\n'
              f'LightSource "infinite" "string filename" "{file}" "float scale" {number(scale)}')


def portal_variant(scene, corners, about):
    """Adds NAME-portal.pbrt: the scene as it is now, with a portal. The corners go around the rectangle, clockwise as
    seen from where the sky is (light enters against the cross product of its last side and its first)."""
    light = f'LightSource "infinite" "string filename" "{scene.name}-sky.pfm"'
    text = scene.text()
    for old, new in ((f"# {scene.about}\n", f"# {about}\n"), (f'"{scene.name}.exr"', f'"{scene.name}-portal.exr"'),
                     (light, f'{light} "point3 portal" [ {"  ".join(numbers(c) for c in corners)} ]')):
        if text.count(old) != 1:
            raise ValueError(f"{scene.name}: {text.count(old)} times {old!r}")
        text = text.replace(old, new)
    scene.files[f"{scene.name}-portal.pbrt"] = text.encode()
