"""Chromium without a window, for tests of pages. Importing this ends the test as skipped, loudly, where it is missing."""
import pathlib
import shutil
import sys


def skip(what):
    print(f"SKIPPED: {pathlib.Path(sys.argv[0]).name} tested no page in a browser: {what} is missing "
          "(Debian: chromium chromium-driver python3-selenium)")
    sys.exit(77)


try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    skip("python3-selenium")
BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
if not BROWSER or not DRIVER:
    skip("chromium" if not BROWSER else "chromedriver")


def start(profile, size, logs):
    """A browser whose profile is this folder; `size`: "width,height" of the window; `logs`: kinds that are kept."""
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     f"--window-size={size}", f"--user-data-dir={profile}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {kind: "ALL" for kind in logs})
    return webdriver.Chrome(service=Service(DRIVER), options=options)
