"""Many small calls, without growth of memory. ``python tests/test_soak.py 1000000`` runs as many as one likes."""

import gc
import sys
import time

import numpy as np
import pytest

import sightlines as sl

from conftest import ROOMS


def resident() -> int:
    """Bytes of memory that this process has."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def soak(n: int) -> tuple[int, float]:
    """Makes ``n`` calls; bytes of growth, seconds for each."""
    plan = sl.Plan(ROOMS)
    table = plan.bake(progress=False)
    data = table.to_bytes()
    eyes = np.random.default_rng(1).uniform((0, 0), (12, 3), (8, 2))

    def some_calls() -> int:
        table.visible_cells((1.0, 1.5))
        table.visible_objects((1.0, 1.5))
        table.visible_cells(eyes)
        table.cells_at((99.0, 0.0))
        table.sees(0, 1)
        table.sees([0, 1], [1, 0])
        table.may_see((1, 1), (9, 1))
        table.counts, table.cells
        for wrong in (lambda: table.sees(0, 10**6), lambda: table.visible_cells((np.nan, 0)), lambda: sl.Plan([[1, 1, 1, 1]])):
            try:
                wrong()
            except (ValueError, IndexError):
                pass
        sl.Table.from_bytes(data)
        sl.Plan(ROOMS)
        table.explain(0, 1)
        plan.isovist((1.0, 1.5)).measures
        plan.isovist((1.0, 1.5), radius=1.0, direction=(1, 0), angle=90).vertices
        plan.sees((1, 1), (9, 1))
        plan.sees(eyes, eyes[::-1])
        plan.sees((-999, 1), (999, 1))
        return 20

    done = 0
    while done < n // 10:
        done += some_calls()
    gc.collect()
    before, start, done = resident(), time.perf_counter(), 0
    while done < n:
        done += some_calls()
    took = (time.perf_counter() - start) / done
    gc.collect()
    return resident() - before, took


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is read from /proc")
def test_many_calls_do_not_grow():
    growth, _ = soak(100_000)
    # A leak of a byte for each call would be a fifth of a megabyte; arrays are a hundred bytes and more.
    assert growth < 2 << 20, growth


if __name__ == "__main__":
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    growth, took = soak(n)
    print(f"{n} calls: {growth / 1024:.0f} KiB more, {took * 1e6:.1f} µs for each")
