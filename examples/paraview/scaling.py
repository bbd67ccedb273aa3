# SPDX-License-Identifier: Apache-2.0
"""Strong scaling: how long a whole surface takes to be deformed by 1, 2, ... ranks that share it.

Usage, with the plugin's folder in PV_PLUGIN_PATH:
    python3 scaling.py [--ranks 1,2] [--points 1025] [--bumps 50] [--extent 0.3] [--no-normals]

Every number of ranks deforms the same relief of points x points by the same list, three times with another list; the
table has the shortest time, which is that of the slowest rank, and what the first rank computed meanwhile (which tells
more on a busy machine). Each rank uses one thread.
"""
import argparse
import os
import subprocess
import sys
import time

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--ranks", default="1,2")
arguments.add_argument("--points", type=int, default=1025, help="along each side")
arguments.add_argument("--bumps", type=int, default=50)
arguments.add_argument("--extent", type=float, default=0.3, help="of a bump, of a surface of size 1")
arguments.add_argument("--no-normals", action="store_true")
arguments.add_argument("--worker", help=argparse.SUPPRESS)
given = arguments.parse_args()


def bumps(seed):
    import random
    drawn = random.Random(seed)
    rows = [[drawn.uniform(-0.5, 0.5), drawn.uniform(-0.5, 0.5), given.extent, given.extent, 0, 0,
             drawn.uniform(-0.01, 0.01), 0, 1] for _ in range(given.bumps)]
    return sum(rows, [])


def work():
    """Prints the shortest time and the least work of this rank, in seconds."""
    from paraview.simple import AnamorphDeform, AnamorphReliefSource
    relief = AnamorphReliefSource(FileName=given.worker, Resolution=[given.points, given.points])
    relief.UpdatePipeline()
    deform = AnamorphDeform(Input=relief, Deformations=bumps(0), ComputeNormals=not given.no_normals)
    times, work_times = [], []
    for seed in range(4):
        deform.Deformations = bumps(seed + 1)
        start, work_start = time.perf_counter(), time.process_time()
        deform.UpdatePipeline()
        times.append(time.perf_counter() - start)
        work_times.append(time.process_time() - work_start)
    assert deform.GetDataInformation().GetNumberOfPoints() >= given.points ** 2
    print("seconds", min(times[1:]), min(work_times[1:]))  # the first one also finds out what the surface is


def main():
    import tempfile
    with tempfile.NamedTemporaryFile(suffix=".pgm") as picture:
        picture.write(b"P5\n64 64\n255\n" + bytes((x * y) % 256 for y in range(64) for x in range(64)))
        picture.flush()
        first = None
        print("ranks  seconds  speed-up  first rank's work", flush=True)
        for ranks in given.ranks.split(","):
            command = ["mpiexec", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", ranks, "pvbatch",
                       os.path.abspath(__file__), *sys.argv[1:], "--worker", picture.name]
            environment = {**os.environ, "VTK_SMP_BACKEND_IN_USE": "Sequential"}
            printed = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
            line = [line for line in printed.splitlines() if line.startswith("seconds")][0]
            seconds, work_seconds = (float(number) for number in line.split()[1:])
            first = first or seconds
            print(f"{ranks:>5}  {seconds:7.3f}  {first / seconds:8.2f}  {work_seconds:7.3f}", flush=True)


if given.worker:
    work()
else:
    main()
