import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ryusa.errors import ResultsError
from ryusa.results import schema
from ryusa.running.lock import locked

HOLDER = """
import sys, time
from pathlib import Path
from ryusa.running.lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_a_second_process_is_refused_with_the_name_of_the_writer(tmp_path: Path) -> None:
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        with (
            pytest.raises(ResultsError, match=f"process {holder.pid} on .* is writing"),
            locked(tmp_path),
        ):
            raise AssertionError
    finally:
        holder.kill()
        holder.wait()
    assert (tmp_path / schema.LOCK).is_file()  # left behind by the kill
    with locked(tmp_path) as left:
        assert left.startswith(f"process {holder.pid} on ")
        assert json.loads((tmp_path / schema.LOCK).read_text())["pid"] == os.getpid()
    assert not (tmp_path / schema.LOCK).exists()


def test_a_second_run_in_the_same_process_is_refused(tmp_path: Path) -> None:
    with locked(tmp_path), pytest.raises(ResultsError, match="is writing to it"), locked(tmp_path):
        raise AssertionError


@pytest.mark.parametrize("content", ["", "{", "[]", '{"pid": "x"}', '{"pid": 1e400, "host": 3}', "9" * 9000])
def test_a_lock_with_any_content_is_taken_over(tmp_path: Path, content: str) -> None:
    (tmp_path / schema.LOCK).write_text(content)
    with locked(tmp_path) as left:
        assert left == ""


def test_a_lock_that_is_a_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "other").write_text("mine")
    (tmp_path / schema.LOCK).symlink_to(tmp_path / "other")
    with pytest.raises(ResultsError, match="cannot be written"), locked(tmp_path):
        raise AssertionError
    assert (tmp_path / "other").read_text() == "mine"
