"""Kill runs at random moments, go on until they are complete, and hold them against one left alone.

    python tests/faults/campaign.py FOLDER KILLS SEED [KIND ...]

Prints a line for each kind, and leaves with 1 where anything was lost. Children are forked from a process in
which all is loaded and compiled, so that most of the time goes into running and being killed.
"""

import json
import os
import random
import shutil
import signal
import sys
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from kinds import KINDS, case_of

import ryusa
from ryusa.errors import RyusaError
from ryusa.results import Results, schema
from ryusa.running import checkpoint_scheduler, loop, recorder, vtkhdf

CHECKPOINT = 0.05  # s of wall time
NOT_THE_SAME = {"wall", "compiled", "particle_steps_per_second"}  # of a summary


def run(kind: str, folder: Path, **how: Any) -> Results:
    """Run one of the kinds, or go on with it."""
    return ryusa.run(case_of(kind), folder, progress=False, **how)


def differences(one: Path, other: Path) -> list[str]:
    """Everything in which two run folders differ beside times of the clock, bit for bit."""
    a, b = Results.open(one), Results.open(other)
    found = [f"status {a.status}, {b.status}"] if (a.status, b.status) != ("complete", "complete") else []
    for name in ("t", "step", "x", "v", "omega", "image"):
        left, right = np.asarray(getattr(a.frames, name)), np.asarray(getattr(b.frames, name))
        if left.shape != right.shape or left.tobytes() != right.tobytes():
            found.append(f"frames.{name}")
    found += [f"tally.{name}" for name in a.tally if a.tally[name].tobytes() != b.tally[name].tobytes()]
    if a.contacts.tobytes() != b.contacts.tobytes():
        found.append(f"contacts, {len(a.contacts)} and {len(b.contacts)}")
    if a.passages.tobytes() != b.passages.tobytes():
        found.append(f"passages, {len(a.passages)} and {len(b.passages)}")
    if a.bodies is not None and b.bodies is not None:
        for name in ("x", "v", "q", "momentum", "image"):
            left, right = (np.asarray(getattr(one.bodies, name)) for one in (a, b))
            found += [f"bodies.{name}"] if left.tobytes() != right.tobytes() else []
    if a.fluid is not None and b.fluid is not None:
        for name in ("t", *a.fluid.flow.fields()):
            left, right = (np.asarray(getattr(one.fluid, name)) for one in (a, b))
            found += [f"water.{name}"] if left.tobytes() != right.tobytes() else []
    summaries = [{k: v for k, v in r.summary.items() if k not in NOT_THE_SAME} for r in (a, b)]
    if json.dumps(summaries[0]) != json.dumps(summaries[1]):
        found += [f"summary.{k}" for k in summaries[0] if summaries[0][k] != summaries[1].get(k)]
    if [(s, t) for s, t, _ in a.scenes] != [(s, t) for s, t, _ in b.scenes]:
        found.append("scenes")
    if a.provenance["message"] != b.provenance["message"]:
        found.append("message")
    return found


def readable(folder: Path, whole: Results) -> tuple[int, list[str]]:
    """Frames that are there, and what is wrong with them; None of it is repaired before it is read."""
    try:
        found = Results.open(folder)
    except RyusaError as error:
        begun = (folder / schema.PARTS).is_dir() and any((folder / schema.PARTS).glob("part-*"))
        return 0, [f"not readable: {error}"] if begun else []
    wrong: list[str] = []
    n = len(found.frames)
    if np.asarray(found.frames.x).tobytes() != np.asarray(whole.frames.x[:n]).tobytes():
        wrong.append("frames differ")
    shown = 0
    if (folder / schema.GRAINS).is_file():
        with h5py.File(folder / schema.GRAINS, "r", locking=False) as file:
            steps, points = file["ryusa/step"][:], file["VTKHDF/Points"][:]
        if steps.tolist() != whole.frames.step[: len(steps)].tolist():
            wrong.append("index differs in steps")
        if points.tobytes() != np.asarray(whole.frames.x_wrapped[: len(steps)]).tobytes():
            wrong.append("index differs in points")
        shown = len(steps)
    if n and n - shown > frames_of_last_part(folder):  # the index follows the part by a second rename
        wrong.append("the index is more than a part behind")
    return n, wrong


def frames_of_last_part(folder: Path) -> int:
    with h5py.File(sorted((folder / schema.PARTS).glob("part-*"))[-1], "r", locking=False) as file:
        return len(file["t"])


def hurry(draw: random.Random) -> None:
    """Cut the run into odd calls, and write parts and checkpoints far more often than a user would."""
    odd, apart = random.Random(draw.random()), draw.choice((0.0, 0.05, 0.5, 2.0))
    loop.Loop._chunk = lambda self: odd.randint(1, 700)  # type: ignore[method-assign]
    recorder.flush_after = lambda elapsed, n_part: apart
    checkpoint_scheduler._SHARE = 1.0
    vtkhdf.SUBINDEX_PARTS = odd.choice((2, 5, 32))


def killed(kind: str, folder: Path, after: float, draw: random.Random) -> bool:
    """Run in a child that is killed after so many seconds; True if it ended by itself before."""
    child = os.fork()
    if child == 0:
        code = 1
        hurry(draw)
        try:
            code = 0 if run(kind, folder, resume=True, checkpoint=CHECKPOINT).complete else 2
        except BaseException as error:
            print(f"{kind}: {type(error).__name__}: {error}", flush=True)
        finally:
            os._exit(code)
    end = time.monotonic() + after
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            if status:
                raise SystemExit(f"{kind}: a run ended with {status}")
            return True
        time.sleep(0.001)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return False


def campaign(folder: Path, kind: str, kills: int, seed: int) -> list[str]:
    """Kill one kind of run so many times, over as many runs as that takes; what went wrong."""
    draw = random.Random(f"{seed} {kind}")
    whole_folder, hurt = folder / f"{kind}-whole", folder / f"{kind}-hurt"
    run(kind, whole_folder, overwrite=True)  # compiles
    begun = time.monotonic()
    whole = run(kind, whole_folder, overwrite=True, checkpoint=CHECKPOINT)
    lasts = time.monotonic() - begun
    wrong: list[str] = []
    done = runs = 0
    while done < kills:
        shutil.rmtree(hurt, ignore_errors=True)
        seen, n, complete = 0, 0, False
        while not complete and n < 200:
            # mostly short lives, some long; the last run of all is left alone so that the campaign ends
            after = draw.uniform(0.0, draw.choice((0.1, 0.5, 1.0)) * lasts) if done < kills else 1e9
            draw.random()  # so that each child hurries in its own way
            complete = killed(kind, hurt, after, draw)
            n += 1
            done += not complete
            if hurt.is_dir():
                now, faults = readable(hurt, whole)
                wrong += [f"{kind}, after kill {done}: {one}" for one in faults]
                if now < seen:
                    wrong.append(f"{kind}, after kill {done}: {seen} frames, then {now}")
                seen = now
        runs += 1
        wrong += [f"{kind}, run {runs}: {one} not the same" for one in differences(whole_folder, hurt)]
        if wrong:
            break
    print(f"{kind}: {done} kills over {runs} runs, {len(wrong)} faults", *wrong[:20], sep="\n  ", flush=True)
    return wrong


def main() -> None:
    """Read the command line."""
    folder, kills, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    wrong: list[str] = []
    for kind in sys.argv[4:] or KINDS:
        wrong += campaign(folder, kind, kills, seed)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
