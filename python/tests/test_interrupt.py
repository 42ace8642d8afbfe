"""Ctrl-C, as a real signal to another process."""

import os
import signal
import subprocess
import sys
import time

import pytest

PROGRAM = """
import sys, time
import sightlines as sl

scene = {scene}

def told(phase, done, total):
    if done and not told.ready:
        told.ready = True
        print("ready", flush=True)

told.ready = False
try:
    {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    # The interpreter is whole, and the next call works.
    small = sl.Plan([[0, 0, 4, 0], [4, 0, 4, 3], [4, 3, 0, 3], [0, 3, 0, 0]]).bake()
    print("cells", small.n_cells, flush=True)
else:
    print("finished", flush=True)
"""

TOWER, OFFICE = "sl.scenes.tower(floors=24, rooms_x=8, rooms_y=6, furniture=0)", "sl.scenes.office(24, 24)"

CALLS = {
    "space": (TOWER, "sl.bake(scene, progress=told, threads=1)"),
    "plan": ("sl.scenes.office(96, 96)", "scene.bake(progress=told, threads=1, subdivide='triangulation')"),
    "isovists": (OFFICE, "scene.isovists(scene.grid(0.05), progress=told, threads=1)"),
    "vga": (OFFICE, "scene.vga(0.25, progress=told, threads=1)"),
}


@pytest.mark.skipif(os.name == "nt", reason="signals are POSIX's")
@pytest.mark.parametrize("kind", CALLS)
def test_a_signal_stops_a_bake(kind):
    scene, call = CALLS[kind]
    child = subprocess.Popen(
        [sys.executable, "-c", PROGRAM.format(scene=scene, call=call)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert child.stdout.readline().strip() == "ready"
        start = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=60)
    finally:
        child.kill()
    took = time.monotonic() - start
    assert out.split("\n")[:2] == ["interrupted", "cells 1"], (out, err)
    assert child.returncode == 0 and took < 30, took
