"""Rebuild the paper's saltation figures and write what was found into docs: `make figures`."""

import argparse
import platform
from pathlib import Path
from typing import Any

from ryusa.experiments import NAMES, load, run_experiment
from ryusa.running.provenance import commit

PAGE = Path(__file__).parent / "paper-figures.md"
PICTURES = Path(__file__).parent / "pictures"
SHARP = {"fig06": 115, "fig07": 220, "fig07-turning": 220, "fig20": 200, "fig20-hops": 180, "fig21": 220,
         "free-choices": 150}  # pictures of the pages and their dots per inch  # fmt: skip
BEGIN, END = "<!-- written by docs/figures.py: begin -->", "<!-- end -->"
SHOWN = {  # column of the table of choices -> average, scale, digits
    "height / d": ("jump_height", 500.0, 2),
    "length / d": ("jump_length", 500.0, 1),
    "speed [m/s]": ("speed", 1.0, 3),
    "contact time / Eq. (8)": ("contact_time_over_eq8", 1.0, 3),
    "spin [rad/s]": ("spin_before", 1.0, 0),
    "bed shear / normal": ("shear_ratio", 1.0, 2),
}
RATIOS = {  # column of the table of free over locked -> average
    "height": "jump_height",
    "length": "jump_length",
    "bed shear per time": "bed_shear",
    "bed shear per bounce": "impulse_shear",
    "bed shear / normal": "shear_ratio",
}


def main() -> None:
    """Run every experiment (finished runs of the same case are opened) and write the page."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("folder", nargs="?", default="runs/paper", help="where runs, tables and pictures go")
    folder = Path(asked.parse_args().folder)
    verdicts: list[str] = ["| experiment | the paper says | found | |", "|---|---|---|---|"]
    choices: Any = None
    for name in NAMES:
        outcome = run_experiment(name, folder / name, progress=False)
        for one in outcome.verdicts:
            word = one.row()["verdict"]
            verdicts.append(f"| `{name}` ({one.claim}) | {one.says} | {one.found} | {word} |")
        for picture, figure in load(name).draw(outcome.table).items():
            if picture in SHARP:
                PICTURES.mkdir(exist_ok=True)
                figure.savefig(PICTURES / f"{picture}.png", dpi=SHARP[picture], pil_kwargs={"optimize": True})
        choices = outcome.table if name == "free_choices" else choices
        print(f"{name}: {load(name).TITLE}: {folder / name}", flush=True)
    made = f"Made by `make figures` on {_machine()}, {_versions()}, commit {commit() or 'not known'}."
    text = PAGE.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN, 1)
    _, tail = rest.split(END, 1)
    parts = [made, "## What the paper says, and what was found", "\n".join(verdicts), *_choices(choices)]
    PAGE.write_text(f"{head}{BEGIN}\n\n" + "\n\n".join(parts) + f"\n\n{END}{tail}", encoding="utf-8")


def _choices(table: Any) -> list[str]:
    """Write a table per state of rotation: every free choice of the paper, changed one at a time."""
    parts: list[str] = []
    for rotation in ("locked", "free"):
        lines = [f"| changed | {' | '.join(SHOWN)} |", "|---" * (len(SHOWN) + 1) + "|"]
        for (label, state), found in table.found.items():
            if state == rotation:
                cells = [_cell(found[name], scale, digits) for name, scale, digits in SHOWN.values()]
                lines.append(f"| {label} | {' | '.join(cells)} |")
        parts += [f"## Effect of every free choice, rotation {rotation}", "\n".join(lines)]
    lines = [f"| changed | {' | '.join(RATIOS)} | highest jump / d |", "|---" * (len(RATIOS) + 2) + "|"]
    for (label, state), free in table.found.items():
        locked = table.found.get((label, "locked"))
        if state == "free" and locked is not None:
            cells = [_ratio(free[name], locked[name]) for name in RATIOS.values()]
            tops = [f"{one.hops['rise'].max() / table.d:.1f}" for one in (locked, free)]
            lines.append(f"| {label} | {' | '.join(cells)} | {' and '.join(tops)} |")
    return [*parts, "## Effect of every free choice on free over locked", "\n".join(lines)]


def _ratio(above: Any, below: Any) -> str:
    value = above.value / below.value
    error = abs(value) * ((above.error / above.value) ** 2 + (below.error / below.value) ** 2) ** 0.5
    return f"{value:.2f} ± {error:.2f}"


def _cell(average: Any, scale: float, digits: int) -> str:
    value, error = scale * average.value, scale * average.error
    return f"{value:.{digits}f} ± {error:.{digits}f}" if value or error else "0"


def _machine() -> str:
    try:
        info = Path("/proc/cpuinfo").read_text(encoding="utf-8")
        names = [line.split(":", 1)[1].strip() for line in info.splitlines() if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()


def _versions() -> str:
    import numba
    import numpy as np

    import ryusa

    return f"ryusa {ryusa.__version__}, numba {numba.__version__}, numpy {np.__version__}"


if __name__ == "__main__":
    main()
