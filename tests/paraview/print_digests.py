# SPDX-License-Identifier: Apache-2.0
"""Usage: print_digests.py FOLDER. Makes the surfaces of surfaces.py where it runs, and prints what they are."""
import sys

import surfaces

for name, (points, digest) in sorted(surfaces.digests(sys.argv[1]).items()):
    print("digest", name, points, digest)
print("pieces", surfaces.number_of_pieces())
