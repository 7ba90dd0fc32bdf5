"""--display-server: a stand-in for tev puts the picture together from the packets of pbrt. Arguments: pbrt imgtool."""
import io
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

PBRT, IMGTOOL = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
CLOSE, UPDATE, CREATE = 2, 3, 4

SCENE = """LookAt 0 1 -5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "%s" "integer xresolution" %d "integer yresolution" %d "string filename" "picture.exr" "bool savefp16" false
Sampler "zsobol" "integer pixelsamples" %d
WorldBegin
LightSource "point" "point3 from" [ -2 2 -2 ] "rgb I" [ 2 3 4 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.4 0.3 ]
Shape "sphere"
Shape "bilinearmesh" "point3 P" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4 ]
"""


class Reader(io.BytesIO):
    """The values of one packet, in order."""

    def numbers(self, code):
        return struct.unpack("<" + code, self.read(struct.calcsize("<" + code)))

    def text(self):
        begin, end = self.tell(), self.getvalue().index(b"\0", self.tell())
        self.seek(end + 1)
        return self.getvalue()[begin:end].decode()


class Tev:
    """Listens on a port; reads packets and keeps the images that they make."""

    def __init__(self, reads=True, stops_after=None):
        self.images, self.log, self.reads, self.stops_after = {}, [], reads, stops_after
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.name = f"127.0.0.1:{self.listener.getsockname()[1]}"
        self.failure = self.connection = None
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def close(self):
        self.listener.close()
        if self.connection:
            self.connection.close()

    def run(self):
        try:
            self.connection = self.listener.accept()[0]
            if not self.reads:
                return
            with self.connection.makefile("rb") as stream:
                while head := stream.read(4):
                    length = struct.unpack("<I", head)[0]
                    body = stream.read(length - 4)
                    assert len(body) == length - 4, "a packet is cut short"
                    self.handle(Reader(body))
                    if self.stops_after and len(self.log) >= self.stops_after:
                        self.connection.close()
                        return
        except Exception as e:  # noqa: BLE001, passed to the test
            self.failure = e

    def handle(self, packet):
        kind = packet.numbers("b")[0]
        self.log.append(kind)
        if kind == CLOSE:
            self.images.pop(packet.text(), None)
        elif kind == CREATE:
            grabs, name = packet.numbers("b")[0], packet.text()
            width, height, count = packet.numbers("iii")
            assert grabs == 1 and name not in self.images
            channels = [packet.text() for _ in range(count)]
            self.images[name] = (width, height, {c: [None] * (width * height) for c in channels})
        elif kind == UPDATE:
            packet.numbers("b")
            width, height, channels = self.images[packet.text()]
            values = channels[packet.text()]
            x, y, w, h = packet.numbers("iiii")
            assert 0 <= x and 0 <= y and x + w <= width and y + h <= height
            for row in range(h):
                begin = (y + row) * width + x
                values[begin:begin + w] = packet.numbers(f"{w}f")
        else:
            raise AssertionError(f"packet of the unknown type {kind}")
        assert not packet.read(), "a packet is longer than what it holds"


def read_pfm(path):
    """Width, height and rows from the top, each a tuple of red, green, blue, ... as in the file, bit for bit."""
    data = path.read_bytes()
    head = re.match(rb"PF\s+(\d+)\s+(\d+)\s+(-?[\d.]+)\s", data)
    width, height = int(head[1]), int(head[2])
    order = "<" if float(head[3]) < 0 else ">"
    values = struct.unpack(f"{order}{3 * width * height}f", data[head.end():])
    rows = [values[3 * width * y:3 * width * (y + 1)] for y in range(height)]
    return width, height, rows[::-1]


class DisplayServer(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def listen(self, **how):
        tev = Tev(**how)
        self.addCleanup(tev.close)
        return tev

    def render(self, server, *arguments, film="rgb", size=(61, 47), samples=64, quiet=True):
        (self.folder / "scene.pbrt").write_text(SCENE % (film, *size, samples))
        begin = time.monotonic()
        flags = ["--quiet"] if quiet else []
        done = subprocess.run([PBRT, *flags, "--display-server", server, *arguments, "scene.pbrt"], cwd=self.folder,
                              capture_output=True, text=True, timeout=60)
        self.seconds = time.monotonic() - begin
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr

    def final_picture(self):
        subprocess.run([IMGTOOL, "convert", "picture.exr", "p.pfm", "--channels", "R,G,B"], cwd=self.folder, check=True)
        return read_pfm(self.folder / "p.pfm")

    def check(self, tev, low=(0, 0), full=None):
        tev.thread.join(10)
        self.assertIsNone(tev.failure)
        width, height, rows = self.final_picture()
        image = tev.images["picture.exr"]
        self.assertEqual(image[:2], full or (width, height))
        self.assertEqual(list(image[2]), ["R", "G", "B"])
        for c, values in enumerate(image[2].values()):
            for y in range(height):
                begin = (y + low[1]) * image[0] + low[0]
                self.assertEqual(tuple(values[begin:begin + width]), rows[y][c::3], f"channel {c}, row {y}")
        outside = sum(v is None for v in image[2]["R"])
        self.assertEqual(outside, image[0] * image[1] - width * height)

    def test_packets_make_up_the_final_picture(self):
        for film in ("rgb", "spectral", "gbuffer"):
            tev = self.listen()
            self.render(tev.name, film=film)
            self.check(tev)
            self.assertEqual(tev.log[:2], [CLOSE, CREATE])
            self.assertEqual(set(tev.log[2:]), {UPDATE})

    def test_the_picture_comes_before_the_end(self):
        tev = self.listen()
        self.render(tev.name, samples=512)
        self.check(tev)
        self.assertGreaterEqual(tev.log.count(UPDATE), 2 * 3, "only the last picture was sent")

    def test_strips_and_windows(self):
        tev = self.listen()
        self.render(tev.name, "--pixelbounds", "11,1311,3,83", size=(1400, 90), samples=2)
        self.check(tev, low=(11, 3), full=(1400, 90))
        self.assertGreaterEqual(tev.log.count(UPDATE), 2 * 3, "a packet holds more than a strip")

    def test_watching_changes_no_bit(self):
        tev = self.listen()
        self.render(tev.name, samples=256)
        watched = self.final_picture()
        (self.folder / "picture.exr").unlink()
        subprocess.run([PBRT, "--quiet", "scene.pbrt"], cwd=self.folder, check=True)
        self.assertEqual(watched, self.final_picture())

    def test_without_a_server(self):
        with socket.create_server(("127.0.0.1", 0)) as closed:
            name = f"127.0.0.1:{closed.getsockname()[1]}"
        messages = self.render(name, quiet=False)
        self.assertRegex(messages, "--display-server .*continues without it")
        self.final_picture()
        self.assertLess(self.seconds, 5)

    def test_a_viewer_that_goes_away(self):
        tev = self.listen(stops_after=4)
        self.assertIn("the viewer is gone", self.render(tev.name, quiet=False, samples=512))
        self.final_picture()

    def test_a_viewer_that_never_reads(self):
        tev = self.listen(reads=False)
        # More than the buffers of a connection hold.
        self.assertIn("reads nothing", self.render(tev.name, quiet=False, size=(1100, 900), samples=1))
        self.final_picture()

    def test_a_host_that_is_none(self):
        self.assertIn("Wrote picture.exr", self.render("no.such.host.invalid:14158", quiet=False))
        self.final_picture()

    def test_mistakes(self):
        for server in ("localhost", "localhost:tev", ":14158", "localhost:70000"):
            done = subprocess.run([PBRT, "--display-server", server, "scene.pbrt"], cwd=self.folder,
                                  capture_output=True, text=True, timeout=20)
            self.assertEqual(done.returncode, 1)
            self.assertIn("HOST:PORT", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
