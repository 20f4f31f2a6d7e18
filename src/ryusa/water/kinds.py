"""Kinds of water: what moves in which flow, and its snapshot."""

from typing import NamedTuple

from ryusa.model import Column, ColumnRow, CouplingState, Flow, RowCouplingState, Snapshot
from ryusa.water.coupling import Coupling
from ryusa.water.protocol import Fluid
from ryusa.water.row_coupling import RowCoupling


class Kind(NamedTuple):
    """A kind of water."""

    fluid: type[Fluid]
    state: type[Snapshot]


KINDS: dict[type[Flow], Kind] = {
    Column: Kind(Coupling, CouplingState),
    ColumnRow: Kind(RowCoupling, RowCouplingState),
}
