#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site that is read and searched without a network: make_site.py SOURCES FOLDER [--drawn DRAWN] [--page PAGE]

Copies the pages of SOURCES, and what these show or link to, beside FOLDER, and has MkDocs make the site FOLDER of them, with Material
(Debian: mkdocs, mkdocs-material). With DRAWN, which draw.py and reference.py made, lines that draw a picture have it below them, the gallery has
those of all pages, and there is a reference with pictures. Carries the PAGE that draws (docs/web.md), where that was built. Fails where a link
leads nowhere.
"""
import argparse
import html
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

# Every page is in the navigation: two clicks from any other.
PAGES = {
    "Start": ["README.md", "docs/start.md", "docs/gallery.md", "docs/install.md", "docs/command.md"],
    "Pictures": ["docs/recipes.md", "docs/pano.md", "docs/lens.md", "docs/map.md", "docs/warp.md", "docs/morph.md", "docs/mosaic.md", "docs/drape.md", "docs/figure.md"],
    "Figures": ["docs/figures.md", "examples/figures/README.md"],
    "Programs": ["docs/python.md", "docs/vtk.md", "plugins/paraview/README.md", "docs/cpp.md", "docs/hash.md", "docs/web.md"],
    "How it works": ["docs/conventions.md", "docs/proofs.md", "docs/architecture.md", "docs/machines.md", "docs/speed.md", "docs/literature.md", "tests/bench/costs.md"],
    "Working on it": ["docs/building.md", "CONTRIBUTING.md", "CHANGELOG.md"],
}
LINK = re.compile(r"\]\(([^)\s]+)\)")
# A worker and an index that a page from a disk may not load are handed to it as texts.
OFFLINE = """(function () {
    if (location.protocol !== "file:") return;
    window.__search = { index: Promise.resolve(%s) };
    var ByNetwork = window.Worker, text = %s;
    window.Worker = function (url) {
        return new ByNetwork(/workers\\/search/.test(url) ? URL.createObjectURL(new Blob([text], { type: "text/javascript" })) : url);
    };
})();
"""


def pages():
    return [page for section in PAGES.values() for page in section]


def extra_pages(section, staged):
    return ["docs/reference.md"] if section == "Pictures" and (staged / "docs/reference.md").exists() else []


def title_of(path):
    return re.search(r"^# (.+)$", path.read_text(encoding="utf-8"), re.M)[1].replace("`", "")


def copy(sources, staged):
    """Copies the pages and the files that they name, at the places that they have in the tree."""
    for page in pages():
        target = staged / page
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(sources / page, target)
        for link in LINK.findall(target.read_text(encoding="utf-8")):
            file = (sources / page).parent / urllib.parse.unquote(link.split("#")[0])
            if "://" in link or not link.split("#")[0] or not file.exists() or file.suffix == ".md":
                continue
            place = staged / file.resolve().relative_to(sources.resolve())
            place.parent.mkdir(parents=True, exist_ok=True)
            if file.is_dir():
                shutil.copytree(file, place, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.md"))
                (place / "index.html").write_text(listing(file, sources), encoding="utf-8")
            else:
                shutil.copyfile(file, place)


def listing(folder, sources):
    """A folder that a page links to, as a page."""
    names = sorted(child.name for child in folder.iterdir() if child.is_file())
    return (f"<!doctype html><meta charset=utf-8><title>{folder.relative_to(sources)}</title><ul>"
            + "".join(f'<li><a href="{name}">{name}</a>' for name in names) + "</ul>")


def figure(picture, caption=""):
    if caption:
        caption = f"<figcaption>{caption}</figcaption>"
    return f'<figure style="display:inline-block;vertical-align:top;margin:0 1em 1em 0;max-width:20em"><img src="{picture}" alt="" loading="lazy">{caption}</figure>'


def show_drawn(staged, drawn):
    """Puts what lines have drawn below their blocks, where a page does not show it already, and all of it into the gallery."""
    shutil.copytree(drawn / "shown", staged / "drawn")
    of_page, gallery = {}, ["", "## Of the other pages", ""]
    for page, line, text, name in json.loads((drawn / "pictures.json").read_text(encoding="utf-8")):
        up = "../" * page.count("/")
        of_page.setdefault(page, {}).setdefault(line, []).append(figure(f"{up}drawn/{name}"))
        if page != "docs/gallery.md":
            title = html.escape(title_of(staged / page))
            link = os.path.relpath(page.replace("README.md", "index.md"), "docs").replace(".md", ".html")
            gallery.append(figure(f"../drawn/{name}", f'<code>{html.escape(text)}</code><br><a href="{link}">{title}</a>'))
    for page, blocks in of_page.items():
        path = staged / page
        lines = path.read_text(encoding="utf-8").split("\n")
        for first in sorted(blocks, reverse=True):
            end = first - 1
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            if end == len(lines) or not lines[end].startswith("!["):
                lines[end:end] = ["", *blocks[first], ""]
        path.write_text("\n".join(lines), encoding="utf-8")
    with (staged / "docs/gallery.md").open("a", encoding="utf-8") as file:
        file.write("\n".join(gallery) + "\n")


def carry(page, staged):
    """The page that draws, as docs/anamorph.html, and a link to it below the title of docs/web.md."""
    shutil.copyfile(page, staged / "docs/anamorph.html")
    document = staged / "docs/web.md"
    text = document.read_text(encoding="utf-8")
    title = re.search(r"^# .+$", text, re.M)[0]
    document.write_text(text.replace(title, f"{title}\n\n**[Open the page](anamorph.html)**", 1), encoding="utf-8")


def configuration(staged, folder):
    return {
        "site_name": "Anamorph", "docs_dir": str(staged), "site_dir": str(folder), "use_directory_urls": False,
        "theme": {"name": "material", "font": False, "features": ["navigation.tabs", "navigation.sections", "search.highlight"],
                  "palette": {"primary": "indigo"}},
        "nav": [{section: [{title_of(staged / page): page} for page in pages + extra_pages(section, staged)]} for section, pages in PAGES.items()],
        "markdown_extensions": ["tables", "fenced_code", {"toc": {"permalink": True, "slugify": None}}],
        "plugins": ["search"], "strict": True, "extra_javascript": ["offline.js"],
    }


def slug(text, separator):
    """The name of a heading's anchor, as GitHub has it, which the links of the pages are written for."""
    return re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", separator)


class Links(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.anchors = [], set()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors |= {attributes[name] for name in ("id", "name") if attributes.get(name)}
        for name in ("href", "src"):
            if attributes.get(name) and tag in ("a", "img", "script", "link"):
                self.links.append(attributes[name])


def read_links(file):
    parser = Links()
    parser.feed(file.read_text(encoding="utf-8"))
    return parser


def broken_links(folder):
    """[(page, link)] of links that lead to no file or to no place in it."""
    known = {file: read_links(file) for file in folder.rglob("*.html")}
    broken = []
    for page, parsed in known.items():
        for link in parsed.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            file = (page.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else page.resolve()
            if file.is_dir():
                file = file / "index.html"
            if page.name == "404.html" or (file.exists() and (not parts.fragment or file not in known or parts.fragment in known[file].anchors
                                                                or parts.fragment.startswith("__"))):
                continue
            broken.append((str(page.relative_to(folder)), link))
    return broken


def make_site(sources, folder, drawn=None, page=None):
    staged = folder.with_name(folder.name + "-pages")
    shutil.rmtree(staged, ignore_errors=True)
    copy(sources, staged)
    if drawn:
        show_drawn(staged, drawn)
        shutil.copytree(drawn / "words", staged / "words")
        shutil.copyfile(drawn / "reference.md", staged / "docs/reference.md")
    if page and page.exists():
        carry(page, staged)
    (staged / "offline.js").write_text("", encoding="utf-8")
    config = folder.with_name(folder.name + ".yml")
    # JSON is YAML, but for the function that names anchors.
    text = json.dumps(configuration(staged.resolve(), folder.resolve()), indent=1)
    config.write_text(text.replace('"slugify": null', '"slugify": !!python/name:make_site.slug'), encoding="utf-8")
    environment_path = str(pathlib.Path(__file__).resolve().parent)
    done = subprocess.run(["/usr/bin/python3", "-m", "mkdocs", "build", "--clean", "-q", "-f", str(config)], capture_output=True, text=True,
                          env={"PATH": "/usr/bin:/bin", "PYTHONPATH": environment_path, "PYTHONDONTWRITEBYTECODE": "1", "LC_ALL": "C.UTF-8"})
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    index = (folder / "search/search_index.json").read_text(encoding="utf-8")
    worker = next(folder.glob("assets/javascripts/workers/search.*.js")).read_text(encoding="utf-8")
    (folder / "offline.js").write_text(OFFLINE % (index, json.dumps(worker).replace("</", "<\\/")), encoding="utf-8")
    # Before Material's own, which starts with the page.
    for file in folder.rglob("*.html"):
        text = file.read_text(encoding="utf-8")
        script = re.search(r'<script src="([^"]*)offline\.js"></script>', text)
        if script:
            text = text.replace(script[0], "", 1).replace("</head>", script[0] + "</head>", 1)
            file.write_text(text, encoding="utf-8")
    broken = broken_links(folder)
    if broken:
        sys.exit("\n".join(f"{page}: {link} leads nowhere" for page, link in broken))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("sources", "folder", "--drawn", "--page"):
        parser.add_argument(name, type=pathlib.Path)
    make_site(**vars(parser.parse_args()))
