# SPDX-License-Identifier: Apache-2.0
"""What libraries show to others: symbols.py LIBRARY...

Plugins and modules keep the core that they have in them to themselves: two of one process may be of two versions. The shared library, which
is called libanamorph.so, shows the core and nothing that others may have, too.
"""
import pathlib
import re
import subprocess
import sys


def shown(library):
    """The symbols that others can link, as compilers name them."""
    lines = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    return [line.split()[2] for line in lines.splitlines()]


def main():
    wrong = []
    for library in sys.argv[1:]:
        names = shown(library)
        of_core = [name for name in names if re.match(r"_Z(T.|T[hv][n\d_]*_)?NK?8anamorph", name)]
        if pathlib.Path(library).name.startswith("libanamorph.so"):
            wrong += [(library, name) for name in names if name not in of_core or re.search(r"8anamorph4simd\d+N_", name)]
            if not any(name.startswith("_ZN8anamorph5ChartC1E") for name in names):
                wrong.append((library, "no constructor of anamorph::Chart"))
        else:
            wrong += [(library, name) for name in of_core]
        print(f"{library}: {len(names)} symbols, {len(of_core)} of the core")
    for library, name in wrong[:40]:
        print(f"{library}: {name}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
