# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site: that every page is in it, one click from every other, that links lead somewhere, and that it is searched from a disk;
and, with the pictures that its lines draw (the nightly class Drawn), that these are pictures of what they stand beside."""
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

import blocks

SOURCES = pathlib.Path(os.environ["ANAMORPH_SOURCE_DIR"])
sys.path.insert(0, str(SOURCES / "docs/site"))
import make_site  # noqa: E402


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.site = pathlib.Path(folder.name, "site")
        cls.page = pathlib.Path(folder.name, "page.html")
        cls.page.write_text("<!doctype html><title>draws</title>", encoding="utf-8")
        make_site.make_site(SOURCES, cls.site, page=cls.page)
        cls.html = [page.replace("README.md", "index.md").replace(".md", ".html") for page in make_site.pages()]

    def test_the_first_page_is_short(self):
        self.assertLess(len((SOURCES / "README.md").read_text(encoding="utf-8").splitlines()), 150)

    def test_every_page_is_in_it(self):
        self.assertEqual(sorted(make_site.pages()), sorted(str(path.relative_to(SOURCES)) for path in blocks.documents()))
        for page in self.html:
            self.assertTrue((self.site / page).exists(), page)

    def test_the_page_that_draws_is_in_it(self):
        self.assertEqual((self.site / "docs/anamorph.html").read_bytes(), self.page.read_bytes())
        self.assertIn("anamorph.html", make_site.read_links(self.site / "docs/web.html").links)

    def test_every_page_leads_to_every_other(self):
        for page in self.html:
            links = {(self.site / page).parent.joinpath(link.split("#")[0]).resolve() for link in make_site.read_links(self.site / page).links}
            for other in self.html:
                self.assertTrue(page == other or (self.site / other).resolve() in links, (page, other))

    def test_links_that_lead_nowhere_are_found(self):
        self.assertEqual(make_site.broken_links(self.site), [])
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "a.html")
            page.write_text('<a href="a.html#here">x</a><a href="#there">x</a><img src="b.png"><p id="here"><a href="https://x.invalid/">x</a>')
            self.assertEqual(make_site.broken_links(pathlib.Path(folder)), [("a.html", "#there"), ("a.html", "b.png")])

    def test_nothing_is_fetched_from_elsewhere(self):
        for page in self.html:
            text = (self.site / page).read_text(encoding="utf-8")
            for tag in ("script", "link", "img"):
                self.assertNotRegex(text, rf'<{tag} [^>]*(src|href)="(https?:)?//(?!example)', page)

    def test_what_is_searched_has_all_pages(self):
        found = json.loads((self.site / "search/search_index.json").read_text(encoding="utf-8"))["docs"]
        self.assertEqual(set(self.html) - {entry["location"].split("#")[0] for entry in found}, set())
        self.assertIn("docs/pano.html", {entry["location"].split("#")[0] for entry in found if "octahedral" in entry["text"]})

    def test_a_browser_searches_it_from_a_disk(self):
        if not importlib.util.find_spec("selenium") or subprocess.run(["which", "chromium", "chromedriver"], capture_output=True).returncode:
            self.skipTest("chromium or selenium is not there")
        from selenium import webdriver
        from selenium.webdriver.common.by import By

        options = webdriver.ChromeOptions()
        for option in ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
            options.add_argument(option)
        browser = webdriver.Chrome(options=options)
        self.addCleanup(browser.quit)
        browser.get((self.site / "index.html").as_uri())
        browser.execute_script("document.querySelector('#__search').click()")
        time.sleep(1)
        browser.find_element(By.CSS_SELECTOR, "input.md-search__input").send_keys("octahedral")
        links = []
        for _ in range(60):
            links = browser.execute_script("return Array.from(document.querySelectorAll('a.md-search-result__link'), link => link.href)")
            if any("docs/pano.html" in link for link in links):
                break
            time.sleep(0.5)
        self.assertTrue(any("docs/pano.html" in link for link in links), links)


class Drawn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.drawn, cls.site = pathlib.Path(folder.name, "drawn"), pathlib.Path(folder.name, "site")
        cls.drawn.mkdir()
        for script in ("draw", "reference"):
            subprocess.run([sys.executable, SOURCES / f"docs/site/{script}.py", SOURCES, os.environ["ANAMORPH_BUILD_DIR"], cls.drawn], check=True)
        make_site.make_site(SOURCES, cls.site, cls.drawn)

    def pictures_of(self, page):
        return [(self.site / page).parent / link for link in make_site.read_links(self.site / page).links if link.endswith((".png", ".jpg"))]

    def test_the_gallery_has_forty_pictures_and_all_differ(self):
        pictures = [picture for picture in self.pictures_of("docs/gallery.html") if "drawn" in picture.parts]
        self.assertGreaterEqual(len(pictures), 40)
        self.assertGreaterEqual(len({picture.read_bytes() for picture in pictures}), 0.9 * len(pictures))

    def test_a_line_has_its_picture_below_it(self):
        text = (self.site / "docs/drape.html").read_text(encoding="utf-8")
        line, next_words = text.index("flag.%02d.jpg"), text.index("The same tolerance holds")
        for name in ("saddle", "moebius", "flag"):
            self.assertRegex(text[line:next_words], rf"drawn/\d+-{name}\.*png")

    def test_the_reference_shows_every_word(self):
        text = (self.site / "docs/reference.html").read_text(encoding="utf-8")
        for word in ("pano", "octahedral", "mei", "sharp_bicubic", "summed_area", "page_turn", "3de4", "ocam", "embm-2003", "quadratic", "drag"):
            self.assertIn(word, text)
        # Each word of these keys has a picture of its own.
        shown = {"pano": ["to", "filter"], "map": ["wrap"], "warp": ["output"], "morph": ["output"], "drape": ["filter", "surface", "shading", "output"],
                 "figure": ["style", "lighting", "solid", "mapping", "filter", "outlines"]}
        for operation, keys in shown.items():
            page = (SOURCES / f"docs/{operation}.md").read_text(encoding="utf-8")
            for key in keys:
                words = re.search(rf"^\| `{key}` \|[^|]*\|[^|]*\| ([^|]*) \|", page, re.M)[1].split(", ")
                self.assertGreater(len(words), 1)
                for word in words:
                    self.assertIn(f"words/{operation}_{key}_{word}.png", text)
        pictures = self.pictures_of("docs/reference.html")
        self.assertGreater(len(pictures), 150)
        one_color = []
        for picture in pictures:
            stats = subprocess.run(["oiiotool", "--stats", picture], capture_output=True, text=True, check=True).stdout
            if "Constant: Yes" in stats:
                one_color.append(picture.name)
        self.assertEqual(one_color, [])

    def test_links_lead_somewhere(self):
        self.assertEqual(make_site.broken_links(self.site), [])


if __name__ == "__main__":
    unittest.main()
