#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""pack.py SOURCE_DIR GLUE_JS WASM OUTPUT

One file of the page: style, scripts, emscripten's glue, the core compressed, and the hashes that the desktop program has for its views.
"""
import base64
import lzma
import pathlib
import sys

# What the core may have on its way to a browser.
MOST_BYTES = 500_000
# As lzma.js reads them: instructions of WebAssembly stand at any byte, and say much of the next.
FILTERS = [{"id": lzma.FILTER_LZMA1, "preset": 9 | lzma.PRESET_EXTREME, "lc": 4, "lp": 0, "pb": 0}]


def main():
    source, glue, wasm, output = map(pathlib.Path, sys.argv[1:])
    packed = lzma.compress(wasm.read_bytes(), format=lzma.FORMAT_ALONE, filters=FILTERS)
    if len(packed) > MOST_BYTES:
        sys.exit(f"pack.py: {wasm} has {len(packed)} bytes compressed: must be at most {MOST_BYTES}")
    parts = {
        "style": (source / "style.css").read_text(encoding="utf-8"),
        "known": (source / "hashes.txt").read_text(encoding="utf-8"),
        "wasm": base64.b64encode(packed).decode(),
        "bytes": str(wasm.stat().st_size),
        "lzma": (source / "lzma.js").read_text(encoding="utf-8"),
        "worker": glue.read_text(encoding="utf-8") + (source / "worker.js").read_text(encoding="utf-8"),
        "page": (source / "page.js").read_text(encoding="utf-8"),
    }
    page = (source / "index.html").read_text(encoding="utf-8")
    for name, text in parts.items():
        if "</script" in text:
            sys.exit(f"pack.py: {name} ends its own script")
        page = page.replace(f"@{name}@", text)
    output.write_text(page, encoding="utf-8")
    print(f"{output}: {len(page.encode())} bytes, the core {len(packed)} of {wasm.stat().st_size}")


if __name__ == "__main__":
    main()
