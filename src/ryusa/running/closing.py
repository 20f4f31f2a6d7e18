"""What is said when a run ends: summary.json in a few lines."""

from typing import Any

from ryusa.model import Book
from ryusa.model.tally import GIFTS, HELD, LOSSES

_ACCOUNT = (
    ("held", (*HELD, Book.START.name.lower())),
    ("lost", tuple(book.name.lower() for book in LOSSES)),
    ("given", tuple(book.name.lower() for book in GIFTS)),
)


def closing_lines(summary: dict[str, Any]) -> list[str]:
    """Largest overlap, steps per contact, restitution, energy account, warnings."""
    recorded = summary.get("events") != "none"
    contacts = f"{summary['contacts']} contacts" if recorded else "contacts not recorded,"
    lines = [
        f"{summary['steps']} steps, {summary['frames']} frames, {contacts} "
        f"in {summary['wall']:.1f} s ({summary['particle_steps_per_second'] / 1e6:.2f} M particle-steps/s "
        "once compiled)",
        f"largest overlap/d {summary['overlap']['largest_over_d']:.3g} (stable band {_band(summary)})",
        _steps(summary["steps_per_contact"]),
        *(_contacts(summary) if recorded else ()),
    ]
    energy = summary["energy"]
    for what, names in _ACCOUNT:
        lines.append(f"energy {what} [J]: " + ", ".join(f"{name} {energy[name]:.3g}" for name in names))
    lines.append(f"energy not explained [J]: {energy['imbalance']:.2g}, residual {energy['residual']:.1e}")
    if "water" in summary:
        lines.append(_water(summary["water"]))
    return lines + [f"warning: {warning}" for warning in summary["warnings"]]


def _contacts(summary: dict[str, Any]) -> list[str]:
    """What only recorded contacts tell."""
    shear = summary["restitution_shear"]
    return [
        f"restitution {_asked(summary['restitution'])}, got {_got(summary['restitution'])}; "
        "oblique hits turn the normal and return a few per cent more or less (design/0006)",
        f"tangential restitution {_asked(shear)}, got sticking: {_got(shear['sticking'])}; "
        f"sliding: {_got(shear['sliding'])}",
    ]


def _water(found: dict[str, Any]) -> str:
    return (
        f"water: {found['exchanges']} exchanges, the last {found['steps_between']} steps apart; "
        f"discharge {found['discharge']:.3g} m2/s, stress under the grains, on the floor of the column, "
        f"{found['bed_stress']:.3g} Pa; "
        f"momentum not explained {found['momentum_residual']:.1e} of the largest term"
    )


def _band(summary: dict[str, Any]) -> str:
    low, high = summary["overlap"]["band"]
    return f"{low:g} to {high:g}"


def _steps(steps: dict[str, Any]) -> str:
    seen = steps["observed"]
    text = f"steps per contact: shortest that can occur {steps['shortest']:.1f}"
    if not seen["n"]:
        return text
    return (
        f"{text}; observed least {seen['least']:.1f}, 1 % {seen['q01']:.1f}, median {seen['q50']:.1f}, "
        f"99 % {seen['q99']:.3g}, most {seen['most']:.3g}"
    )


def _got(averages: dict[str, Any]) -> str:
    said: list[str] = []
    for partner in ("fixed", "free"):
        one = averages[partner]
        if one["n"]:
            error = "" if one["standard_error"] is None else f" +- {one['standard_error']:.1g}"
            said.append(f"{one['mean']:.4f}{error} on {partner} ({one['n']})")
    return ", ".join(said) or "none (no such contact of two grains alone)"


def _asked(restitution: dict[str, Any]) -> str:
    """What the case asks for, or what its constant dashpots give the mean grain."""
    if restitution["asked"] is not None:
        return f"asked {restitution['asked']:g}"
    follows = [f"{e:.4f} on {name}" for name, e in restitution["follows"].items() if e is not None]
    return f"of constant dashpots {', '.join(follows)}" if follows else "asked nothing"
