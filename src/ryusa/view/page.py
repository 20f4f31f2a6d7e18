"""One HTML file to look at a run in a browser: grains, walls and water in WebGL2, without a network."""

import base64
import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model import Scene, Walls
from ryusa.model.wall_shape import lines_of, triangles_of
from ryusa.results import Results
from ryusa.running.inspection import state_of
from ryusa.version import __version__
from ryusa.view.box import box_of, needs_grains
from ryusa.view.encode import Blob, add_colours, add_positions, positions, presence
from ryusa.view.flow import flow_of
from ryusa.view.picture import MOST_FACES

HERE = Path(__file__).parent
SCRIPTS = ("decode.js", "linear.js", "draw.js", "overlay.js", "viewer.js", "hands.js")
SIZE = 10.0e6  # of a page, unless asked otherwise [B]
LEAST_SIZE = 2.0e5  # page without grains: script, style, walls [B]
FEW_FRAMES = 60  # frames are thinned down to these before grains are left out,
_FEWEST_FRAMES = 0.75  # or to this share of them, where every grain then has its place
_GUESS = 3.2  # bytes of a page per grain and frame, at first
_TRIES = 5


@dataclass(frozen=True)
class Thinned:
    """Frames and grains of a run that a page shows, shapes (n_frame,) and (n_grain,)."""

    frames: NDArray[np.int64]
    grains: NDArray[np.int64]


def view_page(
    results: Results,
    *,
    begin: float = -math.inf,
    end: float = math.inf,
    size: float = SIZE,
    progress: Callable[[float], None] = lambda share: None,
) -> str:
    """The page of a run.

    Parameters
    ----------
    begin, end : window of time shown [s]; default all frames.
    size : largest size of the page [B]; a longer or larger run is thinned, in time first, then in grains, and
        the page says so.
    progress : called with the share that is done.

    Raises
    ------
    ResultsError : no grains, or no frame in the window.
    """
    data, blob = encoded(results, begin=begin, end=end, size=size, progress=progress)
    return _template("page.html").render(title=data["title"], parts=component([(data, blob)]))


def encoded(
    results: Results,
    *,
    begin: float = -math.inf,
    end: float = math.inf,
    size: float = SIZE,
    progress: Callable[[float], None] = lambda share: None,
) -> tuple[dict[str, Any], str]:
    """What a page shows of a run: a table of keys, and its arrays, compressed and in base64.

    Raises
    ------
    ResultsError : no grains, or no frame in the window.
    """
    needs_grains(results)
    times = results.frames.t
    window = np.flatnonzero((times >= begin) & (times <= end))
    if len(window) == 0:
        span = f"{times[0]:.4g} .. {times[-1]:.4g} s" if len(times) else "no frame"
        raise ResultsError(f"{results.folder}: no frame from {begin:g} to {end:g} s; the run holds {span}")
    cells = max(size - LEAST_SIZE, 1.0) / _GUESS
    for attempt in range(_TRIES):
        chosen = thinned(window, results.scene.n_grain, cells)
        blob = Blob()
        data = _encode(results, chosen, blob, progress)
        text = base64.b64encode(blob.bytes()).decode("ascii")
        if len(text) + LEAST_SIZE <= size or attempt == _TRIES - 1 or _least(chosen):
            return data, text
        cells = 0.97 * len(chosen.frames) * len(chosen.grains) * (size - LEAST_SIZE) / len(text)
    raise AssertionError  # the loop returns


def thinned(window: NDArray[np.int64], n_grain: int, cells: float) -> Thinned:
    """As many of the frames in a window and of n_grain grains as make `cells` grain-frames.

    Frames are evenly spaced, the first and last among them; grains are drawn by lot, the same each time.
    """
    every = np.arange(n_grain)
    most, few = max(int(cells // max(n_grain, 1)), 1), min(FEW_FRAMES, len(window))
    if most < _FEWEST_FRAMES * few:
        most = few
    frames = window
    if len(window) > most:
        frames = window[np.unique(np.rint(np.linspace(0, len(window) - 1, most)).astype(np.int64))]
    room = max(int(cells // len(frames)), 1)
    if n_grain <= room:
        return Thinned(frames, every)
    lot = np.random.default_rng(0).permutation(n_grain)[:room]
    return Thinned(frames, np.sort(lot))


def _least(chosen: Thinned) -> bool:
    return len(chosen.grains) <= 1


def _encode(
    results: Results, chosen: Thinned, blob: Blob, progress: Callable[[float], None]
) -> dict[str, Any]:
    frames, grains, scene = chosen.frames, chosen.grains, results.scene
    whole, quantum = positions(results, frames, grains, lambda row: progress(0.3 * row / len(frames)))
    add_positions(blob, whole)
    there = presence(results, frames, grains)
    if there is not None:
        blob.add("there", there.astype(np.uint8))
    colourings = add_colours(blob, results, frames, grains)
    progress(0.9)
    blob.add("radius", (0.5 * scene.d[grains]).astype(np.float32))
    if len(grains) < scene.n_grain:
        blob.add("id", grains.astype(np.uint32))
    blob.add("fixed", np.column_stack([scene.x_fixed.reshape(-1, 3), 0.5 * scene.d_fixed]).astype(np.float32))
    if scene.walls is not None:
        corners, of = triangles_of(scene.walls)
        if len(corners) > MOST_FACES:
            corners, of = corners[:0], of[:0]
        ends, end_of = lines_of(scene.walls)
        blob.add("wall_faces", corners.astype(np.float32))
        blob.add("wall_face_of", of.astype(np.uint32))
        blob.add("wall_lines", ends.astype(np.float32))
        blob.add("wall_line_of", end_of.astype(np.uint32))
    box = box_of(results, scene.d[grains], (each * quantum for each in whole))
    title = str(results.case.get("title") or results.folder.resolve().name)
    times = results.frames.t[frames]
    data: dict[str, Any] = {
        "title": title,
        "folder": results.folder.resolve().name,
        "version": __version__,
        "status": state_of(results),
        "t": [round(float(t), 9) for t in times],
        "frames": len(results.frames),
        "grains": scene.n_grain,
        "quantum": quantum.tolist(),
        "period": [p if math.isfinite(p) else None for p in scene.period],
        "box": [corner.tolist() for corner in box],
        "plane": scene.plane_case,
        "colourings": colourings,
        "scenes": [_walls(results.scene_at(t), t) for t in _instants(results, times)],
        "flow": flow_of(results, frames, blob),
    }
    data["arrays"] = blob.contents
    return data


def _instants(results: Results, times: NDArray[np.float64]) -> list[float]:
    """Times from which walls, fixed grains or gravity are others [s]: every frame, where there is a servo."""
    begins = [t for _, t, _ in results.scenes]
    return sorted({*begins, *times.tolist()}) if results.scene.has_servo else begins


def _walls(scene: Scene, t: float) -> dict[str, Any]:
    """What of a scene may change with the timeline: fixed grains and planes that are there, gravity."""
    return {
        "t": t,
        "fixed": np.flatnonzero(~scene.fixed_active).tolist(),  # those that are gone
        "planes": [
            {"normal": scene.plane_normal[k].tolist(), "point": scene.plane_point[k].tolist()}
            for k in np.flatnonzero(scene.plane_active)
        ],
        "gravity": scene.gravity.tolist(),
        "walls": [] if scene.walls is None else _motions(scene.walls),
    }


def _motions(walls: Walls) -> list[list[float] | None]:
    """Motion of each wall (model.walls), None where it is gone."""
    return [row.tolist() if there else None for row, there in zip(walls.motion, walls.active, strict=True)]


def script() -> str:
    """The script of the viewer."""
    return "\n".join((HERE / name).read_text(encoding="utf-8") for name in SCRIPTS)


def policy() -> str:
    """Content security policy of a page: its own script and style, nothing from anywhere."""
    digest = base64.b64encode(hashlib.sha256(script().encode()).digest()).decode("ascii")
    return (
        f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


def component(runs: list[tuple[dict[str, Any], str]]) -> dict[str, Markup]:
    """Head and style of a page with viewers, and their data and script; safe to be written as they are."""
    # "<" never occurs in the data: neither "</script>" nor "<!--" of a title can end its element
    shown = [
        {"data": Markup(json.dumps(data).replace("<", "\\u003c")), "blob": Markup(blob)}
        for data, blob in runs
    ]
    return {
        "head": Markup(_template("head.html").render(policy=policy(), version=__version__)),
        "style": Markup((HERE / "viewer.css").read_text(encoding="utf-8")),
        "data": Markup(_template("data.html").render(runs=shown, script=Markup(script()))),
    }


def _template(name: str) -> Any:
    return Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    ).get_template(name)
