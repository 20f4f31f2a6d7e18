"""The machine: what it is, and whether anybody else is at work on it."""

import os
import platform
import resource
import subprocess
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

LOAD = 0.3  # load average above which a machine is not quiet
OTHERS = 0.08  # cores that other processes may use meanwhile
STEAL = 0.03  # cores' worth of time that the host may take away
VECTORS = ("avx512f", "avx2", "avx", "asimd")
SLOW = 1.25  # of the fastest spin seen, now or in an earlier sitting; a tenth or two up and down is usual
SPINS = 30  # one or two seconds


def describe() -> dict[str, Any]:
    """Processor, caches, memory, system, date."""
    from ryusa.running.provenance import processor

    said = subprocess.run(["lscpu"], capture_output=True, text=True, check=False).stdout
    rows = dict(line.split(":", 1) for line in said.splitlines() if ":" in line)
    caches = [name for name in ("L1d", "L2", "L3") if f"{name} cache" in rows]
    pages = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return {
        "cpu": processor(),
        "cores": len(os.sched_getaffinity(0)),
        "caches": ", ".join(f"{name} {rows[f'{name} cache'].strip()}" for name in caches),
        "vectors": next((name for name in VECTORS if name in rows.get("Flags", "").split()), "?"),
        "memory": f"{pages / 2**30:.0f} GiB",
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "date": datetime.now(UTC).isoformat(timespec="minutes"),
    }  # fmt: skip


def spin() -> float:
    """Time of a fixed piece of plain Python [s], a yardstick for the machine's speed now; the least of many.

    A processor that has idled runs at half its speed for the better part of a second.
    """
    taken: list[float] = []
    for _ in range(SPINS):
        begun = time.perf_counter()
        total = 0
        for k in range(2_000_000):
            total += k & 7
        taken.append(time.perf_counter() - begun)
    return min(taken)


@dataclass
class Watch:
    """Time that others used between two looks, and whether the machine is as fast as it can be."""

    fastest: float = float("inf")  # spin seen [s]
    _stat: tuple[float, float] = (0.0, 0.0)
    _own: float = 0.0
    _at: float = 0.0

    def begin(self) -> None:
        """Look for the first time."""
        self._stat, self._own, self._at = _busy(), _ours(), time.perf_counter()

    def end(self) -> dict[str, float]:
        """Cores that others used and that the host took since `begin`, and a spin over the fastest one."""
        taken = time.perf_counter() - self._at
        busy, steal = _busy()
        others = (busy - self._stat[0] - (_ours() - self._own)) / taken
        one = spin()
        self.fastest = min(self.fastest, one)
        return {
            "others": round(max(others, 0.0), 3),
            "steal": round((steal - self._stat[1]) / taken, 3),
            "spin": round(one / self.fastest, 3),
        }


def quiet(seen: dict[str, float]) -> bool:
    """Nobody else was at work, as far as a look can tell."""
    return seen["others"] <= OTHERS and seen["steal"] <= STEAL and seen["spin"] <= SLOW


def noise(watch: Watch, seconds: float = 3.0) -> str:
    """Why the machine is not quiet now; "" when it is."""
    load = os.getloadavg()[0]
    watch.fastest = min(watch.fastest, spin())
    watch.begin()
    time.sleep(seconds)
    seen = watch.end()
    if quiet(seen) and load <= LOAD:
        return ""
    return (
        f"load average {load:.2f} (at most {LOAD}), others use {seen['others']:.2f} cores "
        f"(at most {OTHERS}), the host takes {seen['steal']:.2f} (at most {STEAL}), plain Python takes "
        f"{seen['spin']:.2f} times what it took at best (at most {SLOW})"
    )


def _busy() -> tuple[float, float]:
    """Time that processors worked, and that the host took away, since the machine began [s]."""
    words = Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]
    user, nice, system, _, _, irq, softirq, steal = (int(word) for word in words[:8])
    tick = os.sysconf("SC_CLK_TCK")
    return (user + nice + system + irq + softirq) / tick, steal / tick


def _ours() -> float:
    """Time that this process and its finished children worked [s]."""
    found = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in found)
