# SPDX-License-Identifier: Apache-2.0
"""A display in memory for a program that draws."""


def xvfb_run(number):
    """What to put before the program. Each use has a number of its own, so that two that start at once do not meet. Without
    -noreset the server restarts when a program closes its first connection, and refuses the next one meanwhile."""
    return ["xvfb-run", "-a", "-n", str(number), "-s", "-screen 0 1280x1024x24 -noreset"]
