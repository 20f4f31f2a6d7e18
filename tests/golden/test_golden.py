"""Short runs give the numbers that were kept, and the same bits where machine and versions are the same."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import goldens


@pytest.mark.parametrize("name", goldens.names())
def test_a_short_run_gives_the_numbers_that_were_kept(name: str, tmp_path: Path) -> None:
    golden = goldens.read(name)
    found = goldens.make(golden, tmp_path / name)
    assert not goldens.moved(golden.values, found.values, golden.recipe["tolerance"]), "see `make golden`"
    if goldens.same_machine(golden.certificate, found.certificate):
        assert not goldens.bits_moved(golden.values, found.values), "bits differ on the same machine"


@pytest.mark.parametrize("name", goldens.names())
def test_a_golden_says_how_and_where_it_was_made_and_why_its_tolerance_holds(name: str) -> None:
    golden = goldens.read(name)
    assert golden.recipe["command"].startswith("ryusa run ")
    assert golden.recipe["what"]
    assert golden.recipe["why"].strip()
    assert 0.0 < golden.recipe["tolerance"] <= 1.0e-6
    for key in ("commit", "date", "seed", "ryusa", "python", "processor", "target", *goldens.PACKAGES):
        assert golden.certificate[key] not in ("", None), key


def test_a_number_that_moved_beyond_the_tolerance_is_named() -> None:
    kept = goldens.read("heap").values
    found = {
        **kept,
        "numbers": {**kept["numbers"], "spin_rad_per_s": dict(kept["numbers"]["spin_rad_per_s"])},
    }
    assert not goldens.moved(kept, found, 1.0e-12)
    found["numbers"]["spin_rad_per_s"]["largest"] *= 1.0 + 1.0e-7
    (line,) = goldens.moved(kept, found, 1.0e-8)
    assert line.startswith("spin_rad_per_s.largest")
    assert not goldens.moved(kept, found, 1.0e-6)


def test_an_additional_contact_is_named_whatever_the_tolerance() -> None:
    kept = goldens.read("heap").values
    found = {**kept, "counts": {**kept["counts"], "contacts_ended": kept["counts"]["contacts_ended"] + 1}}
    assert [line for line in goldens.moved(kept, found, 1.0e-6) if line.startswith("contacts_ended")]


def test_a_renewal_keeps_the_recipe_as_it_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    golden = goldens.read("saltation")
    recipe = (golden.folder / "how.toml").read_text(encoding="utf-8").partition(goldens.CERTIFICATE)[0]
    (tmp_path / "saltation").mkdir()
    (tmp_path / "saltation" / "how.toml").write_text(recipe, encoding="utf-8")
    monkeypatch.setattr(goldens, "HERE", tmp_path)
    goldens.write(goldens.read("saltation"), goldens.Outcome({"commit": "abc"}, {"counts": {"steps": 1}}))
    written = (tmp_path / "saltation" / "how.toml").read_text(encoding="utf-8")
    assert written.startswith(recipe)
    again = goldens.read("saltation")
    assert (again.recipe, again.certificate) == (golden.recipe, {"commit": "abc"})
    assert again.values == {"counts": {"steps": 1}}
