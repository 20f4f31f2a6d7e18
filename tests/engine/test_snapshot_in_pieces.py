"""A checkpoint that is written piece by piece holds the state that the engine gives whole."""

from pathlib import Path
from typing import Any

import pytest
from tests.engine.conftest import bits, pile, run
from tests.engine.test_many_grains import KINDS, SHOWN
from tests.kernel_variants import full_but

from ryusa.engine.cpu import snapshot
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.results import schema
from ryusa.running.checkpoint import CheckpointBlock, read_checkpoint, write_checkpoint
from ryusa.running.snapshot import engine_block, state_block, state_from_block

FALLEN = 0.035  # time in which the grains come to touch [s], whatever the step of their timing
PIECE = 7  # rows; in water few grains touch at a time


@pytest.mark.parametrize("kind", full_but(SHOWN, KINDS))
def test_a_checkpoint_in_pieces_holds_the_whole_state(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(snapshot, "_AT_ONCE", PIECE)  # so that no block of grains is one piece
    kept: dict[str, Any] = KINDS[kind]
    made = pile(n=300, stir=0.05, **kept)
    engine = run(made, round(FALLEN / made[0].dt))
    whole = engine.state()
    assert len(whole.contacts) > PIECE
    write_checkpoint(tmp_path, CheckpointBlock.merged(state=engine_block(engine, None)))
    block = read_checkpoint(tmp_path / schema.CHECKPOINT, made[0].n_grain).block("state")
    assert bits(state_from_block(block, made[0])) == bits(whole)
    assert set(block.arrays) >= set(state_block(whole).arrays)


def test_a_checkpoint_without_contacts_is_written_in_pieces(tmp_path: Path) -> None:
    kept: dict[str, Any] = KINDS[SHOWN[0]]
    made = pile(n=60, **kept)
    engine = CpuEngine()
    engine.load(*made)
    write_checkpoint(tmp_path, CheckpointBlock.merged(state=engine_block(engine, None)))
    block = read_checkpoint(tmp_path / schema.CHECKPOINT, made[0].n_grain).block("state")
    assert len(block.arrays["contacts/i"]) == 0
    assert bits(state_from_block(block, made[0])) == bits(engine.state())
