"""The benchmark of DEM frameworks of Dosta et al. 2024: ryusa beside LIGGGHTS and YADE.

    python benchmarks/frameworks.py           # the short form: all three cases, in 20 minutes on two cores
    python benchmarks/frameworks.py answers speed --seeds 4 --jobs 1 --save frameworks.json

A silo empties, a drum mixes, a ball meets a bed (Comput. Phys. Commun. 296, 109066): the same first grains
and triangles in every code (`frameworks_cases.py`), the same law as near as each can
(`frameworks_codes.py`), the same step. `answers` runs whole cases and compares what they say; `speed` times
the first part of each with the step of the paper and with each code's usual one, on one core and two, in
turn. What is done is kept in `build/benchmarks/frameworks` and not done again (`--fresh`).
"""

import argparse
import json
import os
import shutil
import statistics
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import machine
import numpy as np
from frameworks_cases import Bulk, forms, measured, settled
from frameworks_codes import codes

Rows = list[dict[str, Any]]
WORK = Path("build/benchmarks/frameworks")
PEERS = {"ryusa": "LIGGGHTS", "ryusa (Thornton)": "YADE"}  # that have the same damping
# Bands of ryusa beside the peer of the same damping, fixed before the first whole run of any code. The paper
# has all codes within 5 % of their mean rate of discharge. What lies within two standard errors of the seeds
# is said beside them.
BANDS = {
    "rate [1/s]": ("of the peer", 0.05),
    "empty [s]": ("of the peer", 0.05),
    "index": ("at each quarter of a turn, by cubes of three large grains and of two", 0.05),
    "zones": ("root mean square over time, of all M1", 0.05),
    "way [m]": ("at every frame until the ball is deepest", 0.001),
    "end [m]": ("absolute", 0.002),
}
WANTED = {"YADE": 5.0, "LIGGGHTS": 1.5}  # speed of ryusa over that of a peer
SLICES = {  # shares of the time of a case that are timed: a shorter and a longer, the difference counts
    "short": {"silo": (0.01, 0.06), "drum": (0.01, 0.05), "impact": (0.02, 0.1)},
    "full": {"silo": (2e-5, 1.4e-4), "drum": (2e-5, 1.4e-4), "impact": (1e-3, 5e-3)},
}
_NOT_COMPARED = ("wall", "processor", "memory", "load", "at [s]", "deepest [m]")


def kept_row(path: Path, make: Callable[[], dict[str, Any]], fresh: bool) -> dict[str, Any]:
    """A row of the results, read where it was made before."""
    if path.exists() and not fresh:
        return json.loads(path.read_text())
    row = make()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(row))
    return row


def answer(form: str, bulk: Bulk, code: str, seed: int) -> dict[str, Any]:
    """One whole run; where its grains were over time goes beside."""
    folder = frames_of(form, bulk.name, code, seed).with_suffix("")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    kept = settled(bulk, seed, WORK / "packings").resolve()
    spent, t, x = codes()[code](bulk, kept, folder.resolve(), bulk.dt, 1)
    np.savez_compressed(folder.with_suffix(".npz"), t=t, x=x.astype(np.float32))
    shutil.rmtree(folder)
    about = {"case": bulk.name, "code": code, "seed": seed, "load": os.getloadavg()[0]}
    return about | asdict(spent)


def frames_of(form: str, name: str, code: str, seed: int) -> Path:
    """Where the frames of a run are."""
    return WORK / f"{form}-{name}-{seed}-{code.replace(' ', '-')}.npz"


def judge(name: str, rows: Rows) -> Rows:
    """Means and spreads of the seeds, and ryusa beside the peer of its damping."""
    found: Rows = []
    keys = [key for key, one in rows[0].items() if isinstance(one, float) and key not in _NOT_COMPARED]
    for code in sorted({row["code"] for row in rows}):
        own = [row for row in rows if row["code"] == code]
        peer = {row["seed"]: row for row in rows if row["code"] == PEERS.get(code)}
        for key in keys:
            values = [row[key] for row in own if row[key] is not None]
            if not values:
                continue
            sd = statistics.stdev(values) if len(values) > 1 else None
            row = {"case": name, "code": code, "what": key, "mean": statistics.mean(values), "sd": sd}
            row["n"] = len(values)
            if key == "rate [1/s]":
                row["sd of quarters"] = statistics.mean(
                    statistics.stdev(one["quarters [1/s]"]) for one in own
                )
            pairs = [(one[key], peer[one["seed"]][key]) for one in own if one["seed"] in peer]
            pairs = [(a, b) for a, b in pairs if a is not None and b is not None]
            band = BANDS.get("index" if key.startswith("index") else key)
            if pairs and band is not None:
                gaps = [a - b for a, b in pairs]
                unit = statistics.mean(b for _, b in pairs) if band[0] == "of the peer" else 1.0
                row["off"] = statistics.mean(gaps) / unit
                if len(gaps) > 1:
                    row["standard error"] = statistics.stdev(gaps) / len(gaps) ** 0.5 / abs(unit)
                row |= {"beside": PEERS[code], "band": band[1], "within": bool(abs(row["off"]) <= band[1])}
            found.append(row)
        found += _curves(name, code, own, list(peer.values()))
    return found


def _curves(name: str, code: str, own: Rows, peer: Rows) -> Rows:
    """What ryusa and a peer say over time, by means over the seeds that both have."""
    seeds = sorted({one["seed"] for one in own} & {one["seed"] for one in peer})
    key = {"drum": "zones (M1, M2 in 1, in 2)", "impact": "way [m]"}.get(name)
    if not seeds or key is None:
        return []
    a, b = (np.mean([one[key] for one in rows if one["seed"] in seeds], axis=0) for rows in (own, peer))
    if name == "drum":
        what, off = "zones", float(np.sqrt(np.mean((a - b)[:, [0, 2]] ** 2))) / own[0]["number of M1"]
    else:
        what, off = key, float(np.abs(a - b)[: int(np.argmax(b)) + 1].max())
    band = BANDS[what][1]
    return [
        {"case": name, "code": code, "what": what, "n": len(seeds), "off": off, "beside": PEERS[code],
         "band": band, "within": bool(off <= band)}
    ]  # fmt: skip


def timed(form: str, bulk: Bulk, code: str, threads: int, own: bool) -> dict[str, Any]:
    """Time of a grain and step and of a simulated second, from the difference of two runs."""
    kept = settled(bulk, 1, WORK / "packings").resolve()
    dt = bulk.own[code] if own else bulk.dt
    steps = [max(1, round(share * bulk.time / dt)) for share in SLICES[form][bulk.name]]
    spent = []
    for n in steps:
        folder = WORK / "timed"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        part = replace(bulk, frame=n * dt, time=n * dt)
        spent.append(codes()[code](part, kept, folder.resolve(), dt, threads)[0])
    n, grains = steps[1] - steps[0], bulk.n
    processor, wall = spent[1].processor - spent[0].processor, spent[1].wall - spent[0].wall
    return {
        "form": form, "case": bulk.name, "grains": grains, "code": code, "threads": threads, "dt": dt,
        "own step": own, "steps": n, "processor ns a grain and step": 1e9 * processor / n / grains,
        "wall ns a grain and step": 1e9 * wall / n / grains, "processor s a simulated s": processor / n / dt,
        "wall s a simulated s": wall / n / dt, "memory": spent[1].memory, "load": os.getloadavg()[0],
    }  # fmt: skip


def times(how: argparse.Namespace) -> Rows:
    """All codes in turn, round by round."""
    rows: Rows = []
    cases = [(name, forms()[how.form][name]) for name in how.cases]
    timed_codes = [one for one in how.codes if one != "ryusa (Thornton)"]
    rounds = [(k, n, own) for k in range(how.rounds) for n in how.threads for own in (False, True)]
    for (k, n, own), (name, bulk), code in product(rounds, cases, timed_codes):
        path = WORK / "rows" / f"timed-{how.form}-{name}-{code}-{n}-{own}-{k}.json"
        rows.append(kept_row(path, partial(timed, how.form, bulk, code, n, own), how.fresh))
        print(shown(rows[-1]), flush=True)
    return rows


def speeds(rows: Rows) -> Rows:
    """Least times of the rounds, and how often ryusa does in the time of a peer what that does once."""
    least: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        key = tuple(row[one] for one in ("form", "case", "threads", "own step", "code"))
        clock = "processor s a simulated s" if row["threads"] == 1 else "wall s a simulated s"
        if key not in least or row[clock] < least[key]["least s a simulated s"]:
            least[key] = {**row, "least s a simulated s": row[clock]}
    found: Rows = []
    for (*about, code), row in least.items():
        ours = least.get((*about, "ryusa"))
        if code != "ryusa" and ours is not None:
            over = row["least s a simulated s"] / ours["least s a simulated s"]
            what = dict(zip(("form", "case", "threads", "own step"), about, strict=True))
            found.append(
                what | {"over": code, "speed": over, "asked": WANTED[code], "met": over >= WANTED[code]}
            )
    return found


def shown(row: dict[str, Any]) -> str:
    """A row as a line."""
    return "  ".join(
        f"{key} {one:.4g}" if isinstance(one, float) else f"{one}"
        for key, one in row.items()
        if not isinstance(one, list)
    )


def answers(how: argparse.Namespace) -> tuple[Rows, Rows]:
    """Whole runs of all codes, the slowest first, and what is made of them."""
    seeds = range(how.first_seed, how.first_seed + how.seeds)
    cases = [forms()[how.form][name] for name in how.cases]
    for bulk, seed in product(cases, seeds):
        settled(bulk, seed, WORK / "packings")

    def one(job: tuple[int, str, Bulk]) -> dict[str, Any]:
        seed, code, bulk = job
        path = WORK / "rows" / f"{how.form}-{bulk.name}-{code}-{seed}.json"
        row = kept_row(path, partial(answer, how.form, bulk, code, seed), how.fresh)
        with np.load(frames_of(how.form, bulk.name, code, seed)) as file:
            row |= measured(bulk, settled(bulk, seed, WORK / "packings"), file["t"], file["x"])
        print(shown(row), flush=True)
        return row

    slowest_first = sorted(how.codes, key=lambda code: code != "YADE")
    jobs = [(seed, code, bulk) for code in slowest_first for seed in seeds for bulk in cases]
    with ThreadPoolExecutor(how.jobs) as pool:
        rows = list(pool.map(one, jobs))
    judged = [one for name in how.cases for one in judge(name, [row for row in rows if row["case"] == name])]
    return rows, judged


def main() -> None:
    """Run what was asked and print it."""
    asked = argparse.ArgumentParser(description="The benchmark of DEM frameworks of Dosta et al. 2024.")
    asked.add_argument("parts", nargs="*", default=["answers"], help="answers, speed")
    asked.add_argument("--form", default="short", choices=list(forms()))
    asked.add_argument("--cases", nargs="+", default=["silo", "drum", "impact"])
    asked.add_argument("--codes", nargs="+", default=list(codes()))
    asked.add_argument("--seeds", type=int, default=1)
    asked.add_argument("--first-seed", type=int, default=1)
    asked.add_argument("--jobs", type=int, default=2, help="whole runs at the same time")
    asked.add_argument("--rounds", type=int, default=3, help="of speed")
    asked.add_argument("--threads", type=int, nargs="+", default=[1, 2], help="of speed")
    asked.add_argument("--fresh", action="store_true")
    asked.add_argument("--save", type=Path)
    how = asked.parse_args()
    found: dict[str, Any] = {"form": how.form, "machine": machine.describe()}
    if "answers" in how.parts:
        found["runs"], found["judged"] = answers(how)
    if "speed" in how.parts:
        found["times"] = times(how)
        found["speeds"] = speeds(found["times"])
    for row in (*found.get("judged", ()), *found.get("speeds", ())):
        print(shown(row))
    if how.save:
        how.save.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
