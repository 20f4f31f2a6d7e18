"""Kinds of water: what moves in which flow."""

from ryusa.model import Column, ColumnRow
from ryusa.model.flow import Flow
from ryusa.water.coupling import Coupling
from ryusa.water.protocol import Fluid
from ryusa.water.row_coupling import RowCoupling

KINDS: dict[type[Flow], type[Fluid]] = {Column: Coupling, ColumnRow: RowCoupling}
