"""The packaged cases by the question that a user comes with: `ryusa new`, and the first page of the docs."""

from dataclasses import dataclass


@dataclass(frozen=True)
class CaseQuestion:
    """A job of an engineer or a researcher.

    Attributes
    ----------
    asked : the question.
    page : page of the documentation that says more, in docs/, with its heading where it has several subjects.
    cases : packaged cases that answer it, the nearest first; none where another command or nothing does.
    commands : what to type after `ryusa run`, in order.
    answer : what comes out, and what it does not cover.
    measures : those whose numbers answer it on the page of `ryusa report --brief`, the most telling first.
    pictures : those that show it there; the first that a run allows is taken.
    """

    asked: str
    page: str
    cases: tuple[str, ...]
    commands: tuple[str, ...]
    answer: str
    measures: tuple[str, ...] = ()
    pictures: tuple[str, ...] = ()


QUESTIONS = (
    CaseQuestion(
        "How much bed load does my reach carry?", "bedload-notebook.md",
        ("bedload_3d", "even_bed", "movable_bed"),
        ("ryusa measure RUN transport", "ryusa sweep CASE --seeds 4"),
        "kg/s per metre of width with its error, beside Meyer-Peter & Müller and Wong & Parker",
        ("transport",), ("transport",),
    ),
    CaseQuestion(
        "How do single grains hop along a bed?", "saltation.md",
        ("saltation",), ("ryusa measure RUN saltation",),
        "height, length and speed of the hops, contact times; no rate", ("saltation",), ("tracks",),
    ),
    CaseQuestion(
        "And in a steep or violent flow?", "cases-of-your-own.md#a-bed-under-water",
        ("sheet_flow", "dense_3d", "dense_plane"),
        ("ryusa measure RUN transport", "ryusa measure RUN profile"),
        "rate, layer that moves, profiles of velocity and concentration",
        ("transport",), ("transport", "profile"),
    ),
    CaseQuestion(
        "How does a reach change in a flood?", "river.md#a-river-in-flood", ("river", "fed_river"),
        ("ryusa draw RUN long_section", "ryusa measure RUN discharge"),
        "bed and water along the reach over time; the water is hydrostatic, so no bed forms",
        ("discharge", "deposit"), ("long_section",),
    ),
    CaseQuestion(
        "What does a weir or a flume with a feeder do?", "river.md#a-weir", ("weir", "flume"),
        ("ryusa draw RUN x_t", "ryusa measure RUN discharge", "ryusa measure RUN loads"),
        "jump, ponded depth, grains in and out, force on the weir with the water in it",
        ("levels", "loads", "discharge"), ("long_section", "discharge", "grains"),
    ),
    CaseQuestion(
        "Will this dam hold, and when is it full?", "loads.md", ("sabo_dam", "dam"),
        ("ryusa measure RUN loads", "ryusa measure RUN deposit"),
        "force and moment of water and grains per metre, volume trapped; the water's impact is not in it",
        ("loads", "walls", "filling", "deposit"), ("long_section", "walls", "grains"),
    ),
    CaseQuestion(
        "Will this grid hold the debris flow?", "river-limits.md", (),
        ("ryusa new validation/debris_grid", "ryusa view RUN", "ryusa measure RUN walls"),
        "what the openings of the bars let pass, and the force on these; water passes bars and jam alike",
    ),
    CaseQuestion(
        "How far does a debris flow run, and what stays?", "debris-flows.md",
        ("slope_break", "debris_flume", "debris_equilibrium"),
        ("ryusa measure RUN front", "ryusa measure RUN deposit"),
        "front over time, deposit, slope it rests at",
        ("front", "deposit"), ("long_section", "front", "grains"),
    ),
    CaseQuestion(
        "What does a dam break or a delta do to loose ground?",
        "debris-flows.md#a-dam-break-over-a-loose-bed",
        ("dam_break", "delta"),
        ("ryusa draw RUN long_section", "ryusa measure RUN front"), "wave, erosion, front of the delta",
        ("front", "deposit"), ("long_section", "front", "grains"),
    ),
    CaseQuestion(
        "Which waves does a steep stream make of its bed?", "along-a-row.md", ("antidunes",),
        ("ryusa measure RUN bed_waves", "ryusa draw RUN x_t"),
        "length, height, speed of waves, and their surface",
        ("transport",), ("x_t", "flow_field", "grains"),
    ),
    CaseQuestion(
        "Does pore water hold a slope under water, or let it run?", "river.md#with-a-pressure-of-its-own",
        ("immersed_column",),
        ("ryusa draw RUN flow_field", "ryusa measure RUN front"), "pore pressure, flow within, run-out",
        ("front",), ("flow_field", "grains"),
    ),
    CaseQuestion(
        "How deep does the jet below a weir dig?", "river.md#with-a-pressure-of-its-own", ("scour",),
        ("ryusa measure RUN scour", "ryusa draw RUN flow_field"),
        "depth, place, length of the hole over time, beside Schoklitsch's in the end; not converged",
        ("scour",), ("flow_field", "long_section"),
    ),
    CaseQuestion(
        "How deep is the scour at a pier?", "beside-other-programs.md", (), (),
        "not to be had: a row has no flow round a pier",
    ),
    CaseQuestion(
        "What is the angle of repose of my material?", "heap-notebook.md",
        ("poured_heap", "lifted_cylinder", "gravel_heap", "heap"),
        ("ryusa measure RUN cone", "ryusa calibrate STUDY.toml"),
        "slope of the heap with its error; friction and rolling friction from your own test",
        ("cone", "surface"), ("cone", "surface"),
    ),
    CaseQuestion(
        "How fast does my hopper empty?", "feeds-and-exits.md", ("hopper",), ("ryusa measure RUN discharge",),
        "kg/s through the outlet", ("discharge",), ("discharge", "grains"),
    ),
    CaseQuestion(
        "How far does a column or a slope collapse?", "cases-of-your-own.md#a-heap-behind-a-gate",
        ("column_collapse", "channel_collapse"),
        ("ryusa measure RUN surface",), "run-out and shape of the deposit",
        ("surface",), ("surface", "grains"),
    ),
    CaseQuestion(
        "What strength does my material have, in a shear box or under a lid?", "lids.md",
        ("direct_shear", "shear_cell", "split_bottom"),
        ("ryusa measure RUN direct_shear", "ryusa measure RUN shear"),
        "friction over shear, dilation, profile; the lid is pressed by a servo and may be dragged",
        ("direct_shear", "shear", "shear_zone"), ("direct_shear", "shear", "shear_zone"),
    ),
    CaseQuestion(
        "How do grains flow, mix and sort in a drum or mill?", "walls.md", ("drum", "mill"),
        ("ryusa measure RUN dynamic_angle", "ryusa measure RUN segregation"), "angle, torque, sorting",
        ("dynamic_angle", "mill"), ("dynamic_angle", "mill"),
    ),
    CaseQuestion(
        "How do suspended or mixed grains settle?", "sieve-curves.md", ("settling_column", "graded_gravel"),
        ("ryusa measure RUN profile", "ryusa measure RUN segregation"), "hindered settling, sorting of a bed",
        ("segregation",), ("profile", "grains"),
    ),
    CaseQuestion(
        "Does the program do what it says?", "validation.md", ("drop", "box"),
        ("ryusa measure RUN collisions", "ryusa validate --quick"),
        "restitution, contact time, energy account",
        ("collisions",), ("contacts", "energy"),
    ),
    CaseQuestion(
        "How soft may I make the springs, and how many seeds do I need?", "how-soft.md", (),
        ("ryusa soften CASE.toml", "stop.precision in the case"),
        "the softest contacts that do not change the answer; a run that ends by the error of its averages",
    ),
)  # fmt: skip

OTHER_WORDS = {  # for what a case holds -> the case
    **dict.fromkeys(("lid", "jack", "piston", "plate", "press", "servo", "annular_shear"), "shear_cell"),
    **dict.fromkeys(("shear_box", "shearbox", "shear_test", "oedometer", "triaxial"), "direct_shear"),
    **dict.fromkeys(("silo", "bin"), "hopper"),
    **dict.fromkeys(("chute", "barrier"), "dam"),
}
