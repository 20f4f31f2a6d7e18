"""Let a two-way run go on for half an hour and see whether its memory stays flat.

    python tests/faults/soak.py FOLDER [MINUTES] [KEY=VALUE ...]

The packaged sheet flow, 650 grains in a column of water with eddies, as `ryusa run` makes it, with its end
far off; a checkpoint every minute, frames as the case asks. Resident memory is read every second. After a
warm-up of a tenth of the time (first checkpoints, first parts) the mean of the next tenth is held against
that of the last; kernels are compiled by a run before, since a process that compiles keeps some 300 MB of the
compiler. What is not yet written takes part: a part comes every 2 s at first, every 18 s after half an
hour. Then the run is asked to stop, and what it wrote is opened. Leaves with 1 above 1 % of growth.
"""

import json
import signal
import statistics
import subprocess
import sys
import time
from importlib.resources import files
from pathlib import Path

from ryusa.results import Results

GROWTH = 1.0  # % allowed
NAMES = ("VmRSS", "RssAnon")  # all that is resident, and what of it is no file
RUN = "import sys; from ryusa.cli import main; main(sys.argv[1:])"
STOPPED = 5


def resident(pid: int) -> dict[str, float] | None:
    """Memory of a process [MB]; None once it has ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return None
    found = {line.split(":")[0]: line.split()[1] for line in lines if line.startswith(NAMES)}
    return {name: int(found[name]) / 1024 for name in NAMES} if len(found) == len(NAMES) else None


def soak(folder: Path, minutes: float, settings: list[str]) -> dict[str, object]:
    """Run for so many minutes; the figures."""
    case = str(files("ryusa").joinpath("cases", "sheet_flow.toml"))
    words = [sys.executable, "-c", RUN, "run", case, "-o", str(folder), "--overwrite", "--quiet"]
    words += ["--checkpoint", "1min", *(word for one in settings for word in ("--set", one))]
    subprocess.run([*words, "--set", "record.settle=0 s", "--set", "stop.time=1 ms"], check=True)
    child = subprocess.Popen([*words, "--set", "stop.time=1000 s"])
    seen: list[dict[str, float]] = []
    begun = time.monotonic()
    try:
        while time.monotonic() - begun < 60.0 * minutes:
            time.sleep(1.0)
            now = resident(child.pid)
            if now is None or child.poll() is not None:
                raise SystemExit(f"the run ended by itself with {child.wait()}")
            seen.append(now)
        child.send_signal(signal.SIGTERM)
        code = child.wait(timeout=120)
    finally:
        child.kill()
    tenth = max(len(seen) // 10, 1)
    table: dict[str, object] = {"minutes": minutes, "exit code": code}
    for name in NAMES:
        first = statistics.fmean(one[name] for one in seen[tenth : 2 * tenth])
        last = statistics.fmean(one[name] for one in seen[-tenth:])
        table[name] = {
            "after warm-up [MB]": round(first, 2), "at the end [MB]": round(last, 2),
            "most [MB]": round(max(one[name] for one in seen), 2),
            "growth [%]": round(100.0 * (last / first - 1.0), 3),
        }  # fmt: skip
    results = Results.open(folder)
    table |= {"status": results.status, "frames": len(results.frames), "t [s]": results.summary["t"]}
    table |= {"steps": results.summary["steps"], "parts": len(list((folder / "parts").glob("part-*")))}
    kept = json.dumps({"table": table, "MB every second": [one["VmRSS"] for one in seen]})
    (folder.parent / f"{folder.name}.json").write_text(kept + "\n")
    return table


def main() -> None:
    """Read the command line."""
    folder, minutes = Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 30.0
    table = soak(folder, minutes, sys.argv[3:])
    for name, value in table.items():
        print(f"{name}: {value}")
    grown = table["VmRSS"]["growth [%]"]  # type: ignore[index]
    sys.exit(int(grown >= GROWTH or table["exit code"] != STOPPED))


if __name__ == "__main__":
    main()
