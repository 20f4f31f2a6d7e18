"""The question that a run answers: that of the packaged case which its own case resembles most."""

import math
from collections.abc import Mapping
from typing import Any

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.cases.questions import QUESTIONS, CaseQuestion
from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

STEEP = (0.0, 0.03, 0.15)  # slopes [-]: a river, a torrent, a debris flow; for the choice of a question alone


def question_of(case: Mapping[str, Any], like: str | None = None) -> tuple[CaseQuestion, str]:
    """The question of the packaged case that has most in common with a case, and the name of that case.

    Parameters
    ----------
    case : as a run folder holds it.
    like : name of a packaged case whose question is taken instead.

    Raises
    ------
    CaseError : no packaged case has that name.
    """
    known = {name: one for one in QUESTIONS for name in one.cases}
    if like is not None:
        if like not in known:
            allowed = f"must be a packaged case: {', '.join(known)}"
            raise CaseError("--like", like, allowed, nearest_word(like, tuple(known)))
        return known[like], like
    own = _features(case)

    def alike(name: str) -> int:
        other = _features(read(case_path(f"{name}.toml")).model_dump())
        return sum(a == b for a, b in zip(own, other, strict=True))

    name = max(known, key=alike)  # of several the first
    return known[name], name


def _features(case: Mapping[str, Any]) -> tuple[object, ...]:
    """What kind of case it is: how grains are laid, its water, dams, walls, feeds, exits and events."""
    water, motion = case.get("water") or {}, case.get("motion") or {}
    row, walls = water.get("row") or {}, case.get("walls") or []
    kind = str((case.get("build") or {}).get("kind"))
    events = {
        name
        for event in case.get("timeline") or []
        for name, value in event.items()
        if name != "at" and value is not None
    }
    upstream, downstream = ((row.get(end) or {}).get("end") for end in ("upstream", "downstream"))
    return (
        row.get("pressure"),
        kind, kind == "stream", "row" if row else water.get("profile"), upstream, downstream,
        bool(row.get("dams")), bool(case.get("feeds")), bool(case.get("exits")), bool(walls),
        any(one.get("servo") for one in walls), any(one.get("angular_velocity") for one in walls),
        any(_level_axis(one) for one in walls), bool(motion.get("plane", True)), _steepness(motion),
        "remove" in events, "move" in events, bool(events & {"slope", "slope_angle"}),
        bool(events & {"discharge", "level"}),
    )  # fmt: skip


def _level_axis(wall: Mapping[str, Any]) -> bool:
    """Whether a wall turns about a horizontal axis, as a drum does."""
    return any(wall.get("angular_velocity") or ()) and not wall["angular_velocity"][2]


def _steepness(motion: Mapping[str, Any]) -> int:
    """Number of the `STEEP` slopes that the x axis exceeds; 0 for one that is level."""
    slope = motion.get("slope") or math.tan(motion.get("slope_angle") or 0.0)
    return sum(slope > one for one in STEEP)
