"""What was compiled once is opened by the next process."""

import os
import subprocess
import sys

STEP = """
from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine

engine = CpuEngine()
engine.load(*scene([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0e-3]], 2.0e-3))
engine.advance(3).raise_if_any()
print(sum(engine._run.stats.cache_hits.values()), sum(engine._run.stats.cache_misses.values()))
"""


def test_a_second_process_compiles_nothing(tmp_path):
    told = [
        subprocess.run(
            [sys.executable, "-c", STEP],
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for _ in range(2)
    ]
    assert told == [["0", "1"], ["1", "0"]]
