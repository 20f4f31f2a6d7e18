"""Fuzzing guided by coverage: libFuzzer, by atheris, on everything that reads what a stranger wrote.

    python tests/faults/fuzz.py guided SECONDS    # so long in all, the same for each target
    python tests/faults/guided.py TARGET FOLDER [OPTIONS OF LIBFUZZER ...]

Targets are `schema` (a case file), `units`, `mesh` (an OBJ or STL file), `results` (a file of a run folder
put in the place of one) and `resume` (a checkpoint, its numbers or one of its arrays changed and signed
again). Anything but a named error is a crash, and so is no answer in time. Needs `pip install --group fuzz`.
"""

import hashlib
import io
import json
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from pkgutil import iter_modules

sys.path.insert(0, str(Path(__file__).parent))

LONGEST = {"schema": 4_000, "units": 70, "mesh": 6_000, "results": 60_000, "resume": 60_000}
UNITS = ("m", "s", "kg/m3", "m/s", "m/s2", "m2/s", "N", "N/m", "N s/m", "Pa/m", "rad", "rad/s", "-")
ANSWER = {
    "schema": 2,
    "units": 2,
    "mesh": 2,
    "results": 20,
    "resume": 20,
}  # s; the last two run on, if they may


def target(name: str, folder: Path) -> Callable[[bytes], None]:
    """What is called with every input."""
    import numpy as np

    from ryusa.casefile import explain, resolved
    from ryusa.casefile.read import read_text
    from ryusa.errors import RyusaError
    from ryusa.results import schema
    from ryusa.running import checkpoint
    from ryusa.running.disk import hdf5_image
    from ryusa.units import UnitError, quantity

    def one_case(data: bytes) -> None:
        try:
            case = read_text(data.decode("utf-8", "replace"))
            for row in explain(case):
                assert row.name
            json.dumps(resolved(case))
        except RyusaError as error:
            assert str(error)

    def one_quantity(data: bytes) -> None:
        for unit in UNITS:
            try:
                assert abs(quantity(data.decode("utf-8", "replace"), unit)) < float("inf")
            except UnitError as error:
                assert str(error)

    if name == "schema":
        return one_case
    if name == "units":
        return one_quantity

    if name == "mesh":
        return partial(one_mesh, folder)

    from test_fuzz import judged, read_checkpoint

    whole, work = folder / "run", folder / "work"
    names = sorted(str(one.relative_to(whole)) for one in whole.rglob("*") if one.is_file())
    kept = read_checkpoint(whole / schema.CHECKPOINT, 10_000)
    arrays = sorted(kept.arrays)

    def fresh() -> None:
        shutil.rmtree(work, ignore_errors=True)
        shutil.copytree(whole, work)

    def one_file(data: bytes) -> None:
        fresh()
        if data:
            (work / names[data[0] % len(names)]).write_bytes(data[1:])
        judged("rolling", work)

    def one_checkpoint(data: bytes) -> None:
        if not data:
            return
        about = json.dumps({**kept.values, "arrays": arrays}).encode()
        changed = {key: kept.arrays[key] for key in arrays}
        if data[0] % 2:
            about = data[1:]
        elif len(data) > 1:
            key = arrays[data[1] % len(arrays)]
            old = kept.arrays[key]
            raw = data[2:] if old.dtype.names is None else data[2 : 2 + old.nbytes].ljust(old.nbytes, b"\0")
            changed[key] = np.frombuffer(
                raw[: len(raw) // old.dtype.itemsize * old.dtype.itemsize], old.dtype
            )
            if changed[key].size == old.size:
                changed[key] = changed[key].reshape(old.shape)

        def fill(file: object) -> None:
            file["about"] = np.frombuffer(about, np.uint8)  # type: ignore[index]
            for one, array in changed.items():
                file[one] = array  # type: ignore[index]

        fresh()
        body = hdf5_image(fill)
        head = checkpoint._MAGIC + f"{len(body)} {hashlib.sha256(body).hexdigest()}\n".encode()
        (work / schema.CHECKPOINT).write_bytes(head.ljust(checkpoint._HEAD, b"\0") + body)
        judged("rolling", work)

    fresh()
    judged("rolling", work)  # loads kernels
    return one_file if name == "results" else one_checkpoint


def one_mesh(folder: Path, data: bytes) -> None:
    """A file of triangles: an OBJ file where its first byte is even, an STL file where it is odd."""
    import numpy as np

    from ryusa.errors import ParseError
    from ryusa.formats.mesh import read_mesh
    from ryusa.model.welding import first_of_each, rims, welded

    path = folder / ("mesh.stl" if data[:1] and data[0] % 2 else "mesh.obj")
    path.write_bytes(data[1:])
    try:
        corners = read_mesh(path, path.name)
    except ParseError as error:
        assert "\n" not in str(error)
        return
    assert np.isfinite(corners).all()
    if np.abs(corners).max() < 1e12:
        assert 0 < len(first_of_each(welded(corners))) <= len(corners)
        assert rims(corners)[0] <= 3 * len(corners)


def prepare(folder: Path) -> None:
    """Write first inputs for every target, words of the case file, and a run that stopped half way."""
    from kinds import MESHES
    from strange_cases import NUMBERS, UNITS, bases, known, toml_of
    from test_fuzz import go

    from ryusa.results import schema
    from ryusa.running import loop
    from ryusa.running.checkpoint import read_checkpoint

    for name in LONGEST:
        (folder / name).mkdir(parents=True, exist_ok=True)
    texts = [toml_of(base).encode() for base in bases()]
    cases = [one.read_bytes() for one in files("ryusa.cases").iterdir() if one.name.endswith(".toml")]
    texts += [text for text in cases if len(text) < LONGEST["schema"]]
    quantities = [f"{a} {b}".encode() for a in NUMBERS[:12] for b in UNITS]
    words = [one for part in known() for one in part]
    quoted = [re.sub(r"[^ -~]", "", one).replace("\\", "").replace('"', "") for one in [*words, *UNITS]]
    (folder / "words").write_text("".join(f'"{one}"\n' for one in quoted if one), encoding="ascii")
    advance = loop.Loop._advance

    def watched(self: loop.Loop, n_steps: int) -> None:
        advance(self, n_steps)
        self._signal.stop = "the fuzzer" if self._t > 0.6 * self.stop.time else self._signal.stop

    loop.Loop._advance = watched  # type: ignore[method-assign]
    loop.Loop._chunk = lambda self: 101  # type: ignore[method-assign]
    go("rolling", folder / "run")
    names = sorted(one for one in (folder / "run").rglob("*") if one.is_file())
    contents = [bytes([k]) + one.read_bytes() for k, one in enumerate(names)]
    kept = read_checkpoint(folder / "run" / schema.CHECKPOINT, 10_000)
    arrays = sorted(kept.arrays)
    signed = [b"\1" + json.dumps({**kept.values, "arrays": arrays}).encode()]
    signed += [bytes([0, k]) + kept.arrays[one].tobytes() for k, one in enumerate(arrays)]
    meshes = [b"\0" + one.encode() for one in MESHES.values()]
    meshes += [b"\1" + one for one in stl_files()]
    seeds = {"schema": texts, "units": quantities, "mesh": meshes, "results": contents, "resume": signed}
    for name, ones in seeds.items():
        for k, one in enumerate(ones):
            (folder / name / f"seed-{k:03}").write_bytes(one)


def stl_files() -> list[bytes]:
    """One triangle as binary and as text."""
    one = bytes(80) + (1).to_bytes(4, "little") + struct.pack("<12f", *range(12)) + bytes(2)
    lines = ["solid a", "facet normal 0 0 1", "outer loop"]
    lines += [*(f"vertex {k} 0 {k * k}" for k in range(3)), "endloop", "endfacet", "endsolid a", ""]
    return [one, "\n".join(lines).encode()]


def guided(folder: Path, seconds: int) -> int:
    """All targets, one after the other; the exit code."""
    if find_spec("atheris") is None:
        print("atheris is not installed: make fuzz installs it (Linux)")
        return 2
    prepare(folder)
    bad = 0
    for name, longest in LONGEST.items():
        words = [sys.executable, __file__, name, str(folder), str(folder / name)]
        words += [
            f"-max_total_time={seconds // len(LONGEST)}",
            f"-max_len={longest}",
            f"-timeout={ANSWER[name]}",
        ]
        words += [f"-artifact_prefix={folder}/{name}-", "-print_final_stats=1", "-rss_limit_mb=4096"]
        words += [f"-dict={folder / 'words'}"] if name == "schema" else []
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", check=False)
        said = io.StringIO(done.stdout + done.stderr).readlines()
        stats = [line.split(":")[-1].strip() for line in said if "number_of_executed_units" in line]
        cover = [line.split("cov: ")[1].split(" ")[0] for line in said if " cov: " in line]
        print(
            f"{name}: {stats or ['?']} inputs, {cover[-1:]} branches, left with {done.returncode}", flush=True
        )
        if done.returncode:
            print(*said[-60:], sep="", flush=True)
            bad = 1
    return bad


def main() -> None:
    """Fuzz one target; libFuzzer leaves the process by itself."""
    import atheris

    import ryusa.laws

    for one in iter_modules(ryusa.laws.__path__, "ryusa.laws."):
        import_module(one.name)  # numba compiles what is not instrumented
    import ryusa.engine.cpu.engine
    import ryusa.water.coupling

    with atheris.instrument_imports(include=["ryusa"]):
        import ryusa.casefile.read
        import ryusa.running.inspection
        import ryusa.running.runner
        import ryusa.units
    atheris.Setup([sys.argv[0], *sys.argv[3:]], target(sys.argv[1], Path(sys.argv[2])))
    atheris.Fuzz()


if __name__ == "__main__":
    main()
