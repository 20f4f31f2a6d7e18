"""Kinds of water: what moves in which flow, and its snapshot."""

from typing import NamedTuple

from ryusa.model import Column, ColumnRow, CouplingState, Flow, FluidState, RowCouplingState
from ryusa.water.coupling import Coupling
from ryusa.water.protocol import Fluid
from ryusa.water.row_coupling import RowCoupling


class FluidKind(NamedTuple):
    """A kind of water."""

    fluid: type[Fluid]
    state: type[FluidState]


KINDS: dict[type[Flow], FluidKind] = {
    Column: FluidKind(Coupling, CouplingState),
    ColumnRow: FluidKind(RowCoupling, RowCouplingState),
}
