# SPDX-License-Identifier: Apache-2.0
"""Files that are there in full or not at all."""
import contextlib
import os


@contextlib.contextmanager
def whole_file(path):
    """A name beside `path`, with its ending, to write under; it becomes `path` when all went well."""
    path = os.path.realpath(path)
    if os.path.exists(path) and not os.path.isfile(path):  # a device
        yield path
        return
    beside = os.path.join(os.path.dirname(path), ".part%d.%s" % (os.getpid(), os.path.basename(path)))
    try:
        yield beside
        os.replace(beside, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.remove(beside)
