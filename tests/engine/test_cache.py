"""What was compiled once is opened by the next process."""

import subprocess
import sys

STEP = """
from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.cpu.time_loop import run

engine = CpuEngine()
engine.load(*scene([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0e-3]], 2.0e-3))
engine.advance(3).raise_if_any()
print(sum(run.entry.stats.cache_hits.values()), sum(run.entry.stats.cache_misses.values()))
"""


def test_a_second_process_compiles_nothing():
    """In the cache of all tests, where the first process may find the kernel."""
    told = [
        subprocess.run(
            [sys.executable, "-c", STEP], capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    ]
    assert told[0] in (["0", "1"], ["1", "0"])
    assert told[1] == ["1", "0"]
