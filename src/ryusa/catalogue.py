"""The measures and pictures of a run, one line each.

From these tables follow `ryusa measure` and `ryusa draw`, their `--help`, the command reference, and the
functions of `ryusa.measure`: a new measure or picture needs one line here in addition to its own file.
Functions are given as "module:function" and imported by `load` when they are used.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from typing import Any

from ryusa.errors import ResultsError

OPTION_NAMES = {"t": "--at", "grains": "--grain"}  # options whose name differs from the keyword


@dataclass(frozen=True)
class MeasureEntry:
    """A measure: what `ryusa measure RUN name` calls.

    Attributes
    ----------
    name : name on the command line.
    function : "module:function"; called with the results of a run and the options. It returns a record with
        `rows()` for the CSV, which is printed as its `averages` if it has them, else as a table of rows.
    doc : one line for help and docs.
    options : keywords of the function that are options of the command.
    settled : whether the measure ignores the time up to `record.settle` by default; --settle changes it.
    printing : options that affect only the printed text.
    builders : kinds of `[build]` whose runs have it in their report, where they have the walls, feeds or
        row that it needs; a measure of a row is in that of any run with one.
    fed : whether it can be had of a run with feeds or exits, where grains are nan in frames while away.
    clumps : whether it can be had of a run with clumps, whose spheres are free grains of the scene.
    grainless : whether it can be had of a run of water alone.
    precision : its averages whose standard error can end a run; each is a key of `stop.precision`.
    numbers : names and SI units of those of its numbers that `ryusa soften` takes; durations and overlaps of
        contacts are left out, for they follow from the stiffness alone.
    table : whether it gives a table, such as a path, and no quantities that a sweep could list.
    needs : what it needs of a case, by words of `campaigns.sweep.measures.NEEDS`.
    layers : its quantities over height, which `ryusa calibrate` takes at one height: names of the `columns`
        of what it returns, whose middles are its `z`.
    """

    name: str
    function: str
    doc: str
    options: tuple[str, ...] = ()
    settled: bool = False
    printing: tuple[str, ...] = ()
    builders: tuple[str, ...] = ()
    fed: bool = False
    clumps: bool = False
    grainless: bool = False
    precision: tuple[str, ...] = ()
    numbers: tuple[tuple[str, str], ...] = ()
    table: bool = False
    needs: tuple[str, ...] = ()
    layers: tuple[str, ...] = ()

    @property
    def given_as(self) -> tuple[str, ...]:
        """Options of the command, such as "--begin"."""
        settle = ("settle",) if self.settled and "settle" not in self.options else ()
        return tuple(option(keyword) for keyword in (*settle, *self.options, *self.printing))


@dataclass(frozen=True)
class PictureEntry:
    """A picture: what `ryusa draw RUN name` calls.

    Attributes
    ----------
    name : name on the command line.
    function : "module:function". With a `measure`, it draws the record returned by that measure; without one,
        it is called with the results of a run and the options, and returns the figure and the rows for CSV.
    doc : one line for help and docs.
    options : keywords, of the measure if there is one, that are options of the command.
    settled : whether the picture ignores the time up to `record.settle` by default.
    measure : name of the measure that it draws, or "".
    drawing : of a picture of a measure, options of its own function, beside those of the measure.
    builders : kinds of `[build]` whose runs have it in their report.
    fed, clumps, grainless : as of a measure.
    """

    name: str
    function: str
    doc: str
    options: tuple[str, ...] = ()
    settled: bool = False
    measure: str = ""
    drawing: tuple[str, ...] = ()
    builders: tuple[str, ...] = ()
    fed: bool = False
    clumps: bool = False
    grainless: bool = False

    @property
    def given_as(self) -> tuple[str, ...]:
        """Options of the command, such as "--begin"."""
        return tuple(option(keyword) for keyword in (*self.options, *self.drawing))

    def parted(self, given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
        """Keywords for the measure that it draws, and for its own function."""
        own = {name: given[name] for name in self.drawing if name in given}
        return {name: one for name, one in given.items() if name not in own}, own


WINDOW = ("begin", "end")
SIDES = ("right", "left")  # of a heap
BEDS = ("packed", "rest")  # what ends the bed of a row of columns
QUANTITIES = ("depth", "bed", "transport")  # of a row over distance and time that are drawn
EVERY_BUILDER = ("drop", "saltation", "table", "run", "packing", "flume", "box", "empty", "fill", "stream")

MEASURES = (
    MeasureEntry("saltation", "ryusa.measure.saltation:saltation",
                 "hops over fixed grains: height, length, speed, contact time",
                 ("settle", "rise"), settled=True, builders=("saltation",),
                 numbers=(("jump_height", "m"), ("jump_height_crest", "m"), ("jump_length", "m"),
                          ("flight_length", "m"), ("flight_time", "s"), ("speed", "m/s"),
                          ("spin_before", "rad/s"), ("spin_after", "rad/s"), ("bed_normal", "N"),
                          ("bed_shear", "N"), ("bed_friction", "N"), ("shear_ratio", "-")),
                 needs=("events",)),
    MeasureEntry("collisions", "ryusa.measure.collisions:collisions",
                 "single contacts: duration, overlap, restitution", ("settle", "end"), settled=True, fed=True,
                 builders=("saltation", "drop"), needs=("events",)),
    MeasureEntry("apparent_contact", "ryusa.measure.apparent_contact:apparent_contact",
                 "contact as a film of --fps frames per second and a resolution shows it",
                 (*WINDOW, "fps", "resolution"), settled=True),
    MeasureEntry("spin", "ryusa.measure.spin:spin", "spin about the axis across the flow",
                 ("settle",), settled=True, builders=("saltation",),
                 numbers=(("spin", "rad/s"), ("turns", "1/s"), ("spin_absolute", "rad/s"))),
    MeasureEntry("energy", "ryusa.measure.energy:energy", "every term of the energy account",
                 fed=True, clumps=True, table=True),
    MeasureEntry("tracks", "ryusa.measure.tracks:tracks", "paths of the grains in the x-z plane",
                 WINDOW, clumps=True, table=True),
    MeasureEntry("profile", "ryusa.measure.profiles:profiles",
                 "concentration, velocity, spin and flux over height", (*WINDOW, "layer"), settled=True,
                 builders=("flume", "packing"), numbers=(("flux", "m2/s"), ("speed", "m/s")),
                 needs=("period",), clumps=True,
                 layers=("phi", "area_fraction", "v_x", "v_z", "spin", "temperature_x",
                         "temperature_z", "flux")),
    MeasureEntry("paths", "ryusa.measure.paths:paths",
                 "shape of grain paths: advance, vertical range, reversals",
                 (*WINDOW, "window"), settled=True,
                 numbers=(("advance", "m"), ("range_z", "m"), ("reversals", "1/s"),
                          ("above_crest", "m"), ("near_bed", "-"), ("jaggedness", "-"))),
    MeasureEntry("rods", "ryusa.measure.rods:rods",
                 "groups of moving grains that stay in contact", (*WINDOW, "window"), settled=True,
                 numbers=(("share", "-"),), needs=("period",)),
    MeasureEntry("water", "ryusa.measure.water:water",
                 "water over height, and its shear stress at the bed", WINDOW, settled=True,
                 builders=("flume",), precision=("tau_star", "discharge"),
                 numbers=(("depth", "m"), ("tau_bed", "Pa"), ("tau_star", "-"),
                          ("u_star", "m/s"), ("discharge", "m2/s"), ("speed", "m/s")),
                 needs=("column",), clumps=True),
    MeasureEntry("transport", "ryusa.measure.transport:transport",
                 "sediment transport rate and the layer that carries it", WINDOW, settled=True,
                 builders=("flume",), precision=("q", "q_star", "layer_thickness"),
                 numbers=(("q", "m2/s"), ("q_mass", "kg/s/m"), ("q_star", "-"), ("layer_low", "m"),
                          ("layer_high", "m"), ("layer_thickness", "m")), needs=("period",), clumps=True),
    MeasureEntry("entrainment", "ryusa.measure.entrainment:entrainment",
                 "grains that start and stop moving, per area and time", WINDOW, settled=True,
                 builders=("flume",), precision=("entrainment", "deposition", "moving", "moving_speed"),
                 numbers=(("entrainment", "1/(m2 s)"), ("deposition", "1/(m2 s)"),
                          ("entrained_volume", "m/s"), ("deposited_volume", "m/s"),
                          ("moving", "m"), ("moving_speed", "m/s")), needs=("period",)),
    MeasureEntry("stress", "ryusa.measure.transport:kinetic_stress",
                 "granular temperature and kinetic stress over height", (*WINDOW, "layer"), settled=True,
                 table=True),
    MeasureEntry("coordination", "ryusa.measure.coordination:coordination",
                 "contacts per grain, with and without rattlers, over height",
                 (*WINDOW, "layer"), settled=True, builders=("packing",),
                 numbers=(("coordination", "-"), ("without_rattlers", "-"), ("rattlers", "-"))),
    MeasureEntry("segregation", "ryusa.measure.segregation:segregation",
                 "heights of large and small grains over time", WINDOW, settled=True,
                 numbers=(("segregation_index", "-"), ("small_over_all", "m"), ("large_over_all", "m"))),
    MeasureEntry("sizes", "ryusa.measure.sizes:sizes",
                 "sizes laid by mass, D10 to D90 and sorting, beside the sieve curve asked for",
                 ("material",), fed=True, clumps=True, table=True),
    MeasureEntry("dispersion", "ryusa.measure.dispersion:dispersion",
                 "mean squared displacement about the mean motion, and diffusivities",
                 (*WINDOW, "layer"), settled=True,
                 numbers=(("diffusivity_along", "m2/s"), ("diffusivity_across", "m2/s"),
                          ("diffusivity_normal", "m2/s")), needs=("period",)),
    MeasureEntry("contact_stress", "ryusa.measure.contact_stress:contact_stress",
                 "stress of contacts and motion over height, mu and I; needs record.forces",
                 (*WINDOW, "layer"), settled=True, numbers=(("bed_normal", "Pa"), ("bed_shear", "Pa")),
                 needs=("area", "forces")),
    MeasureEntry("walls", "ryusa.measure.walls:walls",
                 "force and torque on each wall, its contacts, its power, the way of a servo", WINDOW,
                 settled=True, builders=EVERY_BUILDER, fed=True, clumps=True,
                 needs=("walls",)),
    MeasureEntry("loads", "ryusa.measure.loads:loads",
                 "force and overturning moment of water and grains on dams and walls in a row of columns",
                 (*WINDOW, "window"), settled=True, fed=True, clumps=True, grainless=True,
                 needs=("row", "structures")),
    MeasureEntry("vibration", "ryusa.measure.vibration:vibration",
                 "grains that do not come to rest", (*WINDOW, "window"), printing=("threshold",), table=True),
    MeasureEntry("surface", "ryusa.measure.repose:surface",
                 "free surface of a heap: slope, height, run-out", ("t", "side"),
                 builders=("box", "empty"), fed=True,
                 numbers=(("slope", "rad"), ("crest", "m"), ("toe", "m"),
                          ("run_out", "m"), ("grains", "-"), ("away", "-")), clumps=True, needs=("open",)),
    MeasureEntry("cone", "ryusa.measure.cone:cone",
                 "slope of a heap with a round foot, on all its sides", ("t",), fed=True, clumps=True,
                 needs=("open", "space")),
    MeasureEntry("dynamic_angle", "ryusa.measure.dynamic_angle:dynamic_angle",
                 "angle of the surface in a drum that turns", WINDOW, settled=True, fed=True, clumps=True,
                 needs=("walls",)),
    MeasureEntry("shear", "ryusa.measure.plane_shear:plane_shear",
                 "friction, inertial number and concentration under a lid that is pressed and drawn along",
                 WINDOW, settled=True, clumps=True,
                 numbers=(("mu", "-"), ("inertial_number", "-"), ("phi", "-"), ("shear_rate", "1/s"),
                          ("normal", "Pa"), ("shear", "Pa")),
                 needs=("period", "walls", "space")),
    MeasureEntry("direct_shear", "ryusa.measure.direct_shear:direct_shear",
                 "friction and dilation over displacement in a box of two halves, one of which moves",
                 WINDOW, settled=True, clumps=True,
                 numbers=(("mu", "-"), ("normal", "N"), ("rise", "m"), ("imbalance", "-")),
                 needs=("walls", "space")),
    MeasureEntry("shear_zone", "ryusa.measure.shear_zone:shear_zone",
                 "centre and width of the shear zone over a disc that turns in the floor, and torques",
                 WINDOW, settled=True,
                 numbers=(("centre", "m"), ("width", "m"), ("share", "-")),
                 needs=("walls", "space")),
    MeasureEntry("mill", "ryusa.measure.mill:mill",
                 "torque and power of a drum that turns, and where the power goes, over whole turns",
                 WINDOW, settled=True, clumps=True,
                 numbers=(("torque", "N m"), ("power", "W"), ("given", "W"), ("lost", "W"), ("stored", "W")),
                 needs=("walls", "space")),
    MeasureEntry("discharge", "ryusa.measure.discharge:discharge",
                 "grains and mass in and out by feeds and exits, over time", WINDOW, settled=True,
                 builders=EVERY_BUILDER, fed=True, clumps=True,
                 numbers=(("rate_in", "kg/s"), ("rate_out", "kg/s")), needs=("traffic",)),
    MeasureEntry("passages", "ryusa.measure.passages:passages",
                 "each grain that a feed brought or an exit took: time, size, speed, place; backlog of feeds",
                 WINDOW, settled=True, builders=EVERY_BUILDER, fed=True, clumps=True, needs=("traffic",)),
    MeasureEntry("long_section", "ryusa.measure.long_section:long_section",
                 "surface, bed, speed, Froude number, discharge of water and grains along a row of columns",
                 ("t", "bed", *WINDOW), fed=True, clumps=True, grainless=True, table=True, needs=("row",)),
    MeasureEntry("flow_field", "ryusa.measure.flow_field:flow_field",
                 "speeds and pressure of the water in the cells of a row of columns at one moment", ("t",),
                 fed=True, clumps=True, grainless=True, table=True, needs=("row",)),
    MeasureEntry("bed_waves", "ryusa.measure.bed_waves:bed_waves",
                 "waves of the bed of a periodic row of columns, and the surface over them", WINDOW,
                 settled=True, table=True, needs=("row", "period")),
    MeasureEntry("x_t", "ryusa.measure.depth_history:depth_history",
                 "depth, bed, discharge of water and grains of a row of columns over distance and time",
                 ("bed", *WINDOW), settled=True, fed=True, clumps=True, grainless=True, table=True,
                 needs=("row",)),
    MeasureEntry("water_energy", "ryusa.measure.water_energy:water_energy",
                 "every term of the energy account of the water in a row of columns",
                 fed=True, clumps=True, grainless=True, table=True, needs=("row",)),
    MeasureEntry("deposit", "ryusa.measure.deposit:deposit",
                 "slope of a deposit in a row of columns, volume stored behind a dam, share that is trapped",
                 ("dam", "reach", "bed", *WINDOW), settled=True, fed=True, clumps=True,
                 numbers=(("slope", "-"), ("stored_rate", "m2/s"), ("brought_rate", "m2/s"),
                          ("passed_rate", "m2/s"), ("trapped_share", "-")),
                 needs=("row", "open")),
    MeasureEntry("front", "ryusa.measure.front:front",
                 "front of the grains that came in or have moved: place and speed",
                 WINDOW, settled=True, builders=("stream",), fed=True, clumps=True,
                 numbers=(("first_speed", "m/s"), ("front_speed", "m/s")), needs=("open",)),
    MeasureEntry("scour", "ryusa.measure.scour:scour", "scour below a dam in a row of columns over time",
                 ("dam", *WINDOW), settled=True, fed=True, clumps=True, needs=("row", "structures", "open"),
                 numbers=(("depth", "m"), ("at", "m"), ("length", "m"), ("volume", "m2"), ("head", "m"),
                          ("tail", "m"))),
)  # fmt: skip


def picture_of(
    name: str, function: str, doc: str, *, without: tuple[str, ...] = (), drawing: tuple[str, ...] = ()
) -> PictureEntry:
    """The picture of the measure of that name, of the same runs and with its options.

    Parameters
    ----------
    without : options of the measure that the picture does not take.
    drawing : options of the function of the picture itself.
    """
    one = next(entry for entry in MEASURES if entry.name == name)
    options = tuple(keyword for keyword in one.options if keyword not in without)
    return PictureEntry(
        name, function, doc, options, one.settled, name, drawing, one.builders, one.fed, one.clumps,
        one.grainless,
    )  # fmt: skip


PICTURES = (
    PictureEntry("grains", "ryusa.figures.runs:grains", "grains at one moment, to scale",
                 ("t", "colour", "lane"), builders=EVERY_BUILDER, fed=True, clumps=True),
    PictureEntry("forces", "ryusa.figures.runs:forces",
                 "network of contact forces at one moment, as lines between centres", ("t", "lane"),
                 builders=("box", "packing"), clumps=True),
    PictureEntry("tracks", "ryusa.figures.runs:tracks", "paths of grains over the bed, to scale",
                 ("grains", *WINDOW, "length", "exaggeration"), settled=True,
                 builders=("saltation", "drop", "flume"), clumps=True),
    PictureEntry("spin", "ryusa.figures.runs:spin", "spin over distance", ("grains", "length")),
    PictureEntry("energy", "ryusa.figures.runs:energy", "the energy account over time",
                 builders=EVERY_BUILDER, fed=True, clumps=True),
    PictureEntry("contacts", "ryusa.figures.runs:contacts", "distribution of contact times", settled=True,
                 builders=("saltation", "drop"), fed=True, clumps=True),
    PictureEntry("hops", "ryusa.figures.runs:hops", "distribution of jump heights and lengths", settled=True,
                 builders=("saltation",)),
    PictureEntry("profile", "ryusa.figures.runs:profile", "concentration and grain speed over height",
                 WINDOW, settled=True, builders=("flume", "packing"), clumps=True),
    picture_of("water", "ryusa.figures.water:water",
               "velocity, concentration and shear stress over height"),
    PictureEntry("transport", "ryusa.figures.runs:transport",
                 "transport rate over time, and beside bed-load formulae", WINDOW, settled=True,
                 builders=("flume",), clumps=True),
    picture_of("dispersion", "ryusa.figures.dispersion:dispersion",
               "mean squared displacement over lag, and fitted diffusivities", without=("layer",)),
    picture_of("contact_stress", "ryusa.figures.contact_stress:contact_stress",
               "stress over height beside the weight above, and mu over I", without=("layer",)),
    PictureEntry("surface", "ryusa.figures.runs:surface", "a heap with its free surface and fitted slope",
                 ("t", "side", "lane"),
                 builders=("box", "empty"), fed=True, clumps=True),
    PictureEntry("shapes", "ryusa.figures.clump_shapes:clump_shapes",
                 "forms of the clumps, from two sides, beside the sphere of the same volume", fed=True,
                 clumps=True),
    picture_of("cone", "ryusa.figures.cone:cone",
               "a round heap: height over distance from its axis, with its slope"),
    picture_of("dynamic_angle", "ryusa.figures.dynamic_angle:dynamic_angle",
               "angle of the surface in a drum over time"),
    picture_of("shear", "ryusa.figures.plane_shear:plane_shear",
               "velocity and concentration between base and lid, and mu over I beside a published law"),
    picture_of("direct_shear", "ryusa.figures.direct_shear:direct_shear",
               "friction and rise of the lid of a direct shear test over displacement"),
    picture_of("shear_zone", "ryusa.figures.shear_zone:shear_zone",
               "angular velocity of the surface over the radius, and the zone over height"),
    picture_of("mill", "ryusa.figures.mill:mill",
               "torque of a drum, and the energy that it gives and its grains lose, over its turns"),
    PictureEntry("sizes", "ryusa.figures.runs:sizes",
                 "percent finer by mass over diameter, asked for and laid", clumps=True),
    picture_of("walls", "ryusa.figures.walls:walls",
               "force on each wall over time, and the power of those that move", drawing=("wall",)),
    picture_of("loads", "ryusa.figures.loads:loads",
               "force of water and grains on dams and walls in a row of columns over time",
               drawing=("wall",)),
    picture_of("discharge", "ryusa.figures.discharge:discharge",
               "mass in by each feed and out by each exit, and mass there, over time"),
    picture_of("passages", "ryusa.figures.passages:passages",
               "mass in by each feed and out by each exit, grain by grain, and what feeds owe"),
    picture_of("long_section", "ryusa.figures.long_section:long_section",
               "bed, water, energy line, Froude number and transport along a row of columns"),
    picture_of("flow_field", "ryusa.figures.flow_field:flow_field",
               "arrows of the speed of the water in a row of columns over colours of its pressure"),
    picture_of("x_t", "ryusa.figures.long_section:x_t",
               "depth, change of the bed and transport of a row of columns over distance and time",
               drawing=("quantity",)),
    picture_of("deposit", "ryusa.figures.deposit:deposit",
               "volume that came, went and is stored, and slope of the deposit, over time"),
    picture_of("front", "ryusa.figures.front:front",
               "place of the first grain and of the front over time"),
    PictureEntry("vibration", "ryusa.figures.runs:vibration", "grains that do not come to rest",
                 ("grains", *WINDOW)),
)  # fmt: skip


def option(keyword: str) -> str:
    """Return the option of the command line that sets a keyword.

    >>> option("begin"), option("t")
    ('--begin', '--at')
    """
    return OPTION_NAMES.get(keyword, f"--{keyword}")


def load(function: str) -> Callable[..., Any]:
    """Import a function given as "module:function".

    >>> load("math:sqrt")(4.0)
    2.0
    """
    module, _, name = function.partition(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


def called(entry: MeasureEntry | PictureEntry) -> Callable[..., Any]:
    """Import what a measure or picture calls; it refuses runs that its flags do not allow.

    Raises
    ------
    ResultsError : by the function returned.
    """
    function = load(entry.function)
    if (entry.fed and entry.clumps and entry.grainless) or (
        isinstance(entry, PictureEntry) and entry.measure
    ):
        return function

    @wraps(function)
    def refusing(run: Any, *args: Any, **options: Any) -> Any:
        if not entry.grainless and not run.scene.n_grain and not run.scene.n_fixed:
            raise ResultsError(
                f"{entry.name} needs grains, and this run has water alone; of such a run there are "
                f"{_names('grainless')}"
            )
        if not entry.fed and getattr(run.scene, "traffic", None) is not None:
            raise ResultsError(
                f"{entry.name} needs the same grains in every frame, and this run has feeds or exits, which "
                f"let grains in and out; of such a run there are {_names('fed')}"
            )
        if not entry.clumps and getattr(run.scene, "bodies", None) is not None:
            raise ResultsError(
                f"{entry.name} takes every sphere for a grain, and this run has clumps; of such a run there "
                f"are {_names('clumps')}"
            )
        return function(run, *args, **options)

    return refusing


def _names(flag: str) -> str:
    """Measures and pictures that have a flag."""
    return ", ".join(dict.fromkeys(one.name for one in (*MEASURES, *PICTURES) if getattr(one, flag)))
