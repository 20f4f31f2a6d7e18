"""Speed side by side: every code steps the same grains in turn, round after round."""

import statistics
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from machine import Watch, quiet
from peer import Job, Peer, PeerError, carry_out
from peer_ryusa import ALONE, Ryusa
from workloads import Workload

SKINS = 6  # to try at most
TUNE = 0.25  # of the steps, for a look at builds and skins
MOST = 2  # rounds, over those wanted, where some were not quiet


def rate(n: int, job: Job, loop: float) -> float:
    """Million particle-steps per second, free grains counted."""
    return 1e-6 * n * job.steps / loop


def run(peer: Peer, job: Job, work: Path) -> Any:
    """One run in a folder that goes afterwards."""
    with tempfile.TemporaryDirectory(dir=work) as folder:
        return carry_out(peer, job, Path(folder))


def tune(builds: list[Any], job: Job, n: int, work: Path) -> dict[str, Any]:
    """Fastest build at a middle skin, then its best skin of three, or of more; all rates are kept."""
    short = job.times(TUNE)
    load = job.load.name
    middle = builds[0].skins[load][1]
    seen: dict[str, dict[str, float]] = {}

    def once(build: Any, skin: float) -> float:
        one = replace(short.times(build.share), skin=skin)
        try:
            found = rate(n, one, run(build, one, work).loop)
        except PeerError as error:
            print(f"    {error}", flush=True)
            found = 0.0
        seen.setdefault(build.label, {})[f"{skin:g}"] = round(found, 3)
        return found

    best = max(builds, key=lambda build: once(build, middle))
    if not seen[best.label][f"{middle:g}"]:
        return {"build": None, "rates": seen}
    rates = seen[best.label]
    found = {skin: rates.get(f"{skin:g}") or once(best, skin) for skin in best.skins[load]}
    while len(found) < SKINS:  # until the best lies between two others
        skin = max(found, key=lambda one: found[one])
        if min(found) < skin < max(found):
            break
        skin = round(skin * (1.5 if skin == max(found) else 0.5), 4)
        found[skin] = once(best, skin)
    return {"build": best.label, "skin": max(found, key=lambda one: found[one]), "rates": seen}


def side_by_side(
    load: Workload,
    grains: Path,
    n: int,
    threads: int,
    peers: dict[str, list[Any]],
    *,
    pairs: int,
    scale: float,
    anyway: bool,
    work: Path,
    row: dict[str, Any],
    keep: Callable[[], None],
    watch: Watch,
) -> None:
    """Fill a row of the table: builds and skins first, then rounds; what is there is not done again."""
    grid = load.grid
    job = Job(load, grains, threads, grid.warm, grid.steps).times(scale)
    row |= {
        "workload": load.key,
        "what": load.what,
        "grains": n,
        "threads": threads,
        "steps": job.steps,
        "warm": job.warm,
    }
    tuned = row.setdefault("tuned", {})
    codes: list[tuple[Any, Job]] = []
    for name, builds in peers.items():
        if name not in tuned:
            tuned[name] = tune(builds, job, n, work)
            keep()
            print(f"    {name}: {tuned[name]}", flush=True)
        best = next((one for one in builds if one.label == tuned[name]["build"]), None)
        if best is not None:
            codes.append((best, replace(job.times(best.share), skin=tuned[name]["skin"])))
    slips = sorted({code.slip for code, _ in codes}, reverse=True) or [Ryusa().slip]
    codes = [*((Ryusa(slip), job) for slip in slips), *codes]
    if threads > 1:
        codes.append((Ryusa(slips[0], alone=True), replace(job, threads=1)))
    rounds = row.setdefault("rounds", [])
    if any(set(one["codes"]) != {code.name for code, _ in codes} for one in rounds):
        rounds.clear()  # taken with other codes beside
    while sum(one["quiet"] or anyway for one in rounds) < pairs and len(rounds) < MOST * pairs:
        one: dict[str, Any] = {}
        watch.begin()
        k = len(rounds) % len(codes)
        for code, its in [*codes[k:], *codes[:k]]:
            taken = run(code, its, work)
            one[code.name] = {
                "rate": rate(n, its, taken.loop),
                "start": taken.whole - taken.loop,
                **taken.own,
            }
        seen = watch.end()
        rounds.append({"codes": one, **seen, "quiet": quiet(seen)})
        keep()
        rates = ", ".join(f"{name} {found['rate']:.2f}" for name, found in one.items())
        print(f"    {len(rounds)}: {rates} M/s{'' if quiet(seen) else f' not quiet {seen}'}", flush=True)


def summary(row: dict[str, Any], peers: dict[str, str]) -> dict[str, Any]:
    """Medians and ratios of a row; `peers` gives the slip rule of each by name.

    Only quiet rounds count where there are some.
    """
    rounds = [one for one in row["rounds"] if one["quiet"]] or row["rounds"]
    names = list(rounds[0]["codes"])
    found: dict[str, Any] = {"pairs": len(rounds), "quiet": all(one["quiet"] for one in rounds), "codes": {}}
    for name in names:
        rates = [one["codes"][name]["rate"] for one in rounds]
        about: dict[str, Any] = {
            "rate": statistics.median(rates),
            "spread": (max(rates) - min(rates)) / statistics.median(rates),
        }
        if name.endswith(ALONE):
            both = [one["codes"][name.removesuffix(ALONE)]["rate"] for one in rounds]
            about["efficiency"] = (
                statistics.median(a / b for a, b in zip(both, rates, strict=True)) / row["threads"]
            )
        elif name in peers:
            ours = [one["codes"][f"ryusa ({peers[name]})"]["rate"] for one in rounds]
            ratios = sorted(a / b for a, b in zip(ours, rates, strict=True))
            about["ratio"] = statistics.median(ratios)
            about["ratio, lower quartile"] = (
                statistics.quantiles(ratios, n=4, method="inclusive")[0] if len(ratios) > 1 else ratios[0]
            )
        else:
            about["contacts"] = statistics.median(one["codes"][name]["contacts"] for one in rounds)
        found["codes"][name] = about
    return found
