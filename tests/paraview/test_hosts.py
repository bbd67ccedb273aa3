# SPDX-License-Identifier: Apache-2.0
"""The plugin makes the same bits in pvpython, in pvbatch of 2 and 4 ranks on a surface in as many pieces, and on a
server of 2 ranks; and it is found by PV_PLUGIN_PATH, on both sides of a server too."""
import os
import subprocess
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
RANKS = ["mpiexec", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n"]


def run(command, **environment):
    done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, (command, done.stdout[-2000:], done.stderr[-4000:])
    return done.stdout


def digests(host, folder, pieces, **environment):
    lines = run([*host, HERE + "/print_digests.py", folder], **environment).splitlines()
    assert f"pieces {pieces}" in lines, lines
    found = [line for line in lines if line.startswith("digest ")]
    assert len(found) == 6, lines
    return found


def on_server(folder, ranks):
    server = subprocess.Popen([*RANKS, str(ranks), "pvserver", "--server-port=0"], stdout=subprocess.PIPE, text=True)
    try:
        for line in server.stdout:
            if line.startswith("Accepting connection(s): "):
                break
        else:
            raise AssertionError("pvserver takes no connections")
        port = line.strip().rsplit(":", 1)[1]
        return digests(["pvpython"], folder, ranks, ANAMORPH_SERVER="127.0.0.1:" + port)
    finally:
        server.terminate()  # mpiexec passes it on
        server.wait(timeout=60)


with tempfile.TemporaryDirectory() as folder:
    run(["pvpython", "-c", f"import surfaces; surfaces.write_inputs({folder!r})"])
    serial = digests(["pvpython"], folder, 1)
    print("\n".join(serial))
    for ranks in (2, 4):
        assert digests([*RANKS, str(ranks), "pvbatch"], folder, ranks) == serial, ranks
    assert on_server(folder, 2) == serial

    script = folder + "/found.py"
    with open(script, "w") as file:
        file.write("from paraview.simple import *\nprint(AnamorphDeform, AnamorphInbetween, AnamorphReliefSource)\n")
    plugin = os.path.dirname(os.environ["ANAMORPH_PLUGIN"])
    for host in ("pvpython", "pvbatch"):
        run([host, script], PV_PLUGIN_PATH=plugin)

    # On both sides of a server, without an error: what each has found is what the other knows.
    script = folder + "/both.py"
    with open(script, "w") as file:
        file.write("import os\nfrom paraview.simple import *\nConnect('127.0.0.1', int(os.environ['SERVER_PORT']))\n"
                   "deform = AnamorphDeform(Input=Sphere())\ndeform.UpdatePipeline()\n"
                   "print(deform.GetDataInformation().GetNumberOfPoints())\n")
    log = open(folder + "/server.txt", "w+")
    server = subprocess.Popen(["pvserver", "--server-port=0"], stdout=log, stderr=log, text=True,
                              env={**os.environ, "PV_PLUGIN_PATH": plugin})
    try:
        deadline, port = time.monotonic() + 60, None
        while port is None and time.monotonic() < deadline:
            time.sleep(0.2)
            with open(folder + "/server.txt") as told:
                port = next((line.strip().rsplit(":", 1)[1] for line in told if line.startswith("Accepting connection(s): ")), None)
        assert port, "the server does not start"
        assert "50" in run(["pvpython", script], PV_PLUGIN_PATH=plugin, SERVER_PORT=port)
    finally:
        server.terminate()
        server.wait(timeout=60)
    log.seek(0)
    told = log.read()
    assert "ERR" not in told and "rror" not in told, told
