#!/usr/bin/python3
"""Makes the picture of docs/guide/live-view.md: python3 docs/guide/live-view/screenshot.py PBRT OUT.png (needs chromium-driver and
python3-selenium)."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

PBRT, OUT = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
SCENE = pathlib.Path(__file__).resolve().parents[3] / "scenes/three-lights/three-lights.pbrt"

with tempfile.TemporaryDirectory() as folder:
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=900,840",
                     f"--user-data-dir={folder}/profile"):
        options.add_argument(argument)
    driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    render = subprocess.Popen([PBRT, "--serve=0", "--lightsampler", "octree", "--spp", "64", "--outfile", "three-lights.exr",
                               str(SCENE)], cwd=folder, stderr=subprocess.PIPE, text=True)
    try:
        address = next(found[1] for line in render.stderr if (found := re.match(r"Live page: (\S+)", line)))
        driver.get(address)
        while driver.execute_script("return status && status.phase === 'rendering' ? status.fraction : 0") < 0.4:
            time.sleep(0.2)
        time.sleep(2)
        driver.save_screenshot(OUT)
    finally:
        driver.quit()
        render.kill()
        render.wait()
