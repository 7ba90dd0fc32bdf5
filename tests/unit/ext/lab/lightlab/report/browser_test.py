"""Tests report.html in headless Chromium (Debian's chromium, chromium-driver, python3-selenium). Without these,
the exit status is 77 and a line says SKIPPED."""
import base64
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import synthetic_results as synthetic  # noqa: E402

SCRIPTS = pathlib.Path(os.environ.get("LIGHTLAB_REPORT")
                       or pathlib.Path(__file__).resolve().parents[6] / "src/ext/lab/lightlab/report")

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[5] / "support"))
import browser  # noqa: E402
from selenium.webdriver import ActionChains, Keys  # noqa: E402
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402


class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.driver = browser.start(cls.folder / "profile", "1300,1400", ["browser", "performance"])
        cls.addClassCleanup(cls.driver.quit)


class Page(InBrowser):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        cls.results = synthetic.make(cls.out)
        for script in ("charts.py", "report.py"):
            subprocess.run([sys.executable, SCRIPTS / script, cls.out], check=True, stdout=subprocess.DEVNULL)

    def setUp(self):
        self.driver.get("about:blank")
        self.driver.get_log("browser")
        self.driver.get_log("performance")
        self.driver.get((self.out / "report.html").as_uri())
        self.stops = 0
        self.stage = self.find("#stage")
        # The stage must be wholly visible, because WebDriver measures from the middle of the visible part.
        self.center(self.stage)

    def tearDown(self):
        # Only these tests read pixels back, about which the browser warns.
        bad = [e for e in self.driver.get_log("browser")
               if e["level"] in ("SEVERE", "WARNING") and "willReadFrequently" not in e["message"]]
        self.assertEqual(bad, [], "console errors")
        urls = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                urls.append(message["params"]["request"]["url"])
        self.assertTrue(any(u.startswith("file:") for u in urls), "the log of requests must see the page itself")
        outside = [u[:80] for u in urls if not u.startswith("data:") and u != (self.out / "report.html").as_uri()]
        self.assertEqual(outside, [], "the page requests something outside itself")

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def find_all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def js(self, code, *arguments):
        return self.driver.execute_script("return " + code, *arguments)

    def center(self, element):
        self.js("arguments[0].scrollIntoView({block: 'center', inline: 'center'})", element)
        return element

    def clips(self):
        return [self.js("getComputedStyle(document.getElementById(arguments[0])).clipPath", f"layer-{side}")
                for side in ("left", "right")]

    def transforms(self):
        """The tuples (scale, x, y) of both pictures."""
        found = []
        for side in ("left", "right"):
            m = self.js("getComputedStyle(document.querySelector(arguments[0])).transform", f"#layer-{side} .plane")
            a, _, _, _, x, y = (float(v) for v in m[len("matrix("):-1].split(","))
            found.append((a, x, y))
        return found

    def shown(self, side):
        """The name of the shown picture, after checking that exactly its file's pixels are the visible element."""
        name = self.js("document.getElementById(arguments[0]).dataset.shown", f"layer-{side}")
        label, kind = name.rsplit("/", 1)
        entry = (self.results if label == "reference" else
                 next(s for s in self.results["samplers"] if s["label"] == label))
        visible = self.js("[...document.querySelectorAll(arguments[0])].filter("
                          "(e) => getComputedStyle(e).visibility === 'visible')"
                          ".map((e) => [e.tagName, e.dataset.file])",
                          f"#layer-{side} .plane > *")
        if kind not in ("result", "error"):
            file = next(v["file"] for v in entry["views"]["layers"] if v["name"] == kind)
        elif label == "reference":
            file = self.results["references"][0]["pictureRange"]
        else:
            file = entry["pictureRange" if kind == "result" else "errorPicture"]
        self.assertEqual(visible, [["CANVAS" if file.endswith(".hdr") else "IMG", file]])
        if file.endswith(".hdr"):
            self.check_pixels(f'#layer-{side} canvas[data-file="{file}"]', file, self.stops)
        else:
            expected = base64.b64encode((self.out / file).read_bytes()).decode()
            self.assertEqual(self.js("document.querySelector(arguments[0]).src",
                                     f'#layer-{side} img[data-file="{file}"]'),
                             "data:image/png;base64," + expected)
        self.assertIn(label, self.find(f"#name-{side}").text)
        return name

    def check_pixels(self, selector, file, stops, x0=0, y0=0):
        """The canvas shows the file's pixels, brighter by the given stops, up to one step of 8 bits."""
        WebDriverWait(self.driver, 10).until(
            lambda _: self.js("document.querySelector(arguments[0]).dataset.painted", selector) == f"{stops:g}")
        bytes_ = (self.out / file).read_bytes()
        start = len(bytes_) - 4 * synthetic.WIDTH * synthetic.HEIGHT
        for x, y in ((1, 1), (9, 3), (20, 17)):
            at = start + 4 * ((y + y0) * synthetic.WIDTH + x + x0)
            scale = synthetic.EXPOSURE * 2 ** stops * 2.0 ** (bytes_[at + 3] - 136)
            expected = [encoded(scale * (v + 0.5)) if bytes_[at + 3] else 0 for v in bytes_[at:at + 3]]
            shown = self.js("[...document.querySelector(arguments[0]).getContext('2d').getImageData("
                            "arguments[1], arguments[2], 1, 1).data]", selector, x, y)
            self.assertEqual(shown, [*expected, 255], (file, x, y))

    def press(self, *keys):
        chain = ActionChains(self.driver)
        for key in keys[:-1]:
            chain = chain.key_down(key)
        chain = chain.send_keys(keys[-1])
        for key in keys[:-1]:
            chain = chain.key_up(key)
        chain.perform()

    def press_code(self, code, shift):
        """Presses a digit key by its position: with Shift, its character depends on the keyboard layout."""
        self.driver.execute_cdp_cmd("Input.dispatchKeyEvent", {
            "type": "keyDown", "code": code, "key": "!" if shift else code[-1], "modifiers": 8 if shift else 0})

    def expect(self, **names):
        """These pictures are shown, by side."""
        for side, name in names.items():
            self.assertEqual(self.shown(side), name)

    def after(self, *keys, **names):
        self.press(*keys)
        self.expect(**names)

    def colour_at(self, fraction):
        """The colour on the screen at this fraction of the stage's width and a quarter of its height."""
        from matplotlib import pyplot as plt
        file = self.out / "stage.png"
        file.write_bytes(self.stage.screenshot_as_png)
        image = plt.imread(file)
        return [round(255 * float(v)) for v in image[image.shape[0] // 4, int(image.shape[1] * fraction)][:3]]

    def assert_colour(self, fraction, expected):
        """Compares red and green; the shared exponent of a pixel costs a step or two of precision."""
        for shown, value in zip(self.colour_at(fraction), expected):
            self.assertAlmostEqual(shown, value, delta=3)

    def drag(self, element, dx, dy, x=0, y=0):
        chain = ActionChains(self.driver, duration=20).move_to_element_with_offset(element, x, y).click_and_hold()
        for _ in range(4):
            chain.move_by_offset(dx // 4, dy // 4)
        chain.release().perform()

    def test_WipeFollowsTheDrag(self):
        before = self.clips()
        width = self.stage.size["width"]
        self.drag(self.find("#wipe"), width // 4 // 4 * 4, 0)
        after = self.clips()
        self.assertNotEqual(before, after)
        percent = [float(after[0].split()[1].rstrip("%")), float(after[1].split()[3].rstrip("%)"))]
        self.assertAlmostEqual(sum(percent), 100, delta=0.01)  # where the left picture ends the right one begins
        self.assertAlmostEqual(percent[1], 75, delta=1)
        self.assertEqual(int(self.find("#wipe").get_attribute("aria-valuenow")), 75)

    def test_WipeDividesWhatIsSeen(self):
        self.press("1")
        self.press_code("Digit2", shift=True)
        red, green = (200, 30), (30, 160)
        self.expect(right="uniform/result", left="power/result")
        self.assert_colour(0.70, red)
        self.assert_colour(0.30, green)
        self.drag(self.find("#wipe"), self.stage.size["width"] // 4, 0)
        self.assert_colour(0.70, green)

    def test_WipeMovesByKeyboard(self):
        wipe = self.find("#wipe")
        right = self.shown("right")
        wipe.send_keys(Keys.ARROW_RIGHT)
        self.assertEqual(wipe.get_attribute("aria-valuenow"), "51")
        wipe.send_keys(Keys.HOME)
        self.assertEqual(wipe.get_attribute("aria-valuenow"), "0")
        self.assertEqual(self.shown("right"), right, "arrows on the handle leave the pictures alone")

    def test_WheelZoomsBothPicturesAtThePointer(self):
        left, right = self.transforms()
        self.assertEqual(left, right)
        px, py = self.stage.size["width"] / 2 + 150, self.stage.size["height"] / 2 - 100
        origin = ScrollOrigin.from_element(self.stage, 150, -100)
        ActionChains(self.driver).scroll_from_origin(origin, 0, -240).perform()
        zoomedLeft, zoomedRight = self.transforms()
        self.assertEqual(zoomedLeft, zoomedRight)
        self.assertGreater(zoomedLeft[0], 1.3 * left[0])
        for a, p in ((1, px), (2, py)):
            self.assertAlmostEqual((p - left[a]) / left[0], (p - zoomedLeft[a]) / zoomedLeft[0], delta=0.4)
        self.press("0")
        self.assertEqual(self.transforms()[0], left)

    def test_DragPansBothPictures(self):
        self.press("+")
        before = self.transforms()[0]
        self.drag(self.stage, 80, -40, x=-200, y=-60)
        left, right = self.transforms()
        self.assertEqual(left, right)
        self.assertAlmostEqual(left[1] - before[1], 80, delta=1)
        self.assertAlmostEqual(left[2] - before[2], -40, delta=1)
        self.assertEqual(self.clips(), ["inset(0px 50% 0px 0px)", "inset(0px 0px 0px 50%)"])

    def test_KeysAndListsChooseThePictures(self):
        self.assertEqual(self.shown("right"), "octree/result", "it starts with the winner on the right")
        self.assertNotEqual(self.shown("left"), "octree/result")
        self.after("3", right="bvh/result")
        left = self.shown("left")
        self.after("e", right="bvh/error")
        self.assertEqual(self.find("#show-error").get_attribute("aria-pressed"), "true")
        self.after("e", left=left)
        self.press_code("Digit2", shift=True)
        self.expect(left="power/result", right="bvh/result")
        self.after("r", right="reference/result")
        self.after("r", right="bvh/result")
        self.after(Keys.SHIFT, "r", left="reference/result")
        self.after(Keys.ARROW_RIGHT, right="neepp/result")
        self.assertIn("biased", self.find("#name-right").text)
        self.press(Keys.ARROW_LEFT)
        self.after(Keys.ARROW_LEFT, right="power/result")
        self.after(Keys.SHIFT, Keys.ARROW_RIGHT, left="uniform/result")
        self.after("x", left="power/result", right="uniform/result")
        self.after("9", right="uniform/result")
        self.find("#pick-left option:nth-child(4)").click()
        self.expect(left="bvh/result")

    def test_CropOpensInTheViewer(self):
        fitted = self.transforms()[0]
        self.center(self.find('#crops button[aria-label^="crop b, power, error"]')).click()
        self.expect(right="power/error")
        left, right = self.transforms()
        self.assertEqual(left, right)
        self.assertGreater(left[0], 2 * fitted[0])
        size = self.stage.size
        middle = [(size["width"] / 2 - left[1]) / left[0], (size["height"] / 2 - left[2]) / left[0]]
        self.assertAlmostEqual(middle[0], 72, delta=1)
        self.assertAlmostEqual(middle[1], 42, delta=1)
        self.check_pixels('#crops button[aria-label^="crop b, power, result"] canvas', "power/result.hdr", 0, 60, 30)

    def set_exposure(self, stops):
        self.stops = stops
        self.js("(e => { e.value = arguments[1]; e.dispatchEvent(new Event('input')); })(arguments[0])",
                self.find("#exposure"), str(stops))

    def test_ExposureIsTheSameForAllPicturesAndCrops(self):
        crop = '#crops button[aria-label^="crop a, bvh, result"] canvas'
        self.press("3")
        self.check_pixels(crop, "bvh/result.hdr", 0, 10, 20)
        before = self.colour_at(0.7)
        self.set_exposure(-2)
        self.expect(right="bvh/result")
        self.shown("left")
        self.check_pixels(crop, "bvh/result.hdr", -2, 10, 20)
        self.assertIn("2 stops", self.find("#stops").text)
        self.assertLess(self.colour_at(0.7)[2], 0.7 * before[2])
        # The exposure also changes a picture that was hidden meanwhile; pictures of errors have none.
        self.after("2", right="power/result")
        self.after("e", right="power/error")
        self.set_exposure(3)
        self.after("e", right="power/result")

    def test_ExposureByKeys(self):
        self.press("b")
        self.press("b")
        self.press("b")
        self.press("d")
        self.stops = 1
        self.assertEqual(self.find("#stops").text, "+1 stops")
        self.assertEqual(self.find("#exposure").get_attribute("value"), "1")
        self.shown("right")
        self.press("n")
        self.stops = 0
        self.shown("right")
        # The slider's own keys move the slider and do not change the pictures; other keys work there, too.
        right = self.shown("right")
        slider = self.find("#exposure")
        slider.send_keys(Keys.ARROW_RIGHT)
        self.stops = 0.5
        self.expect(right=right)
        slider.send_keys("3")
        self.expect(right="bvh/result")
        for _ in range(30):
            slider.send_keys("d")
        self.assertEqual(self.find("#stops").text, "\u221212 stops")

    def views_in(self, label):
        """The names of the pictures in a row of "Inspection", after checking that each shows its file's pixels."""
        entry = self.results if label == "the scene" else next(
            s for s in self.results["samplers"] if s["label"] == label)
        files = {v["name"]: v["file"] for v in entry["views"]["layers"]}
        names = []
        for button in self.find_all(f'#inside .view[data-label="{label}"] button'):
            names.append(button.get_attribute("data-view"))
            image = button.find_element(By.CSS_SELECTOR, "img")
            self.assertEqual(self.js("[arguments[0].naturalWidth, arguments[0].naturalHeight]", image),
                             [synthetic.WIDTH, synthetic.HEIGHT])
            expected = base64.b64encode((self.out / files[names[-1]]).read_bytes()).decode()
            self.assertEqual(image.get_attribute("src"), "data:image/png;base64," + expected)
            self.assertGreater(image.size["width"], 100)
            self.assertTrue(button.accessible_name)
        return names

    def test_EverySamplerIsInspected(self):
        rows = [r.get_attribute("data-label") for r in self.find_all("#inside .view")]
        self.assertEqual(rows, ["the scene", *synthetic.SAMPLERS])
        self.assertEqual(self.views_in("the scene"), ["brightest", "visibility.12"])
        self.assertEqual(self.views_in("bvh"), ["entropy", "brightest_probability"])
        self.assertIn('measured visibility, LightSource "point" at hotel.pbrt:88',
                      self.find('#inside .view[data-label="the scene"]').text)
        # The sampler has one leaf: the page has words instead of blank pictures.
        self.assertEqual(self.views_in("neepp"), [])
        text = self.find('#inside .view[data-label="neepp"] .flat').text
        self.assertRegex(text, r"^One leaf .*: leaf records 1234; entropy .* bits 1\.50\. .*: excess second moment, log10\.$")
        self.assertEqual(self.views_in("octree"), ["entropy", "brightest_probability", "sampler.leaf", "sampler.found_3",
                                                "sampler.found_4", "sampler.found_5", "sampler.found_6"])
        text = self.find('#inside .view[data-label="octree"]').text
        for part in ("entropy of the probabilities", "3.25", "leaf", "a colour for each"):
            self.assertIn(part, text)
        self.assertIn("2 × 2 pixels", self.find("#inside .note").text)
        self.assertTrue(self.find('nav a[href="#inside"]').is_displayed())

    def test_ViewOpensInTheViewerBesideItsPicture(self):
        self.center(self.find('#inside .view[data-label="octree"] button[data-view="sampler.leaf"]')).click()
        self.expect(left="octree/result", right="octree/sampler.leaf")
        self.assertEqual(self.find("#show-view").get_attribute("aria-pressed"), "true")
        self.assertIn("leaf", self.find("#name-right").text)
        box = self.js("(r => [r.top, r.bottom, innerHeight])(arguments[0].getBoundingClientRect())", self.stage)
        self.assertTrue(box[0] >= -1 and box[1] <= box[2] + 1, "the stage must be in sight")
        # Another sampler has no leaves, so its result is shown.
        self.after("3", right="bvh/result")
        left, right = self.transforms()
        self.assertEqual(left, right)

    def test_LooksChangeByKey(self):
        self.press_code("Digit3", shift=True)
        self.press("2")
        self.after("v", left="bvh/entropy", right="power/entropy")
        self.assertIn("3.25", self.find("#name-right").text)
        self.after("v", left="bvh/brightest_probability", right="power/brightest_probability")
        self.after(Keys.SHIFT, "v", left="bvh/result", right="power/brightest_probability")
        self.after("e", left="bvh/error", right="power/error")
        self.press("v")
        self.after("x", left="power/entropy", right="bvh/entropy")
        self.after("r", right="reference/result")
        self.find("#show-view").click()
        self.assertEqual(self.find("#show-error").get_attribute("aria-pressed"), "false")

    def test_ParametersAreNamesAndValues(self):
        self.find("#details > summary").click()
        details = next(d for d in self.find_all("#details details")
                       if d.find_element(By.CSS_SELECTOR, "summary").text == "octree:leaves=512")
        details.find_element(By.CSS_SELECTOR, "summary").click()
        self.assertEqual([v.text for v in details.find_elements(By.CSS_SELECTOR, ".parameters li")], ["leaves=512"])
        self.assertNotIn("{", details.text)

    def order(self):
        return [r.get_attribute("data-label") for r in self.find_all("#summary tbody tr")]

    def click_heading(self, key):
        self.center(self.find(f'#summary th[data-key="{key}"] button')).click()
        return self.find(f'#summary th[data-key="{key}"]').get_attribute("aria-sort")

    def values(self, value):
        return [s["label"] for s in sorted(self.results["samplers"], key=value)]

    def test_TableSortsByClick(self):
        byError = self.values(lambda s: s["summary"]["metrics"]["relL2"]["mean"])
        self.assertEqual(self.order(), byError)
        self.assertEqual(self.click_heading("relL2"), "descending")
        self.assertEqual(self.order(), byError[::-1])
        self.assertEqual(self.click_heading("label"), "ascending")
        self.assertEqual(self.order(), sorted(byError))
        self.assertEqual(self.find('#summary th[data-key="relL2"]').get_attribute("aria-sort"), "none")
        self.find('#summary th[data-key="MSE"] button').send_keys(Keys.ENTER)
        self.assertEqual(self.find('#summary th[data-key="MSE"]').get_attribute("aria-sort"), "ascending")
        # 6.4 s comes before 17 s, which it would not if sorted as text.
        self.assertEqual(self.click_heading("seconds"), "ascending")
        self.assertEqual(self.order(), self.values(lambda s: s["summary"]["seconds"]))

    def test_MissingNumbersSortLast(self):
        known = {"octree", "octree:leaves=512"}
        for direction in ("ascending", "descending"):
            self.assertEqual(self.click_heading("leaves"), direction)
            self.assertEqual(set(self.order()[:2]), known)

    def test_VerdictsAreMarked(self):
        outcome = self.find(".outcome").text
        for sentence in self.results["conclusion"]["sentences"]:
            self.assertIn(sentence, outcome)
        row = self.find('#summary tr[data-label="neepp"]')
        self.assertIn("biased", row.text)
        self.assertEqual(row.find_elements(By.CSS_SELECTOR, ".win, .best"), [])
        self.assertEqual(len(self.find_all("#summary .win")), 1)

    def test_TextIsReadableInLightAndDark(self):
        papers = []
        for scheme in ("light", "dark"):
            self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                "features": [{"name": "prefers-color-scheme", "value": scheme}]})
            rgb = "getComputedStyle(document.querySelector(arguments[0]))[arguments[1]]"
            paper = self.js(rgb, "body", "backgroundColor")
            papers.append(paper)
            for selector in ("body", ".facts-line", "nav a", ".outcome p", "td .clean", "caption", ".chart svg text"):
                colour = self.js(rgb, selector, "fill" if "svg" in selector else "color")
                self.assertGreater(contrast(colour, paper), 4.5, (scheme, selector, colour, paper))
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        self.assertGreater(luminance(papers[0]), 0.8)
        self.assertLess(luminance(papers[1]), 0.1)

    def test_PointingAtARowLightsItsCurves(self):
        row = self.center(self.find('#summary tr[data-label="octree"] td'))
        ActionChains(self.driver).move_to_element(row).perform()
        lit = self.js("[...document.querySelectorAll('.chart svg .lit')].map((e) => e.id)")
        self.assertIn("c0-line-4", lit)
        self.assertTrue(all(i.endswith("-4") for i in lit), lit)


# A wall that glows dimly, two lamps, and a bright window over the upper seventh of the picture.
ROOM = """LookAt 0 1 -4  0 1 0  0 1 0
Camera "perspective" "float fov" 53.13
Film "rgb" "integer xresolution" 48 "integer yresolution" 48
Sampler "independent" "integer pixelsamples" 4
Integrator "path" "integer maxdepth" 1
WorldBegin
LightSource "point" "point3 from" [ -1 1 -1 ] "rgb I" [ .02 .02 .02 ]
LightSource "point" "point3 from" [ 1 1 -1 ] "rgb I" [ .015 .015 .015 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 40 40 40 ]
Shape "bilinearmesh" "point3 P" [ 3 2.4 0  -3 2.4 0  3 4 0  -3 4 0 ]
AttributeEnd
AreaLightSource "diffuse" "rgb L" [ .01 .01 .01 ]
Shape "bilinearmesh" "point3 P" [ 3 -3 .01  -3 -3 .01  3 4 .01  -3 4 .01 ]
"""


@unittest.skipUnless(os.environ.get("LIGHTLAB"), "LIGHTLAB does not name the program")
class Program(InBrowser):
    """Tests the page of a real run."""

    def test_ReportShowsTheRoomAndNotItsWindow(self):
        (self.folder / "room.pbrt").write_text(ROOM)
        environment = {**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache"),
                       "LIGHTLAB_REPORT_SCRIPTS": str(SCRIPTS)}
        done = subprocess.run([os.environ["LIGHTLAB"], "room.pbrt", "--samplers", "uniform,power", "--spp", "4", "--seeds",
                               "2", "--reference-spp", "64", "--out", "out"], cwd=self.folder, env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.driver.get((self.folder / "out/report.html").as_uri())
        self.assertEqual([e for e in self.driver.get_log("browser") if e["level"] in ("SEVERE", "WARNING")], [])
        canvas = '#layer-left canvas.shown'
        WebDriverWait(self.driver, 10).until(
            lambda d: d.execute_script("return document.querySelector(arguments[0])?.dataset.painted", canvas) == "0")
        at = "return document.querySelector(arguments[0]).getContext('2d').getImageData(24, arguments[1], 1, 1).data[1]"
        window, wall = (self.driver.execute_script(at, canvas, y) for y in (4, 30))
        self.assertEqual(window, 255)
        self.assertGreater(wall, 60)
        self.assertLess(wall, 230)


def encoded(v):
    v = min(1, v)
    return math.floor(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055) + 0.5)


def luminance(colour):
    parts = [float(v) / 255 for v in colour[colour.index("(") + 1:-1].split(",")[:3]]
    r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


if __name__ == "__main__":
    unittest.main()
