"""Data of a run: Scene (fixed), State (moving), Contacts (history), Tally (energy account), Column."""

from ryusa.model.column import Budget, Column, CouplingState, WaterState
from ryusa.model.contacts import EVENT, Contacts
from ryusa.model.engine_block import EngineBlock
from ryusa.model.feeds import PASSAGE, Arrivals, Exit, Feed, Traffic
from ryusa.model.flow import Flow, FluidState
from ryusa.model.fluid import FluidAtGrains
from ryusa.model.rigid_bodies import BodyState, RigidBodies
from ryusa.model.row import ColumnRow, RowCouplingState, RowGrainState, RowState
from ryusa.model.scene import ContactLaw, Materials, RollingLaw, Scene, Water
from ryusa.model.state import State
from ryusa.model.tally import Tally, Term
from ryusa.model.walls import FaceKind, Walls

__all__ = [
    "EVENT",
    "PASSAGE",
    "Arrivals",
    "BodyState",
    "Budget",
    "Column",
    "ColumnRow",
    "ContactLaw",
    "Contacts",
    "CouplingState",
    "EngineBlock",
    "Exit",
    "FaceKind",
    "Feed",
    "Flow",
    "FluidAtGrains",
    "FluidState",
    "Materials",
    "RigidBodies",
    "RollingLaw",
    "RowCouplingState",
    "RowGrainState",
    "RowState",
    "Scene",
    "State",
    "Tally",
    "Term",
    "Traffic",
    "Walls",
    "Water",
    "WaterState",
]
