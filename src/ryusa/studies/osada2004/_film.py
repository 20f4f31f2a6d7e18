"""Contacts as a film shows them: wording, bands, settings and factors, decided before any run."""

from dataclasses import dataclass

from ryusa.study import Band

SECTION = "section 3, after Fig. 7"
JAPANESE = (
    "実験時の運動軌跡のビデオ解析からみて、"
    "実際の粒子間の衝突時間は概ね 0.01 秒オーダー程度であると推定される。"
)
TRANSLATION = (
    "Judging from video analysis of the paths of motion in experiments, the actual collision time between "
    "particles is estimated to be roughly of the order of 0.01 s."
)
# What is measured: the mean length of the apparent contacts of all pairs, of two free grains or of one with a
# fixed grain; each stay within the resolution counts once (`ryusa.measure.apparent_contact`). Stays that
# the end of the film cuts off are completed after Kaplan and Meier.
CUT = 0.2  # share of the stays cut off from which on the mean is not known, and nothing is judged
SEEN = Band(0.003, 0.03, "s", "of the order of 0.01 s: one order of magnitude centred on it, 0.003 to 0.03 s")
# The film that is judged. A contact that is seen at all lasts at least from one frame to the next. That time
# must lie below the band, or the claim would hold whatever the grains do.
FPS = 1000.0
SLOWER = (250.0, 100.0)  # shown beside it, not judged: 4 and 10 ms from one frame to the next
COLLISION = "collision time"
COLLISIONS = ("1e-4 s", "1e-5 s")  # that of the paper; by Hertz that of 2 mm quartz at 0.05 to 0.5 m/s
FILM = "water film"
FILMS = ("none", "lubrication", "rebound by Stokes number")
RESOLUTION = "resolution"
RESOLUTIONS = ("0.05 d", "0.02 d", "0.1 d")  # gap from which two grains look apart: d is 20, 50 or 10 pixels
# Base settings: the first level of every factor. Sample: the seeds of the plan, three at the standard level,
# for every setting alike. Test: the 95 % interval of the mean over seeds lies in the band.


@dataclass(frozen=True)
class FilmedFlow:
    """One flow that is filmed.

    Attributes
    ----------
    case : case file of the figure that it is taken from.
    setup : in words.
    films : levels of the water film.
    changed : keys of the case that are set, and their values.
    """

    case: str
    setup: str
    films: tuple[str, ...]
    changed: dict[str, str]


_FRAMES = {
    "record.frames": "0.25 ms",
    "record.events": "all",
}  # four to each frame of the film that is judged
FLOWS = {
    "film-saltation": FilmedFlow(
        "saltation",
        "16 saltating grains of 0.2 cm over fixed ones, as in fig7, rotation locked; filmed for 0.5 s",
        FILMS,
        {"build.starts": "16", "record.settle": "0.5 s", "stop.time": "1 s", **_FRAMES},
    ),
    "film-avalanche": FilmedFlow(
        "avalanche",
        "dry avalanche on 40 deg, as in fig14, of 100 grains of 0.2 cm, the size of laboratory films: "
        "lengths over 100, times over 10 by Froude; filmed from 0.1 to 0.3 s after tilting",
        FILMS[:1],
        {
            "grains.diameter": "0.2 cm",
            "build.columns": "10",
            "timeline.0.at": "0.1 s",
            "record.settle": "0.2 s",
            "stop.time": "0.4 s",
            **_FRAMES,
        },
    ),
    "film-debris": FilmedFlow(
        "fig17",
        "Ito's debris flow, as in fig17, rotation locked; its dashpots given as restitution 0.7, tangential "
        "0.9; filmed for 0.25 s",
        FILMS,
        {
            "contact.restitution": "0.7",
            "contact.restitution_shear": "0.9",
            "record.settle": "0.45 s",
            "stop.time": "0.7 s",
            **_FRAMES,
        },
    ),
}
# Expected in closed form for d = 0.2 cm and speeds v of 0.05 to 0.5 m/s: a straight impact and rebound is
# within 0.1 d for 0.2 d/v, 0.8 to 8 ms; a grain that pivots over its neighbour stays for d/v, 4 to 40 ms.
#
# Question: do films that show 0.01 s contradict a model with collisions of 1e-4 s? Not in a flow where the
# claim holds at 1e-4 s; where it also holds at 1e-5 s, the time on the film does not depend on the springs.
