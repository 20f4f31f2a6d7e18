"""A law has one meaning, whoever calls it first."""

import os
import subprocess
import sys
from pathlib import Path

FAST_CALLER_FIRST = """
import numba
from ryusa.laws.contact import shear_strength

@numba.njit(fastmath={"contract", "nsz"})
def kernel(push, cohesion, mu):
    return shear_strength(push, cohesion, mu)

case = (6.5, 1.0, 0.06538962592060883)
kernel(*case)
assert shear_strength.entry(*case) == shear_strength.py_func(*case)
"""


def test_fastmath_of_the_first_caller_does_not_affect_other_callers(tmp_path: Path) -> None:
    clean = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    for _ in range(2):  # compiled, then from the cache
        subprocess.run([sys.executable, "-c", FAST_CALLER_FIRST], check=True, env=clean)
