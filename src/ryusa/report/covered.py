"""What a brief says of a case: its conditions, what the answer rests on, and what it does not cover."""

import math
import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ryusa.report.contents import ExplainedValue
from ryusa.results import Results

_FINE = ("contact.parting", "contact.slip", "contact.damping_law", "contact.unloading")  # no client asks
_DRIVEN = (": moves", ": presses with")  # of a wall
Rows = list[tuple[str, str]]
SOME, WALLS = 4, 6  # items of a list that are shown
LONGEST = 230  # characters of a warning that are shown


def conditions(runs: Sequence[Results], values: Sequence[ExplainedValue]) -> Rows:
    """Headings and texts of the table of conditions; those that a case has not are left out."""
    first = runs[0]
    case, explained = first.case, {one.name: one for one in values}
    settle = float((case.get("record") or {}).get("settle") or 0.0)
    left_out = f"; averages leave out the first {settle:.3g} s" if settle > 0.0 else ""
    slope = float(case["motion"]["slope_angle"])
    seeds = ", ".join(str(one.provenance.get("seed")) for one in runs)
    rows = [
        ("Geometry", _geometry(first)),
        ("Dams", _some(_dam(one) for one in values if one.name.startswith("dam '"))),
        ("Walls", _some((_wall(one) for one in values if one.name.endswith(": size in x, y, z")), WALLS)),
        (
            "Driven by",
            _some(
                f"{one.name.replace(': ', ' ')} {one.shown}" for one in values if one.name.endswith(_DRIVEN)
            ),
        ),
        ("Grains", _grains(first)),
        ("Feeds", _some(_feed(one) for one in case.get("feeds") or [])),
        ("Water", _water(first, explained)),
        ("Slope", f"{math.tan(slope):.4g} ({math.degrees(slope):.3g}°)" if slope else ""),
        ("Events", _some(text for one in case.get("timeline") or [] if (text := _event(one)))),
        ("Duration", f"{_end(runs):.4g} s{left_out}"),
    ]
    if first.scene.n_grain:
        rows.append(("Runs", f"{len(runs)}, random seed{'s' * (len(runs) > 1)} {seeds}"))
    return [(heading, text) for heading, text in rows if text]


def rests_on(runs: Sequence[Results], values: Sequence[ExplainedValue]) -> Rows:
    """Headings and texts on model, laws with their sources, checks, warnings, program and run folders."""
    first = runs[0]
    origins = {
        f"{one.get('ryusa')} ({str(one.get('commit') or 'no commit')[:10]}, engine {one.get('engine')})": None
        for one in (run.provenance for run in runs)
    }
    folders = _some((run.folder.resolve().name for run in runs), 2 * SOME).replace("; ", ", ")
    every = [str(text) for run in runs for text in run.summary.get("warnings") or []]
    warnings = {re.sub(r"[\d.e+-]+", "", text): text for text in every}  # one of those that differ in numbers
    rows = [
        ("Model", _model(first)),
        ("Laws", _laws(values)),
        ("Checks", _checks(runs)),
        ("Warnings", _some((_clipped(one) for one in warnings.values()), 2) or "none"),
        ("Made by", f"ryusa {', '.join(origins)}; run folder{'s' * (len(runs) > 1)} {folders}"),
    ]
    return [(heading, text) for heading, text in rows if text]


def not_covered(runs: Sequence[Results]) -> list[str]:
    """Sentences on what the runs say nothing of, from the choices of their case alone."""
    first = runs[0]
    case, scene = first.case, first.scene
    water, contact = case.get("water") or {}, case.get("contact") or {}
    row, grains = first.row, bool(scene.n_grain)
    periodic = math.isfinite(scene.period[0])
    rolling = "no" if (case.get("rolling") or {}).get("model") == "none" else "a"
    wide = float(scene.d.max() / scene.d.min()) if grains else 1.0
    d = scene.d_mean if grains else math.nan
    dry = grains and not water
    dams = row is not None and any(not one.porous for one in row.row.dams)
    aerated = row is not None and any(one.aerated for one in row.row.dams)
    across = scene.period[1]
    if row is not None and not math.isfinite(across):
        across = float(water["row"].get("width") or math.inf)
    said = {
        "Scour under a jet, flow round a pier, short waves: the water is hydrostatic.":
        row is not None and row.row.hydrostatic,
        f"Flow round a pier, {'' if aerated else 'air under a nappe, '}breakers: the surface has one height "
        "at each place.": row is not None and not row.row.hydrostatic,
        "How deep a jet digs in the end: in a row it digs a fifth of what formulae expect.":
        aerated and grains,
        "The blow of a bore on the dam, uplift, friction of the water.": dams,
        "Whether the dam stands the load.": dams,
        f"Peaks shorter than {case['record']['frames']:g} s, the time between two records.": dams and grains,
        "What grains do to the water: its velocity is given.":
        bool(water) and water.get("profile") != "column" and grains,
        "Water and air in the pores: the grains are dry.": dry,
        "Bed forms, bends, banks, a supply that runs short: the reach repeats itself.":
        periodic and bool(water),
        "Ends: the layer repeats itself.": periodic and not water,
        f"Other widths than {_length(across)}, {across / d:.0f} grain diameters"
        f"{', periodic' * math.isfinite(scene.period[1])}.": math.isfinite(across) and grains,
        "Bends, banks and side walls: the flow is the same over the width.": row is not None and not grains,
        "Grains that pass each other sideways: they move in one plane.": scene.plane_case and grains,
        "Cohesion: silt, clay, moist grains.":
        grains and not contact.get("cohesion") and contact.get("adhesion") == "none",
        f"Angular or flat grains: they are spheres, with {rolling} rolling friction.":
        grains and (case.get("grains") or {}).get("shape") == "sphere",
        "Mixtures: all grains are of one size.": grains and wide == 1.0,
        f"Wider mixtures: the largest grain is {wide:.2g} times the smallest.": grains and 1.0 < wide < 3.0,
        "Sediment: the bed is fixed.": not grains and row is not None,
        f"Times after {_end(runs):.4g} s.": not periodic,
        f"Slow changes: the record is {_end(runs):.4g} s long.": periodic,
        "Other scales than the one computed.": not periodic,
        "Breakage and wear of grains.": dry,
    }  # fmt: skip
    return [text for text, applies in said.items() if applies]


def _end(runs: Sequence[Results]) -> float:
    return max(float(one.frames.t[-1]) if len(one.frames) else 0.0 for one in runs)


def _geometry(first: Results) -> str:
    scene, build = first.scene, first.case.get("build") or {}
    if first.row is not None:
        keys = first.case["water"]["row"]
        width = f", {_length(float(keys['width']))} wide" if keys.get("width") else ", per metre of width"
        points = keys.get("bottom")
        line = ""
        if isinstance(points, list) and len(points) <= SOME:
            line = "; bottom at " + ", ".join(f"z = {_length(z)} (x = {x:g} m)" for x, z in points)
        return f"{first.row.row.n_segment * first.row.row.dx:.4g} m long{width}{line}"
    if math.isfinite(scene.period[0]):
        sides = [_length(one) for one in scene.period if math.isfinite(one)]
        layers = f", {build['layers']:g} layers of grains" if build.get("layers") else ""
        return f"periodic over {' x '.join(sides)}{layers}"
    x = np.asarray(first.frames.x[0], dtype=np.float64)
    x = x[np.isfinite(x[:, 0])]
    if not len(x):
        return ""
    sides = (x.max(axis=0) - x.min(axis=0) + scene.d_mean)[[0, 2] if scene.plane_case else [0, 1, 2]]
    return f"grains at the start within {' x '.join(_length(one) for one in sides)}"


def _grains(first: Results) -> str:
    scene, case = first.scene, first.case
    keys, contact = case.get("grains") or {}, case.get("contact") or {}
    if not scene.n_grain:
        return f"none; roughness of the bottom {_length(float(case['water']['roughness']))}"
    low, high = float(scene.d.min()), float(scene.d.max())
    sizes = _length(scene.d_mean) if high - low < 1e-9 * high else f"{_length(low)} to {_length(high)}"
    shape = str(keys.get("shape") or "sphere")
    rolling = (case.get("rolling") or {}).get("model")
    angle = math.degrees(float(contact.get("friction_angle") or 0.0))
    fed = scene.traffic is not None and len(scene.traffic.feeds) > 0
    kind = "spheres" if shape == "sphere" else f"clumps ({shape})"
    words = [
        f"{'up to ' * fed}{int(scene.heads.sum())} {kind} of {sizes}",
        f"{float(keys.get('density') or math.nan):.4g} kg/m³", f"friction angle {angle:.3g}°",
        f"restitution {contact['restitution']:g}" if contact.get("restitution") is not None else "",
        f"rolling friction {'none' if rolling == 'none' else case['rolling']['coefficient']}",
    ]  # fmt: skip
    return ", ".join(one for one in words if one)


def _water(first: Results, explained: dict[str, ExplainedValue]) -> str:
    water = first.case.get("water")
    if not water:
        return "none (dry)"
    names = ("discharge", "hydrograph", "critical depth") if first.row is not None else ("depth", "tau_star")
    words = {"tau_star": "Shields number of the case"}
    said = [f"{words.get(name, name)} {explained[name].shown}" for name in names if name in explained]
    if "ends" in explained:
        up, _, down = explained["ends"].shown.partition(" - ")
        said.append(f"ends: {up} upstream, {down} downstream")
    if water.get("profile") != "column":
        said.insert(0, f"velocity given ({water['profile']})")
    return ", ".join(said)


def _wall(one: ExplainedValue) -> str:
    shape = one.origin.partition(";")[0]
    size = re.sub(r"(?<![\d.])0 x ", "", one.shown.replace(" x 0 cm", " cm"))
    return f"{one.name.partition(':')[0]}, {shape} {size}"


def _feed(one: Any) -> str:
    rate = one.get("rate")
    how = f"{rate[0]:g} {rate[1]}" if isinstance(rate, list | tuple) else f"{rate:g} kg/s" if rate else ""
    return f"“{one['name']}” {how}".strip()


def _event(event: Any) -> str:
    what: list[str] = []
    for name, value in event.items():
        if name == "at" or value is None:
            continue
        if name in {"remove", "move"}:
            wall = value["wall"] if isinstance(value, dict) else value
            what.append(f"“{wall}” {'is taken away' if name == 'remove' else 'begins to move'}")
        else:
            shown = f"{math.degrees(value):.3g}°" if name.endswith("angle") else f"{value}"
            what.append(f"{name.replace('_', ' ')} {shown}")
    return f"at {event['at']:g} s {', '.join(what)}" if what else ""


def _model(first: Results) -> str:
    scene, row = first.scene, first.row
    steps = f"Distinct-element method: the motion of every grain, in steps of {1e6 * scene.dt:.2g} µs. "
    water = "No water."
    if row is not None:
        water = (
            f"Water: {row.row.n_segment} vertical columns along the stream, of {row.row.column.n} cells, "
            f"{'hydrostatic' if row.row.hydrostatic else 'with a pressure of its own'}"
            f"{', with the momentum that grains take and give' * bool(scene.n_grain)}."
        )
    elif scene.column is not None:
        water = f"Water: a column of {scene.column.n} cells that grains slow down and that carries them."
    elif first.case.get("water"):
        water = "Water: a given velocity."
    return (steps if scene.n_grain else "") + water


def _laws(values: Sequence[ExplainedValue]) -> str:
    """Choices with a published source, one for each family of laws."""
    found: list[str] = []
    for one in values:
        parts = [part.strip() for part in one.origin.partition(f" ({one.name} not given)")[0].split(";")]
        source = "; ".join(part for part in parts if re.search(r"\b(1[89]|20)\d\d$", part))
        if one.section != "laws" or one.name.startswith(_FINE):
            continue
        if one.shown != "none" and source:
            subject = one.name.rpartition(".")[2].replace("_", " ")
            found.append(
                f"{subject} {one.shown} ({source})" if one.shown not in source else f"{subject} ({source})"
            )
        elif one.name == "contact.law":
            found.append(f"contacts {one.shown} (Osada, Shimizu & Wakai 2004)")
    return ", ".join(found)


def _checks(runs: Sequence[Results]) -> str:
    overlaps = [float((one.summary.get("overlap") or {}).get("largest_over_d") or math.nan) for one in runs]
    rest = [float((one.summary.get("energy") or {}).get("residual") or math.nan) for one in runs]
    if not runs[0].scene.n_grain or not np.isfinite(overlaps).any():
        return ""
    text = f"grains overlap by at most {100.0 * np.nanmax(overlaps):.2g} % of a diameter"
    if np.isfinite(rest).any():
        text += f"; energy is accounted for to {np.nanmax(rest):.0e} of its largest term"
    return text


def _dam(one: ExplainedValue) -> str:
    where = one.origin.partition("over the bottom at its foot, ")[2].partition(";")[0]
    return f"“{one.name[5:-1]}” {one.shown} high{f', {where}' * bool(where)}"


def _some(texts: Iterable[str], most: int = SOME) -> str:
    every = list(texts)
    more = f"; and {len(every) - most} more" if len(every) > most else ""
    return "; ".join(every[:most]) + more


def _clipped(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[:LONGEST].rsplit(' ', 1)[0]} ..."


def _length(value: float) -> str:
    """A length in the unit that suits it.

    >>> _length(0.004), _length(0.096), _length(1.5), _length(0.0)
    ('4 mm', '9.6 cm', '1.5 m', '0 m')
    """
    size = abs(value)
    if size >= 1.0 or size == 0.0:
        return f"{value:.4g} m"
    return f"{1e2 * value:.3g} cm" if size >= 0.01 else f"{1e3 * value:.3g} mm"
