"""--serve in headless Chromium (Debian's chromium, chromium-driver, python3-selenium; without these the exit status is 77
and a line says SKIPPED). Arguments: pbrt imgtool. LIVE_PAGE_SCREENSHOT: file for a picture of the page."""
import array
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

PBRT, IMGTOOL = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[4] / "support"))
import browser  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

SCENE = """LookAt 0 1.4 -5  0 0.1 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" %d "integer yresolution" %d "string filename" "picture.exr" "bool savefp16" false
Sampler "independent" "integer pixelsamples" %d
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 16 14 12 ]
Translate -2 3 -2
Shape "sphere" "float radius" 0.4
AttributeEnd
LightSource "infinite" "rgb L" [ 0.1 0.15 0.25 ]
Material "coateddiffuse" "rgb reflectance" [ 0.7 0.25 0.2 ] "float roughness" 0.05
Shape "sphere"
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.45 ]
Shape "bilinearmesh" "point3 P" [ -9 -1 -4  9 -1 -4  -9 -1 9  9 -1 9 ]
"""


class LivePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.driver = browser.start(f"{folder}/profile", "1100,1000", ["browser"])
        cls.addClassCleanup(cls.driver.quit)

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.driver.get("about:blank")
        self.driver.get_log("browser")

    def start(self, *arguments, size=(480, 320), samples=100000):
        """Starts a render with one thread, beside the browser; returns its process and the address of its page."""
        (self.folder / "scene.pbrt").write_text(SCENE % (*size, samples))
        process = subprocess.Popen([PBRT, "--nthreads", "1", *arguments, "scene.pbrt"], cwd=self.folder,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, process)
        for line in process.stderr:
            if found := re.match(r"Live page: (http://127\.0\.0\.1:\d+/)", line):
                return process, found[1]
        self.fail("no address was printed")

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.wait()
        process.stderr.close()

    def show(self, *arguments, **options):
        """Starts a render and shows its page; returns the process when there is a picture."""
        process, address = self.start("--serve=0", *arguments, **options)
        self.driver.get(address)
        self.until(lambda: self.version() > 0)
        return process

    def text(self, name):
        return self.driver.find_element(By.ID, name).text

    def until(self, condition, seconds=30, interval=0.1):
        return WebDriverWait(self.driver, seconds, interval).until(lambda _: condition())

    def version(self):
        return int(self.driver.execute_script("return document.body.dataset.version || 0"))

    @staticmethod
    def status(address):
        with urllib.request.urlopen(address + "status", timeout=10) as answer:
            return json.load(answer)

    def test_the_picture_grows_and_stays(self):
        process = self.show("--time", "8", size=(240, 160))
        first = self.version()
        self.until(lambda: self.version() > first)
        self.assertEqual(self.text("title"), "scene.pbrt")
        self.assertIn("picture.exr, 240 × 160", self.text("facts"))
        self.until(lambda: self.text("phase") == "rendering")
        self.until(lambda: "%" in self.text("error") and "%" in self.text("error-end"))
        self.assertRegex(self.text("left"), r"^0:\d\d$")
        colours = self.driver.execute_script(
            "const c = document.getElementById('picture'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height)"
            ".data; return [c.width, c.height, Array.from(d.slice(4 * (80 * 240 + 120), 4 * (80 * 240 + 120) + 4))];")
        self.assertEqual(colours[:2], [240, 160])
        red, _, blue, alpha = colours[2]
        self.assertGreater(red, blue + 10, "the ball in the middle is red")
        self.assertEqual(alpha, 255)
        if shot := os.environ.get("LIVE_PAGE_SCREENSHOT"):
            self.until(lambda: self.driver.execute_script("return status.fraction > 0.5"))
            self.driver.save_screenshot(shot)
        self.until(lambda: self.text("phase") == "done")
        self.assertIn("finished", self.text("note"))
        self.assertEqual(process.wait(20), 0)
        # The page holds the picture of the file.
        subprocess.run([IMGTOOL, "convert", "picture.exr", "p.pfm"], cwd=self.folder, check=True)
        data = (self.folder / "p.pfm").read_bytes()
        rows = array.array("f", data[re.match(rb"PF\s+240\s+160\s+-1\S*\s", data).end():])
        mine = [rows[3 * 240 * (159 - y) + i] for y in range(160) for i in range(0, 3 * 240, 97)]
        page = self.driver.execute_script(
            "const r = []; for (let y = 0; y < 160; ++y) for (let i = 0; i < 720; i += 97) r.push(pixels[y * 720 + i]);"
            "return r;")
        self.assertEqual(mine, page)
        bad = [e for e in self.driver.get_log("browser") if e["level"] in ("SEVERE", "WARNING")
               and "willReadFrequently" not in e["message"]]
        self.assertEqual(bad, [], "console errors")

    def test_the_error_is_estimated(self):
        most = 1024
        process, address = self.start("--serve=0", "--spp", str(most), size=(96, 72))
        seen = {}

        def has_ended():
            try:
                status = self.status(address)
            except (urllib.error.URLError, ConnectionError):
                return process.poll() is not None
            if status["relL2"] is not None and status["samples"] <= most // 2:
                seen[status["samples"]] = status["relL2"]
            return False

        # The cost of requests is taken from the time for pictures.
        self.until(has_ended, seconds=600, interval=0.2)
        self.assertTrue(seen)
        reference = self.folder / "picture.exr"
        reference.rename(self.folder / "reference.exr")
        for samples in list(seen)[-3:]:
            subprocess.run([PBRT, "--quiet", "--spp", str(samples), "--seed", "7", "scene.pbrt"], cwd=self.folder,
                           check=True)
            diff = subprocess.run([IMGTOOL, "diff", "picture.exr", "--reference", "reference.exr", "--metric", "relL2",
                                   "--json"], cwd=self.folder, capture_output=True, text=True)
            # The reference has an error of its own, which is smaller as it has more samples.
            truth = json.loads(diff.stdout)["error"] / (1 + samples / most)
            self.assertLess(abs(seen[samples] / truth - 1), 0.2, f"{samples} samples: {seen[samples]}, in truth {truth}")

    def test_a_missing_error_has_a_reason(self):
        _, address = self.start("--serve=0", "--spp", "1", size=(64, 48))
        self.driver.get(address)
        self.until(lambda: self.text("phase") == "done")
        self.assertEqual(self.text("error"), "–")
        self.assertIn("two images", self.text("why"))

    def test_exposure_can_be_changed(self):
        process = self.show("--spp", "100000", size=(64, 48))
        mean = ("const c = document.getElementById('picture'); const d = c.getContext('2d').getImageData(0, 0, 64, 48).data;"
                "let s = 0; for (let i = 0; i < d.length; i += 4) s += d[i]; return s;")
        move = ("const e = document.getElementById('exposure'); e.value = arguments[0];"
                "e.dispatchEvent(new Event('input'));")
        self.driver.execute_script(move, -3)
        dark = self.driver.execute_script(mean)
        self.driver.execute_script(move, 3)
        self.assertGreater(self.driver.execute_script(mean), 2 * dark)
        self.assertEqual(self.text("stops"), "+3 stops")
        # A render that is gone is no finished one.
        process.kill()
        self.until(lambda: "does not answer" in self.text("note"))

    def test_ports_and_other_hosts(self):
        _, address = self.start("--serve", "0")
        port = int(address.rstrip("/").rsplit(":", 1)[1])
        # Other hosts' pages, and other methods, get nothing.
        for request, code in ((urllib.request.Request(address + "nothing"), 404),
                              (urllib.request.Request(address, headers={"Host": "evil.example"}), 403),
                              (urllib.request.Request(address, method="DELETE"), 405)):
            with self.assertRaises(urllib.error.HTTPError) as failed:
                urllib.request.urlopen(request, timeout=10)
            self.assertEqual(failed.exception.code, code)
            failed.exception.close()
        # Other addresses of this machine are not listened to.
        with self.assertRaises(OSError):
            socket.create_connection(("127.0.0.2", port), 2)
        for flags, message in ((["--serve", str(port)], "--serve: port"), (["--serve=web"], "no port")):
            wrong = subprocess.run([PBRT, *flags, "scene.pbrt"], cwd=self.folder, capture_output=True, text=True,
                                   timeout=20)
            self.assertEqual(wrong.returncode, 1)
            self.assertIn(message, wrong.stderr)

    def test_an_interrupted_render_is_called_so(self):
        process = self.show("--spp", "100000", size=(64, 48))
        process.send_signal(signal.SIGINT)
        self.until(lambda: self.text("phase") == "interrupted")
        self.assertIn("interrupted", self.text("note"))
        self.assertEqual(process.wait(10), 130)

    def test_without_a_browser(self):
        begin = time.monotonic()
        process, _ = self.start("--serve", "--spp", "4", size=(64, 48))
        self.assertEqual(process.wait(20), 0)
        self.assertLess(time.monotonic() - begin, 10)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
