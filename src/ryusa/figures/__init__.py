"""One function per kind of plot. A figure takes measured records and draws them; it computes no numbers."""

from ryusa.figures.collisions import collision_times
from ryusa.figures.contact import StiffnessBand, StiffnessCurve, StiffnessPoints, over_stiffness, turning
from ryusa.figures.energy import energy
from ryusa.figures.forces import forces
from ryusa.figures.hops import contact_times, hops
from ryusa.figures.profiles import profiles
from ryusa.figures.repose import surface
from ryusa.figures.sizes import sizes
from ryusa.figures.snapshot import snapshot
from ryusa.figures.spin import spin
from ryusa.figures.style import save
from ryusa.figures.tracks import tracks, tracks_from_start, tracks_side_by_side
from ryusa.figures.transport import Formula, Rates, transport, transport_of_run
from ryusa.figures.vibration import vibration
from ryusa.figures.water import water

__all__ = [
    "Formula",
    "Rates",
    "StiffnessBand",
    "StiffnessCurve",
    "StiffnessPoints",
    "collision_times",
    "contact_times",
    "energy",
    "forces",
    "hops",
    "over_stiffness",
    "profiles",
    "save",
    "sizes",
    "snapshot",
    "spin",
    "surface",
    "tracks",
    "tracks_from_start",
    "tracks_side_by_side",
    "transport",
    "transport_of_run",
    "turning",
    "vibration",
    "water",
]
