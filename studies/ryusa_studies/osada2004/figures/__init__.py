"""Pictures that the paper has and no other run needs."""

from ryusa_studies.osada2004.figures.drops import QuotedPoint, ReboundCurve, drop_chart, over_speed, rebounds
from ryusa_studies.osada2004.figures.rods import rod_lengths, rods
from ryusa_studies.osada2004.figures.sensitivity import SensitivityRow, sensitivity

__all__ = [
    "QuotedPoint",
    "ReboundCurve",
    "SensitivityRow",
    "drop_chart",
    "over_speed",
    "rebounds",
    "rod_lengths",
    "rods",
    "sensitivity",
]
