import json

import ryusa
from ryusa.running import provenance


def test_provenance_names_versions_machine_seed_and_command() -> None:
    found = provenance.begin(threads=2, seed=7, engine="cpu", overrides={"a.b": "1"})
    assert found["ryusa"] == ryusa.__version__
    assert {"numpy", "numba", "h5py", "pydantic"} <= set(found["packages"])
    assert found["threads"] == 2
    assert found["seed"] == 7
    assert found["machine"]["cores"] >= 1
    assert found["status"] == "running"
    assert "/" not in found["command"][0]
    json.dumps(found)
