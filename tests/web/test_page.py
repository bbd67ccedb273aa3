#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""test_page.py PAGE ANAMORPH SHOTS

The page in headless Chromium, opened as a file: what it draws has the hash that the program prints of the source that it saves and the
recipe that it says; keyboard, wheel, drag and touch look around; a picture may be dropped; what is wrong is said; nothing is fetched. SHOTS
gets pictures of it in both colour schemes and on a phone, to be looked at.
"""
import base64
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

PAGE, ANAMORPH, SHOTS = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
SAMPLE = "sample=512"  # a panorama of 1024 x 512 is made quickly


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1440,1300"):
            options.add_argument(argument)
        cls.folder = tempfile.TemporaryDirectory()
        options.add_experimental_option("prefs", {"download.default_directory": cls.folder.name})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        cls.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        cls.driver.set_script_timeout(120)
        SHOTS.mkdir(parents=True, exist_ok=True)

    @classmethod
    def tearDownClass(cls):
        cls.driver.quit()
        cls.folder.cleanup()

    def setUp(self):
        self.driver.get(f"{PAGE.as_uri()}?{SAMPLE}&workers=2")
        self.hash()

    def get(self, name):
        return self.driver.find_element("id", name)

    def text(self, name):
        return self.driver.execute_script("return document.getElementById(arguments[0]).textContent", name)

    def set(self, name, value, event="change"):
        self.driver.execute_script("const e = document.getElementById(arguments[0]); e.value = arguments[1];"
                                   "e.dispatchEvent(new Event(arguments[2]))", name, value, event)

    def hash(self):
        """The hash of the picture once it stands still."""
        def found(_):
            shown = re.fullmatch("[0-9a-f]{32}", self.text("hash"))
            return shown and self.driver.execute_script("return document.getElementById('busy').hidden") and shown.group()
        return WebDriverWait(self.driver, 120, 0.2).until(found)

    def saved_source(self):
        """The source as the page saves it: a PNG that the page's own code makes."""
        text = self.driver.execute_async_script("""
            const done = arguments[arguments.length - 1];
            sourcePng().then(async (blob) => {
              const bytes = new Uint8Array(await blob.arrayBuffer());
              let text = "";
              for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
              done(btoa(text));
            });""")
        return base64.b64decode(text)

    def expect_of_desktop(self, folder):
        """Runs the command that the page says, beside what it saves."""
        command = re.fullmatch(r'anamorph hash "(.*)"', self.text("command")).group(1)
        (folder / command.split(".")[0]).with_suffix(".png").write_bytes(self.saved_source())
        (folder / "mesh.json").write_text(self.driver.execute_script("return meshText()"), encoding="utf-8")
        shown = self.hash()
        printed = subprocess.run([ANAMORPH, "hash", command], cwd=folder, check=True, stdout=subprocess.PIPE, text=True).stdout[:32]
        self.assertEqual(shown, printed, command)
        self.set("desktop", printed, "input")
        self.assertIn("The same bits", self.text("verdict"))
        self.set("desktop", "0" * 32, "input")
        self.assertIn("Another picture", self.text("verdict"))
        self.set("desktop", "", "input")

    def test_the_desktop_program_prints_the_same_hash(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            self.expect_of_desktop(folder)
            self.set("filter", "bilinear")
            for to in ("fisheye", "cylindrical", "mercator"):
                self.set("to", to)
                self.expect_of_desktop(folder)
            self.set("tol", "0")
            self.expect_of_desktop(folder)
            self.set("tol", "0.01")
            for mode in ("lens", "warp", "map"):
                self.driver.execute_script("document.querySelector(`input[value=${arguments[0]}]`).click()", mode)
                self.expect_of_desktop(folder)

    def test_every_projection_is_drawn(self):
        names = self.driver.execute_script("return [...document.getElementById('to').options].map((o) => o.value)")
        self.assertGreater(len(names), 15)
        self.set("size", "640x360")
        for name in names:
            before = self.hash()
            self.set("to", name)
            if name != names[0]:
                WebDriverWait(self.driver, 120, 0.2).until(lambda _: self.text("problem") or self.hash() != before)
            self.assertFalse(self.get("problem").is_displayed(), name + ": " + self.text("problem"))

    def test_the_error_is_at_most_the_tolerance(self):
        for tol in ("0.001", "0.01", "0.1", "1"):
            self.set("tol", tol)
            self.hash()
            self.assertLessEqual(float(self.text("error")), float(tol))
            self.assertGreater(float(self.text("error")), 0)

    def test_keys_look_around(self):
        view = self.get("view")
        before = self.hash()
        view.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_UP, "+")
        self.assertNotEqual(self.hash(), before)
        self.assertEqual([self.get(i).get_attribute("value") for i in ("yaw", "pitch")], ["6", "6"])
        self.assertEqual(self.get("fov").get_attribute("value"), "81")
        self.assertIn("6 degrees right", view.get_attribute("aria-label"))
        view.send_keys("-", Keys.HOME)
        self.assertEqual(self.get("yaw").get_attribute("value"), "0")

    def test_drag_wheel_and_pinch_look_around(self):
        view = self.get("view")
        ActionChains(self.driver).drag_and_drop_by_offset(view, -100, 50).perform()
        self.assertGreater(float(self.get("yaw").get_attribute("value")), 5)
        self.assertGreater(float(self.get("pitch").get_attribute("value")), 2)
        fov = float(self.get("fov").get_attribute("value"))
        self.driver.execute_script("arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -100, cancelable: true}))", view)
        closer = float(self.get("fov").get_attribute("value"))
        self.assertLess(closer, fov)
        box = view.rect
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        for kind, apart in (("touchStart", 40), ("touchMove", 60), ("touchMove", 120), ("touchEnd", None)):
            points = [] if apart is None else [{"x": x + s * apart, "y": y, "id": i} for i, s in enumerate((-1, 1))]
            self.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        self.assertLess(float(self.get("fov").get_attribute("value")), 0.8 * closer)

    def test_all_controls_have_names_and_are_reached_by_tab(self):
        nodes = self.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
        roles = {"button", "combobox", "slider", "textbox", "radio", "checkbox", "spinbutton", "application"}
        found = [n for n in nodes if not n.get("ignored") and n["role"]["value"] in roles]
        self.assertGreater(len(found), 20)
        for node in found:
            self.assertTrue(node.get("name", {}).get("value"), node["role"])
        reached = set()
        for _ in range(60):
            ActionChains(self.driver).send_keys(Keys.TAB).perform()
            reached.add(self.driver.execute_script("return document.activeElement.id"))
        self.assertLessEqual({"view", "desktop", "choose", "preset", "to", "fov", "yaw", "tol", "measure"}, reached)
        self.assertEqual(self.get("said").get_attribute("aria-live"), "polite")
        self.assertIn("Hash " + self.text("hash"), self.text("said"))

    def test_a_picture_is_taken(self):
        with tempfile.TemporaryDirectory() as name:
            file = pathlib.Path(name) / "dropped.png"
            file.write_bytes(self.saved_source())
            before = self.hash()
            self.get("file").send_keys(str(file))
            WebDriverWait(self.driver, 60).until(lambda _: "dropped.png" in self.text("source-name"))
            self.assertEqual(self.hash(), before, "pixels come through a canvas as they are")
            self.assertIn("dropped.png.pano", self.text("command"))
            bad = pathlib.Path(name) / "bad.png"
            bad.write_bytes(b"no picture")
            self.get("file").send_keys(str(bad))
            WebDriverWait(self.driver, 60).until(lambda _: "bad.png" in self.text("problem"))

    def test_what_is_wrong_is_said(self):
        self.set("view-lens", "ptlens:q=1")
        WebDriverWait(self.driver, 60).until(lambda _: "lens" in self.text("problem"))
        self.assertTrue(self.get("problem").is_displayed())
        self.assertEqual(self.text("hash"), "–")
        self.set("view-lens", "")
        self.hash()
        self.assertFalse(self.get("problem").is_displayed())

    def test_nothing_is_fetched(self):
        self.driver.get_log("performance")
        self.set("to", "fisheye")
        self.hash()
        sent = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        urls = [m["params"]["request"]["url"] for m in sent if m["method"] == "Network.requestWillBeSent"]
        self.assertEqual([u for u in urls if not u.startswith(("blob:", "data:", "file:"))], [])
        self.assertEqual([e for e in self.driver.get_log("browser") if e["level"] == "SEVERE"], [])

    def test_views_of_the_list_are_the_desktops(self):
        self.assertIn("not in the page’s list", self.text("verdict"))  # of this small panorama
        self.driver.get(PAGE.as_uri())
        self.hash()
        self.assertIn("The same bits as the desktop program, which prints", self.text("verdict"))
        self.set("yaw", "1", "input")
        self.hash()
        self.assertIn("not in the page’s list", self.text("verdict"))

    def test_pictures_to_look_at(self):
        self.driver.get(PAGE.as_uri())
        self.hash()
        for name, scheme, width, height, mobile in (("light", "light", 1440, 1300, False), ("dark", "dark", 1440, 1300, False),
                                                    ("phone", "light", 390, 844, True), ("phone_dark", "dark", 390, 844, True)):
            self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                        {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile})
            self.assertLessEqual(self.driver.execute_script("return document.documentElement.scrollWidth"), width, name)
            shot = self.driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
            (SHOTS / f"{name}.png").write_bytes(base64.b64decode(shot["data"]))
        self.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def test_speed_is_measured(self):
        self.driver.get(f"{PAGE.as_uri()}")
        self.hash()
        measured = self.driver.execute_async_script(
            "const done = arguments[arguments.length - 1]; measure(60).then(() => measure(60)).then(done)")
        print(f"1280 x 720 of 4096 x 2048: {measured['rate']:.1f} views a second, half of them in {measured['median']:.1f} ms")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
