# SPDX-License-Identifier: Apache-2.0
"""A display in memory for a program that draws."""
import os
import subprocess


def xvfb_run(number):
    """What to put before the program. Each use has a number of its own, so that two that start at once do not meet. Without
    -noreset the server restarts when a program closes its first connection, and refuses the next one meanwhile."""
    return ["xvfb-run", "-a", "-n", str(number), "-s", "-screen 0 1280x1024x24 -noreset"]


def run_shown(number, *command, timeout=200):
    """What a program prints that draws on the display of that number, without a graphics card, and ends well."""
    done = subprocess.run([*xvfb_run(number), *command], env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}, capture_output=True,
                          text=True, timeout=timeout)
    assert done.returncode == 0, (done.returncode, done.stdout[-3000:], done.stderr[-5000:])
    return done
