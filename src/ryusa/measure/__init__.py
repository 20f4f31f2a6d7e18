"""Numbers from a run folder: every function reads results and returns a frozen record; none steps a grain."""

from ryusa.catalogue import MEASURES, called
from ryusa.measure.apparent_contact import ApparentContact, apparent_contact
from ryusa.measure.bed_waves import BedWaves, bed_waves
from ryusa.measure.collisions import Collisions, ContactTimes, collisions, contact_times, turned_time
from ryusa.measure.cone import Cone, cone
from ryusa.measure.contact_network import ContactNetwork, contact_network
from ryusa.measure.deposit import Deposit, deposit
from ryusa.measure.depth_history import DepthHistory, depth_history
from ryusa.measure.direct_shear import DirectShear, direct_shear
from ryusa.measure.discharge import Discharge, discharge
from ryusa.measure.dynamic_angle import DynamicAngle, dynamic_angle
from ryusa.measure.energy import Energy, energy
from ryusa.measure.entrainment import Entrainment, entrainment
from ryusa.measure.flow_field import FlowField, flow_field
from ryusa.measure.formulae import FormulaCurve, classical
from ryusa.measure.front import Front, front
from ryusa.measure.layers import Layers
from ryusa.measure.long_section import LongSection, long_section
from ryusa.measure.mill import Mill, mill
from ryusa.measure.passages import Passages, passages
from ryusa.measure.paths import Alternating, Paths, alternating, paths
from ryusa.measure.plane_shear import PlaneShear, plane_shear
from ryusa.measure.profiles import Profiles, profiles
from ryusa.measure.repose import HeapSurface, surface
from ryusa.measure.rods import Rod, Rods, companions, rods
from ryusa.measure.saltation import Saltation, grouping, saltation
from ryusa.measure.scour import Scour, scour
from ryusa.measure.shear_zone import ShearZone, shear_zone
from ryusa.measure.sizes import Sizes, sizes
from ryusa.measure.snapshot import Bounds, Snapshot, bounds, snapshot
from ryusa.measure.spin import Spin, spin
from ryusa.measure.statistics import Average, average, ratio, standard_error
from ryusa.measure.table import Averages, rows_of, write_csv
from ryusa.measure.tracks import Tracks, farthest, tracks
from ryusa.measure.transport import KineticStress, Transport, kinetic_stress, transport
from ryusa.measure.vibration import (
    VibratingGrains,
    Vibration,
    rest_time,
    vibrating_grains,
    vibrating_share,
    vibration,
)
from ryusa.measure.water import WaterProfile, water
from ryusa.measure.water_energy import WaterEnergy, water_energy

__all__ = [
    "Alternating",
    "ApparentContact",
    "Average",
    "Averages",
    "BedWaves",
    "Bounds",
    "Collisions",
    "Cone",
    "ContactNetwork",
    "ContactTimes",
    "Deposit",
    "DepthHistory",
    "DirectShear",
    "Discharge",
    "DynamicAngle",
    "Energy",
    "Entrainment",
    "FlowField",
    "FormulaCurve",
    "Front",
    "HeapSurface",
    "KineticStress",
    "Layers",
    "LongSection",
    "Mill",
    "Passages",
    "Paths",
    "PlaneShear",
    "Profiles",
    "Rod",
    "Rods",
    "Saltation",
    "Scour",
    "ShearZone",
    "Sizes",
    "Snapshot",
    "Spin",
    "Tracks",
    "Transport",
    "VibratingGrains",
    "Vibration",
    "WaterEnergy",
    "WaterProfile",
    "alternating",
    "apparent_contact",
    "average",
    "bed_waves",
    "bounds",
    "classical",
    "collisions",
    "companions",
    "cone",
    "contact_network",
    "contact_times",
    "deposit",
    "depth_history",
    "direct_shear",
    "discharge",
    "dynamic_angle",
    "energy",
    "entrainment",
    "farthest",
    "flow_field",
    "front",
    "grouping",
    "kinetic_stress",
    "long_section",
    "mill",
    "passages",
    "paths",
    "plane_shear",
    "profiles",
    "ratio",
    "rest_time",
    "rods",
    "rows_of",
    "saltation",
    "scour",
    "shear_zone",
    "sizes",
    "snapshot",
    "spin",
    "standard_error",
    "surface",
    "tracks",
    "transport",
    "turned_time",
    "vibrating_grains",
    "vibrating_share",
    "vibration",
    "water",
    "water_energy",
    "write_csv",
]

# A measure of the catalogue needs no line here; the names above are written out for type checkers.
for _entry in MEASURES:
    globals()[_entry.function.partition(":")[2]] = called(_entry)
