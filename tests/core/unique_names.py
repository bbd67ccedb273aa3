#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""unique_names.py SOURCE_DIR

Every class has a name of its own. Two classes of one name in one namespace compile where no file sees both, and then share
what the compiler writes for them: destructors, for one. What is in an unnamed namespace is a file's own.
"""
import collections
import pathlib
import re
import sys

FOLDERS = ("core", "oiio_ops", "plugins", "vtk_filters", "tests/core", "tests/oiio", "tests/vtk", "tests/bench")
NAMESPACE = re.compile(r"(?:inline )?namespace(?: ([\w:]+))? \{")
END_OF_NAMESPACE = re.compile(r"\}.*// namespace")
# At the beginning of a line, and not in a class: `class Name::Impl` is its class's, `struct Name<int>` a template's.
CLASS = re.compile(r"(?:template <.*> )?(?:class|struct|union|enum class|enum) (?:[A-Z_]+_EXPORT )?(\w+)\b(?![:<])[^;]*\{")


def classes(text):
    """The full names of the classes that a file defines for others to see."""
    found = set()
    namespaces = []
    for line in text.splitlines():
        opened = NAMESPACE.match(line)
        if opened:
            namespaces.append(opened.group(1) or "")
        elif END_OF_NAMESPACE.match(line) and namespaces:
            namespaces.pop()
        elif "" not in namespaces:
            named = CLASS.match(line)
            if named:
                found.add("::".join([*namespaces, named.group(1)]))
    return found


def main():
    defined_in = collections.defaultdict(list)
    for folder in FOLDERS:
        for path in sorted((pathlib.Path(sys.argv[1]) / folder).rglob("*")):
            if path.suffix in (".h", ".cpp", ".cxx"):
                for name in classes(path.read_text()):
                    defined_in[name].append(str(path))
    if len(defined_in) < 300:
        sys.exit(f"{len(defined_in)} classes were found: the search is wrong")
    twice = {name: files for name, files in defined_in.items() if len(files) > 1}
    for name, files in sorted(twice.items()):
        print(f"{name} is defined in {' and in '.join(files)}")
    sys.exit(1 if twice else 0)


if __name__ == "__main__":
    main()
