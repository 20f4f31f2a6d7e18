"""Contacts as a film shows them: wording, settings and factors; the bands are in the registration."""

from dataclasses import dataclass

from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design

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
# The film that is judged. A contact that is seen at all lasts at least from one frame to the next. That time
# must lie below the band, or the claim would hold whatever the grains do.
FPS = 1000.0
PART = f"mean time in contact on a film of {FPS:g} frames per second"
SEEN = band("film-saltation", PART)  # the same for all flows
SLOWER = (250.0, 100.0)  # shown beside it, not judged: 4 and 10 ms from one frame to the next
COLLISION = "collision time"
RESOLUTION = "resolution"
RESOLUTIONS = ("0.05 d", "0.02 d", "0.1 d")  # gap from which two grains look apart: d is 20, 50 or 10 pixels
# The resolution is a way of looking at the same run: a factor as well, without runs of its own.
DESIGNS = {one: design(one) for one in ("film-saltation", "film-avalanche", "film-debris")}


@dataclass(frozen=True)
class FilmedFlow:
    """One flow that is filmed.

    Attributes
    ----------
    case : case file of the figure that it is taken from.
    changed : keys of the case that are set, and their values.
    """

    case: str
    changed: dict[str, str]


_FRAMES = {
    "record.frames": "0.25 ms",
    "record.events": "all",
}  # four to each frame of the film that is judged
FLOWS = {
    "film-saltation": FilmedFlow(
        "saltation",
        {"build.starts": "16", "record.settle": "0.5 s", "stop.time": "1 s", **_FRAMES},
    ),
    "film-avalanche": FilmedFlow(
        "avalanche",
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
