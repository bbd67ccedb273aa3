# SPDX-License-Identifier: Apache-2.0
"""The Debian packages of a build, made and unpacked for a test."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

BUILD = os.environ["ANAMORPH_BUILD_DIR"]


def output(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=200, **more)
    if done.returncode:
        raise AssertionError(f"{command} failed ({done.returncode}):\n{done.stdout}\n{done.stderr}")
    return done.stdout


def make():
    """The folder in which they are unpacked, as /, and the packages by their names. It is gone with the module that asks."""
    folder = tempfile.TemporaryDirectory(prefix="anamorph-packages-")
    unittest.addModuleCleanup(folder.cleanup)
    made, root = pathlib.Path(folder.name) / "made", pathlib.Path(folder.name) / "root"
    output(os.environ["ANAMORPH_CPACK"], "--config", f"{BUILD}/CPackConfig.cmake", "-B", made, "-D",
           "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", umask=0o022)
    debs = {output("dpkg-deb", "-f", deb, "Package").strip(): deb for deb in sorted(made.glob("*.deb"))}
    for deb in debs.values():
        output("dpkg-deb", "-x", deb, root)
    return root, debs


def check_by_lintian(test, debs):
    if not shutil.which("lintian"):
        test.skipTest("lintian is not there")
    more = ["--allow-root"] if os.getuid() == 0 else []
    test.assertNotRegex(output("lintian", "--fail-on", "none", *more, *debs), r"(?m)^E:")


def field(deb, name):
    return output("dpkg-deb", "-f", deb, name).strip()
