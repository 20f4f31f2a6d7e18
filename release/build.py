"""Build what is uploaded from a clean clone, twice, and compare the two byte by byte.

    python release/build.py DIST

The source distribution and the wheel of ryusa and of ryusa-studies, and SHA256SUMS. The same commit gives the
same bytes wherever Python and setuptools are the same: times are those of the commit, owners and
modes are set. The wheel is built from the source distribution, so that this is known to be whole.
"""

import gzip
import hashlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
UV = Path(sys.executable).with_name("uv")
PROJECTS = (".", "studies")


def main() -> None:
    """Build into the folder that is named."""
    dist = Path(sys.argv[1]).resolve()
    dist.mkdir(parents=True, exist_ok=True)
    os.umask(0o022)  # setuptools takes the modes of files into a wheel
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        first, second = built(Path(one)), built(Path(other))
        differ = [name for name in first if first[name].read_bytes() != second[name].read_bytes()]
        if differ or first.keys() != second.keys():
            raise SystemExit(f"two builds of one commit differ: {', '.join(differ) or 'in their files'}")
        for file in (*dist.glob("ryusa-*"), *dist.glob("ryusa_studies-*")):
            file.unlink()  # of another version, or built by `make kernels`
        for file in first.values():
            shutil.copyfile(file, dist / file.name)
    sums = [f"{digest(file)}  {file.name}" for file in sorted(dist.glob("ryusa*"))]
    (dist / "SHA256SUMS").write_text("\n".join([*sums, ""]), encoding="ascii")
    for name in sorted(first):
        about = f", {made_by(dist / name)}" if name.endswith(".whl") else ""
        print(f"{name:<44}{(dist / name).stat().st_size / 2**20:6.2f} MiB, twice the same bytes{about}")


def built(folder: Path) -> dict[str, Path]:
    """What a clean clone in a folder gives, by the names of files."""
    clone, out = folder / "clone", folder / "out"
    out.mkdir()
    run("git", "clone", "--quiet", "--no-local", ROOT, clone)
    os.environ["SOURCE_DATE_EPOCH"] = run("git", "-C", clone, "log", "-1", "--format=%ct").strip()
    for project in PROJECTS:
        built = folder / "built" / project
        run(UV, "build", "--quiet", "--sdist", "--out-dir", built, clone / project)
        source = next(built.glob("*.tar.gz"))
        plain(source, int(os.environ["SOURCE_DATE_EPOCH"]))
        run(UV, "build", "--quiet", "--wheel", "--out-dir", built, source)
        for file in (source, next(built.glob("*.whl"))):
            file.rename(out / file.name)
    return {file.name: file for file in sorted(out.iterdir())}


def plain(file: Path, at: int) -> None:
    """Write a .tar.gz anew, in order, without times, owners and modes of the machine."""
    with tarfile.open(file) as source, io.BytesIO() as plainly:
        with tarfile.open(fileobj=plainly, mode="w", format=tarfile.PAX_FORMAT) as target:
            for member in sorted(source.getmembers(), key=lambda one: one.name):
                content = source.extractfile(member) if member.isfile() else None
                plain_member = tarfile.TarInfo(member.name)
                plain_member.type, plain_member.size, plain_member.mtime = member.type, member.size, at
                plain_member.mode = 0o755 if member.isdir() else 0o644
                target.addfile(plain_member, content)
        packed = gzip.compress(plainly.getvalue(), mtime=at)
    file.write_bytes(packed)


def made_by(wheel: Path) -> str:
    """Version of setuptools that built a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        told = next(name for name in archive.namelist() if name.endswith(".dist-info/WHEEL"))
        lines = archive.read(told).decode().splitlines()
    return next(line.partition(": ")[2] for line in lines if line.startswith("Generator"))


def digest(file: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def run(*words: str | Path) -> str:
    """Run a command; what it prints."""
    done = subprocess.run([str(one) for one in words], check=False, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done.stdout


if __name__ == "__main__":
    main()
