"""Report on a run folder: case, progress, energy account, warnings, checkpoints, next command."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.engine import registry
from ryusa.errors import CheckpointError
from ryusa.model.feeds import IN
from ryusa.results import Results, schema
from ryusa.running.checkpoint import read_checkpoint
from ryusa.running.energy_terms import energy_lines
from ryusa.running.folder import format_bytes
from ryusa.running.lock import holder

_WIDE = 14  # columns of the heading of a line
KILLED = "killed"
_LONGEST = 300  # characters shown of a text from the folder


def inspection(folder: Path) -> list[str]:
    """Lines of the report on a run folder.

    Raises
    ------
    ResultsError : not a run folder, damaged, or written in another format.
    """
    rows = inspection_rows(Results.open(folder))
    return [f"{heading:<{_WIDE}}{text}" for heading, text in rows]


def inspection_rows(results: Results) -> list[tuple[str, str]]:
    """Headings and texts of the report on a run."""
    rows = [
        ("run", _words(results.case.get("title") or results.folder.name)),
        ("status", _status(results)),
        ("case", _case(results)),
        ("computed by", _made_by(results.provenance)),
        ("time", _when(results)),
        *(("resumed", _resumption(one)) for one in _resumed(results.provenance)),
        ("progress", _how_far(results)),
        ("recorded", _recorded(results)),
        ("precision", _words(_table(results.summary.get("precision")).get("text") or "")),
        *_energy(results),
        *(("warning", _words(one)) for one in _list(results.summary.get("warnings"))),
        *(() if results.complete else [("checkpoint", _checkpoint(results))]),
        ("next", _next(results)),
    ]
    return [(heading, text) for heading, text in rows if text]


def _status(results: Results) -> str:
    message = _words(results.provenance.get("message") or "")
    if results.status != schema.RUNNING:
        return f"{_words(results.status)}: {message}" if message else _words(results.status)
    if state_of(results) == KILLED:
        return f"{KILLED}: marked as running, but no process is writing"
    return f"running: {holder(results.folder)} is writing"


def state_of(results: Results) -> str:
    """What a run is in a word: its status, or "killed" where it says running and no process writes."""
    if results.status != schema.RUNNING or holder(results.folder):
        return _words(results.status)
    return KILLED


def _case(results: Results) -> str:
    scene, origin = results.scene, results.provenance
    water = "" if scene.flow is None else f", {scene.flow.text}"
    overrides = origin.get("overrides")
    lines = "".join(f", {_words(k)} = {_words(v)}" for k, v in _table(overrides).items())
    return (
        f"{scene.n_grain} free{_by_feeds(results)} and {scene.n_fixed} fixed grains, {scene.n_plane} planes"
        f"{water}; step {scene.dt:.4g} s; seed {_words(origin.get('seed'))}{lines}"
    )


def _by_feeds(results: Results) -> str:
    """How many of the free grains are there at the start, how many feeds hold, and how many have entered."""
    traffic = results.scene.traffic
    if traffic is None:
        return ""
    rows, heads = results.passages, results.scene.heads
    own = np.arange(len(heads)) >= traffic.n_first
    first, kept = int((heads & ~own).sum()), int((heads & own).sum())
    came = len(np.unique(rows["grain"][rows["way"] == IN]))
    return f" ({first} at the start, {kept} for the feeds, which brought {came})"


def _made_by(origin: Mapping[str, Any]) -> str:
    machine = _table(origin.get("machine"))
    commit = str(origin.get("commit") or "")[:12]
    device = f" ({_words(origin['device'])})" if origin.get("device") else ""
    return (
        f"ryusa {_words(origin.get('ryusa'))}{f' ({_words(commit)})' if commit else ''}, "
        f"engine {_words(origin.get('engine'))}{device}, threads {_words(origin.get('threads'))}, "
        f"{_words(machine.get('processor'))}"
    )


def _when(results: Results) -> str:
    origin, wall = results.provenance, results.summary.get("wall")
    spent = f", {_number(wall):.4g} s of wall time" if _number(wall) >= 0.0 else ""
    end = origin.get("end")
    until = f", ended {_words(end)}" if end else ""
    return f"started {_words(origin.get('begin'))}{until}{spent}"


def _resumed(origin: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [one for one in _list(origin.get("resumed")) if isinstance(one, dict)]


def _resumption(one: Mapping[str, Any]) -> str:
    lines = "".join(f"; {_words(text)}" for text in _list(one.get("said")))
    return f"from t = {_number(one.get('t')):.6g} s, {_words(one.get('begin'))}{lines}"


def _how_far(results: Results) -> str:
    t = max(
        _number(results.summary.get("t"), 0.0), float(results.frames.t[-1]) if len(results.frames) else 0.0
    )
    end = _number(_table(results.case.get("stop")).get("time"))
    share = f" of at most {end:g} s ({100 * min(t / end, 1.0):.0f} %)" if end > 0.0 else ""
    return f"t = {t:.6g} s{share}"


def _recorded(results: Results) -> str:
    frames, contacts = len(results.frames), sum(part.n_contact for part in results._parts)
    files = [one for one in results.folder.rglob("*") if one.is_file() and not one.is_symlink()]
    till = f", the last at t = {results.frames.t[-1]:.6g} s" if frames else ""
    nbytes = sum(one.stat().st_size for one in files)
    return f"{frames} frames{till}; {contacts} contacts; {format_bytes(nbytes)}"


def _energy(results: Results) -> list[tuple[str, str]]:
    """Energy account at the last frame."""
    if not len(results.frames) or (results.scene.row is not None and not results.scene.n_grain):
        return []
    last = {name: float(column[-1]) for name, column in results.tally.items()}
    grain = int(last["overlap_grain"])
    overlap = f"{last['overlap_max']:.3g}, grain {grain}" if grain >= 0 else "0, no contact so far"
    return [*energy_lines(last), ("max overlap/d", overlap)]


def _checkpoint(results: Results) -> str:
    lines: list[str] = []
    for name in (schema.CHECKPOINT, schema.CHECKPOINT_BEFORE):
        path = results.folder / name
        if not path.is_file():
            continue
        try:
            state = read_checkpoint(path, results.scene.n_grain).block("state").values
            lines.append(f"{name} at step {_words(state.get('step'))}, t = {_number(state.get('t')):.6g} s")
        except CheckpointError as error:
            lines.append(str(error))
    return "; ".join(lines) or "none yet"


def _next(results: Results) -> str:
    if results.complete:
        return f"ryusa measure {results.folder} WHAT, ryusa draw {results.folder} WHAT"
    if results.status == schema.RUNNING and holder(results.folder):
        return ""
    engine = results.provenance.get("engine")
    exact = registry.known(engine).exact_resume
    return f"ryusa resume {results.folder}{'' if exact else f' ({_words(engine)}: not bit for bit)'}"


def _words(value: object) -> str:
    """Text from the folder on one line, printable and shortened."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(value)).split())
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _number(value: object, otherwise: float = -1.0) -> float:
    good = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if good else otherwise  # type: ignore[arg-type]


def _table(value: object) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []
