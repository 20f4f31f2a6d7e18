"""Goldens: numbers of a few short runs, kept with the recipe that made them.

Each folder beside this file is one golden. Its `how.toml` begins with the recipe, which a person writes: the
command, the tolerance, and why both are what they are. Below the recipe follows the certificate, and
`values.json` holds the numbers; both are written by `make golden`, never by hand.

    python tests/golden/goldens.py           run every recipe, renew what moved and say what moved
    python tests/golden/goldens.py --check   the same comparison, nothing is written; exit code 1 on a move
"""

import argparse
import hashlib
import json
import shlex
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.results import Results

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
CERTIFICATE = "# ---- written by `make golden`: do not edit below this line ----"
PACKAGES = ("numpy", "numba", "llvmlite")  # what the bits of a compiled kernel depend on


@dataclass(frozen=True)
class Golden:
    """One folder: recipe, certificate and numbers; the last two are empty before the first run."""

    name: str
    recipe: dict[str, Any]
    certificate: dict[str, Any]
    values: dict[str, Any]

    @property
    def folder(self) -> Path:
        return HERE / self.name


@dataclass(frozen=True)
class Outcome:
    """What a run of a recipe gave: its certificate and its numbers."""

    certificate: dict[str, Any]
    values: dict[str, Any]


def names() -> list[str]:
    """Names of all goldens."""
    return sorted(path.parent.name for path in HERE.glob("*/how.toml"))


def read(name: str) -> Golden:
    how = tomllib.loads((HERE / name / "how.toml").read_text(encoding="utf-8"))
    values = HERE / name / "values.json"
    kept = json.loads(values.read_text(encoding="utf-8")) if values.exists() else {}
    return Golden(name, how["recipe"], how.get("certificate", {}), kept)


def make(golden: Golden, folder: Path) -> Outcome:
    """Run a recipe into a run folder and read its numbers."""
    program, *words = shlex.split(golden.recipe["command"])
    assert program == "ryusa", golden.recipe["command"]
    done = subprocess.run(
        [sys.executable, "-m", "ryusa", *words, "--quiet", "--overwrite", "-o", str(folder)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        raise SystemExit(f"{golden.name}: {golden.recipe['command']}\n{done.stdout}{done.stderr}")
    results = Results.open(folder)
    return Outcome(_certificate(results), _values(results))


def _certificate(results: Results) -> dict[str, Any]:
    found = results.provenance
    return {
        "commit": found["commit"] or "unknown",
        "date": found["begin"],
        "seed": found["seed"],
        "ryusa": found["ryusa"],
        "python": found["python"],
        **{name: found["packages"][name] for name in PACKAGES},
        "processor": found["machine"]["processor"],
        "architecture": found["machine"]["architecture"],
        "target": _target(),
    }


def _target() -> str:
    """Processor that Numba compiles for."""
    from llvmlite import binding
    from numba import config

    return str(getattr(config, "CPU_NAME", None) or binding.get_host_cpu_name())


def _values(results: Results) -> dict[str, Any]:
    """Numbers of the last frame by group, exact counts, and hashes of the bits."""
    last, tally = results.frames[-1], results.tally
    x, v, omega = (np.asarray(one, dtype=np.float64) for one in (last.x, last.v, last.omega))
    contacts = results.contacts
    groups: dict[str, dict[str, float]] = {
        "position_m": {
            "mean_x": float(x[:, 0].mean()),
            "mean_z": float(x[:, 2].mean()),
            "least_z": float(x[:, 2].min()),
            "largest_z": float(x[:, 2].max()),
        },
        "velocity_m_per_s": {
            "mean_x": float(v[:, 0].mean()),
            "mean_z": float(v[:, 2].mean()),
            "largest_speed": float(np.linalg.norm(v, axis=1).max()),
        },
        "spin_rad_per_s": {
            "mean_y": float(omega[:, 1].mean()),
            "largest": float(np.linalg.norm(omega, axis=1).max()),
        },
        "height_J": {name: float(tally[name][-1]) for name in _HEIGHT},
        "energy_J": {
            name: float(tally[name][-1])
            for name in tally
            if tally[name].dtype == np.float64 and name not in _NO_TERM and tally[name][-1] != 0.0
        },
        "overlap_over_d": {"largest": float(tally["overlap_max"][-1])},
        "contact_s": {"summed_duration": float(np.nansum(contacts["t_end"] - contacts["t_begin"]))},
    }
    if results.water is not None:
        groups["water_m_per_s"] = {
            "mean_u": float(results.water.u[-1].mean()),
            "largest_u": float(results.water.u[-1].max()),
        }
    hashes = {"x": x, "v": v, "omega": omega, "contacts": contacts}
    if results.water is not None:
        hashes["water"] = results.water.u[-1]
    return {
        "counts": {
            "steps": int(last.step),
            "grains": len(x),
            "contacts_now": int(tally["n_contact"][-1]),
            "contacts_ended": len(contacts),
        },
        "numbers": groups,
        "bits": {name: hashlib.sha256(one.tobytes()).hexdigest() for name, one in hashes.items()},
    }


_HEIGHT = ("potential", "start")  # from an origin that is free to choose: large beside the other terms
_NO_TERM = {*_HEIGHT, "t", "overlap_max", "speed_max", "spin_max", "imbalance", "residual"}


def same_machine(kept: dict[str, Any], found: dict[str, Any]) -> bool:
    """Whether bits may be compared: the same processor, target and versions of what compiles the kernels."""
    return all(kept.get(key) == found.get(key) for key in (*PACKAGES, "processor", "target"))


def moved(kept: dict[str, Any], found: dict[str, Any], tolerance: float) -> list[str]:
    """Numbers that differ by more than `tolerance` times the largest of their group; counts that differ.

    A group holds numbers of one unit, so that a mean near zero is judged by the size of what it averages.
    """
    said = [
        f"{name}: {kept['counts'].get(name)} -> {value}"
        for name, value in found["counts"].items()
        if kept["counts"].get(name) != value
    ]
    for group, numbers in found["numbers"].items():
        before = kept["numbers"].get(group, {})
        if before.keys() != numbers.keys():
            said.append(f"{group}: {sorted(before)} -> {sorted(numbers)}")
            continue
        size = max(abs(value) for value in before.values())
        for name, value in numbers.items():
            off = abs(value - before[name])
            if not off <= tolerance * size:
                said.append(
                    f"{group}.{name}: {before[name]!r} -> {value!r}, {off / (size or 1.0):.2g} of {group}"
                )
    return said


def largest_move(kept: dict[str, Any], found: dict[str, Any]) -> float:
    """Largest difference of a number over the largest of its group [-]."""
    moves = [0.0]
    for group, numbers in found["numbers"].items():
        before = kept["numbers"].get(group, {})
        size = max((abs(value) for value in before.values()), default=0.0)
        moves += [
            abs(value - before[name]) / size for name, value in numbers.items() if name in before and size
        ]
    return max(moves)


def bits_moved(kept: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """Arrays whose bits differ."""
    return [name for name in found["bits"] if kept["bits"].get(name) != found["bits"][name]]


def write(golden: Golden, found: Outcome) -> None:
    """Keep numbers and certificate; the recipe stays as it is written."""
    values = json.dumps(found.values, indent=1) + "\n"
    (golden.folder / "values.json").write_text(values, encoding="utf-8")
    path = golden.folder / "how.toml"
    recipe = path.read_text(encoding="utf-8").partition(CERTIFICATE)[0].rstrip()
    lines = [f"{key} = {json.dumps(value)}" for key, value in found.certificate.items()]
    path.write_text("\n".join([recipe, "", CERTIFICATE, "[certificate]", *lines, ""]), encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """Run all recipes and say what moved; renew what moved, unless --check is given."""
    parser = argparse.ArgumentParser(description="Renew the goldens.")
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("name", nargs="*", help="goldens to run; all if none")
    wanted = parser.parse_args(arguments)
    count = 0
    for name in wanted.name or names():
        golden = read(name)
        with tempfile.TemporaryDirectory() as folder:
            found = make(golden, Path(folder) / name)
        if not golden.values:
            print(f"{name}: new")
        else:
            bits = bits_moved(golden.values, found.values)
            lines = moved(golden.values, found.values, golden.recipe["tolerance"])
            if not bits and not lines:
                print(f"{name}: every bit as kept")
                continue
            same = same_machine(golden.certificate, found.certificate)
            where = "the same machine" if same else "another machine"
            off = largest_move(golden.values, found.values)
            print(f"{name}: on {where} bits differ in {', '.join(bits) or 'nothing'}; by {off:.1e} at most,")
            print(f"  tolerance {golden.recipe['tolerance']:g}")
            for line in lines:
                print(f"  {line}")
        count += 1
        if not wanted.check:
            write(golden, found)
    return 1 if wanted.check and count else 0


if __name__ == "__main__":
    sys.exit(main())
