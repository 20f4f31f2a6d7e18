"""The table in Markdown, from the figures kept as JSON."""

from typing import Any

from speed import summary
from workloads import DROP, FULL, TOTAL

SLIPS = {"LAMMPS": TOTAL, "LIGGGHTS": DROP, "YADE": DROP}
ASKED = {"LAMMPS": 3.0, "LIGGGHTS": 5.0, "YADE": 25.0}
ASKED_LARGE = 2.5  # of LAMMPS at 200k
EFFICIENCY, MEMORY = 0.9, 700  # on two threads at 20k and above; B a grain at a million
LARGE = 100_000


def markdown(state: dict[str, Any]) -> str:
    """Write the whole page."""
    machine = state["machine"]
    lines = [
        "# ryusa beside LAMMPS, LIGGGHTS and YADE",
        "",
        f"{machine['cpu']}, {machine['cores']} cores ({machine['vectors']}; "
        f"{machine['caches']}), {machine['memory']}, {machine['system']}, Python {machine['python']}. "
        f"Plain Python counted to two million in {1e3 * state['spin']:.0f} ms at best.",
        "",
        "What it does: [../README.md](../README.md). Made, from first to last, by",
        "",
        *(f"- {one['date']}: `{one['command']}`" for one in state["sittings"]),
        "",
    ]
    if state["anyway"]:
        lines += [
            "**Not taken on a quiet machine: the figures show that the benchmark works, no more.**",
            "",
        ]
    lines += _table([{"code": name, "version": one} for name, one in state["versions"].items()])
    parts = {
        "speed": _speed, "builds": _builds, "law": _law, "flows": _flows, "memory": _memory, "start": _start,
        "scaling": _scaling, "kernels": _kernels,
    }  # fmt: skip
    for name, write in parts.items():
        found = state.get("speed" if name == "builds" else name)
        if found:
            lines += write(found)
    return "\n".join(lines) + "\n"


def _speed(rows: dict[str, Any]) -> list[str]:
    table: list[dict[str, Any]] = []
    for row in sorted(rows.values(), key=_place):
        if not row.get("rounds"):
            continue
        found = summary(row, SLIPS)
        codes = found["codes"]
        ours = next(one for name, one in codes.items() if name.startswith("ryusa"))
        line: dict[str, Any] = {
            "workload": row["workload"], "grains": f"{row['grains']:,}", "threads": row["threads"],
            "pairs": f"{found['pairs']}{'' if found['quiet'] else ' (not quiet)'}",
            "contacts": f"{ours['contacts']:.2f}", "ryusa": f"{ours['rate']:.1f}",
        }  # fmt: skip
        for name in SLIPS:
            line[name], line[f"over {name}"] = "", ""
            if name in codes:
                line[name] = f"{codes[name]['rate']:.2f}"
                line[f"over {name}"] = _ratio(codes[name], _asked(name, row["grains"]))
        alone = next((one["efficiency"] for one in codes.values() if "efficiency" in one), None)
        line["efficiency"] = "" if alone is None else f"{alone:.2f}"
        if alone is not None and alone < EFFICIENCY and row["grains"] > LARGE / 10:
            line["efficiency"] += f", asked {EFFICIENCY:g}"
        table.append(line)
    return [
        "", "## Speed", "",
        "Million particle-steps per second, free grains counted, medians; `over`: ratio of ryusa with that",
        "code's slip rule to it in the same round, median (lower quartile), and what was asked where it",
        "is missed. Contacts: touching pairs a grain.",
        "", *_table(table),
    ]  # fmt: skip


def _place(row: dict[str, Any]) -> tuple[int, str, int]:
    key = row.get("workload", "")
    return FULL.index(key) if key in FULL else len(FULL), key, row.get("threads", 0)


def _asked(name: str, grains: int) -> float:
    return ASKED_LARGE if name == "LAMMPS" and grains > LARGE else ASKED[name]


def _ratio(one: dict[str, Any], asked: float) -> str:
    text = f"{one['ratio']:.2f} ({one['ratio, lower quartile']:.2f})"
    return text if one["ratio"] >= asked else f"{text}, asked {asked:g}"


def _builds(rows: dict[str, Any]) -> list[str]:
    table: list[dict[str, Any]] = []
    for row in sorted(rows.values(), key=_place):
        if "workload" not in row:  # chosen for another ryusa, not timed with this one yet
            continue
        for name, tuned in row.get("tuned", {}).items():
            seen = [f"{build}: {_skins(rates)}" for build, rates in tuned["rates"].items()]
            line = {"workload": row["workload"], "threads": row["threads"], "code": name}
            taken = f"{tuned['build']}, skin {tuned.get('skin')} d"
            table.append(line | {"taken": taken, "seen [M/s]": "; ".join(seen)})
    return [
        "",
        "## Builds and skins of the peers",
        "",
        "One short run each; the fastest is what the table above is made with.",
        "",
        *_table(table),
    ]


def _skins(rates: dict[str, float]) -> str:
    return ", ".join(f"{rate:g} at {skin}" for skin, rate in rates.items())


def _law(rows: list[dict[str, Any]]) -> list[str]:
    return [
        "", "## The same law: one collision", "",
        "Largest difference to ryusa of velocity or surface speed after the same steps, over the speed of",
        "approach; LAMMPS has dashpots that go with the mass, which large on small shows.",
        "", *_table(rows),
    ]  # fmt: skip


def _flows(rows: list[dict[str, Any]]) -> list[str]:
    return [
        "", "## The same flow: averages after the same steps, 2k grains", "",
        "Single grains part ways after some contacts; `nudged` shows what that alone does: one grain begins",
        "0.1 um/s faster.",
        "", *_table(rows),
    ]  # fmt: skip


def _memory(rows: list[dict[str, Any]]) -> list[str]:
    table = []
    for row in rows:
        missed = row["code"] == "ryusa" and row["grains"] > 900_000 and row["B a grain"] > MEMORY
        table.append(row | {"B a grain": f"{row['B a grain']}{f', asked {MEMORY}' if missed else ''}"})
    return [
        "",
        "## Memory",
        "",
        "Peak of a static bed on one core, less that of the same command with fewer grains.",
        "",
        *_table(table),
    ]


def _start(rows: list[dict[str, Any]]) -> list[str]:
    return ["", "## Start-up", "", "Whole process less its steps, 2k grains.", "", *_table(rows)]


def _scaling(found: dict[str, Any]) -> list[str]:
    said = ", ".join(f"{n} threads: N^{one:.3f}" for n, one in found["exponents"].items())
    return [
        "",
        "## Cost of a step against the number of grains (W1)",
        "",
        f"From 2k grains on: {said}.",
        "",
        *_table(found["rows"]),
    ]


def _kernels(rows: list[dict[str, Any]]) -> list[str]:
    return ["", "## Parts of a step", "", "One thread, `benchmarks/kernels.py`.", "", *_table(rows)]


def _table(rows: list[dict[str, Any]]) -> list[str]:
    if not rows:
        return []
    heads = list(dict.fromkeys(key for row in rows for key in row))
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    return [*lines, *(f"| {' | '.join(str(row.get(key, '')) for key in heads)} |" for row in rows)]
