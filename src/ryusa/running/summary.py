"""Summary of a run in a few lines, from the content of summary.json."""

from typing import Any

from ryusa.model import Flow
from ryusa.running.energy_terms import energy_lines

_WORTH_SAYING = 0.05  # [s] of compiling
_NOT_MEASURED = "not at all (no contact between two isolated grains)"
_WAYS = {  # of impacts, by what the summary calls them, and what is to be said of each
    "sticking": ("without sliding", ""),
    "sliding": ("with sliding", ", where friction decides and not this number"),
}


def summary_lines(summary: dict[str, Any], flow: Flow | None = None) -> list[str]:
    """Largest overlap, steps per contact, restitution, energy, warnings; of the water in what it flows."""
    recorded = summary.get("events") != "none"
    water = [] if flow is None else [f"water: {flow.account(summary['water'])}"]
    if summary.get("water", {}).get("grains") == 0:
        return _of_water(summary, water)
    contacts = f"{summary['contacts']} contacts" if recorded else "contacts not recorded"
    lines = [
        f"{summary['steps']} steps, {summary['frames']} frames, {contacts}: {_took(summary)} "
        f"({summary['particle_steps_per_second'] / 1e6:.2f} M particle-steps/s)",
        f"largest overlap/d {summary['overlap']['largest_over_d']:.3g} (stable range {_band(summary)})",
        _steps(summary["steps_per_contact"]),
        *(_contacts(summary) if recorded else ()),
    ]
    headings = {"dissipated": "energy dissipated", "imbalance": "energy imbalance"}
    lines += [f"{headings.get(name, name)}: {text}" for name, text in energy_lines(summary["energy"])]
    if "traffic" in summary:
        lines.append(_traffic(summary["traffic"]))
    lines += water
    if "precision" in summary:
        lines.append(f"precision: {summary['precision']['text']}")
    return lines + [f"warning: {warning}" for warning in summary["warnings"]]


def _took(summary: dict[str, Any]) -> str:
    """Wall time in which the run compiled, where it did, and of the rest of it."""
    compiled = summary.get("compiled", 0.0)
    before = f"compiled {compiled:.1f} s, " if compiled >= _WORTH_SAYING else ""
    return f"{before}stepped and recorded {summary['wall'] - compiled:.1f} s"


def _of_water(summary: dict[str, Any], water: list[str]) -> list[str]:
    """Lines of a run without a grain."""
    done = f"{summary['steps']} steps, {summary['frames']} frames: {_took(summary)}"
    return [done, *water, *(f"warning: {warning}" for warning in summary["warnings"])]


def _contacts(summary: dict[str, Any]) -> list[str]:
    """Lines that need recorded contacts."""
    shear = summary["restitution_shear"]
    why = "an oblique impact rotates the normal, which changes it by a few per cent (design/0006)"
    if summary["restitution"].get("clumps"):
        why += "; a clump hit off its centre has less effective mass, and rebounds less (design/0022)"
    if summary["restitution"].get("adhesion"):
        why += "; adhesion takes more from slow impacts (design/0024)"
    seen = [
        f"{way} {_measured(shear[name])}{note}"
        for name, (way, note) in _WAYS.items()
        if any(one["n"] for one in shear[name].values())
    ]
    return [
        f"restitution: {_set(summary['restitution'])}; measured {_measured(summary['restitution'])}; {why}",
        f"tangential restitution: {_set(shear)}; measured {'; '.join(seen) or _NOT_MEASURED}",
    ]


def _traffic(found: dict[str, Any]) -> str:
    feeds = [f"{one['entered']} in by '{one['name']}'" for one in found["feeds"]]
    exits = [f"{one['left']} out by '{one['name']}'" for one in found["exits"]]
    return f"grains: {', '.join([*feeds, *exits])}; {found['present']} there at the end"


def _band(summary: dict[str, Any]) -> str:
    low, high = summary["overlap"]["band"]
    return f"{low:g} to {high:g}"


def _steps(steps: dict[str, Any]) -> str:
    seen = steps["observed"]
    text = f"steps per contact: {steps['shortest']:.1f} in the shortest possible contact"
    if not seen["n"]:
        return text
    return (
        f"{text}; observed minimum {seen['least']:.1f}, 1 % quantile {seen['q01']:.1f}, "
        f"median {seen['q50']:.1f}, 99 % quantile {seen['q99']:.3g}, maximum {seen['most']:.3g}"
    )


def _measured(averages: dict[str, Any]) -> str:
    parts: list[str] = []
    for partner in ("fixed", "free"):
        one = averages[partner]
        if one["n"]:
            error = "" if one["standard_error"] is None else f" +- {one['standard_error']:.1g}"
            parts.append(f"{one['mean']:.4f}{error} against {partner} grains ({one['n']} contacts)")
    return ", ".join(parts) or _NOT_MEASURED


def _set(restitution: dict[str, Any]) -> str:
    """Value set by the case, or the one that its constant dashpots give for the mean grain."""
    if restitution["asked"] is not None:
        return f"{restitution['asked']:g} set"
    if "by_pair" in restitution:
        return "set by pair of materials"
    follows = [f"{e:.4f} against {name}" for name, e in restitution["follows"].items() if e is not None]
    return f"{', '.join(follows)} grains from constant dashpots" if follows else "not set"
