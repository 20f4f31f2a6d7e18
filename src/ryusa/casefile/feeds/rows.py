"""Rows of [[feeds]] and [[exits]] in an explained case."""

from ryusa.casefile.case import Case
from ryusa.casefile.feeds.values import (
    FULLEST,
    FULLEST_PLANE,
    fed_count,
    feed_begin,
    feed_end,
    grains_per_second,
    mean_mass,
    share_filled,
    unit_of,
)
from ryusa.casefile.rows import ExplainRow, count, number, word

_DENSE = 0.6  # of the fullest share, from which some grains wait for a place


def traffic_rows(case: Case) -> list[ExplainRow]:
    """Rates, numbers and room of every feed; where grains leave."""
    rows: list[ExplainRow] = []
    most = FULLEST_PLANE if case.motion.plane else FULLEST
    for k, feed in enumerate(case.feeds):
        key, name = f"feeds.{k}", f"feed '{feed.name}'"
        if not feed.brings:
            rows.append(word("traffic", name, "recirculation", "only grains that an exit leads to it"))
            continue
        rate, end = grains_per_second(case, feed), feed_end(case, feed)
        shown = f"{rate:.4g} grains/s, {rate * mean_mass(case, feed.material):.4g} kg/s"
        which = "rate" if feed.sedigraph is None else "sedigraph, at its peak"
        window = f"{key}.{which}, from {feed_begin(case, feed):g} s to {end:g} s"
        rows.append(ExplainRow("traffic", name, rate, "1/s", shown, window))
        by_mass = ", with the mean mass of a grain" if unit_of(case, feed) == "kg/s" else ""
        about = "rate times duration" + by_mass
        rows.append(count("traffic", f"{name}: grains", fed_count(case, feed), about))
        share = share_filled(case, feed, rate)
        late = (
            f"; some grains will wait for a place, near {most:g} none is left"
            if share > _DENSE * most
            else ""
        )
        filled = f"share of the room at the feed that grains fill; at most {most:g} at random{late}"
        flag = "warning" if late else ""
        rows.append(number("traffic", f"{name}: filled", share, "-", filled, flag))
    for k, one in enumerate(case.exits):
        where = "plane" if one.point is not None else "box"
        then = "leave the run" if one.to is None else f"come in again at feed '{one.to}'"
        rows.append(word("traffic", f"exit '{one.name}'", where, f"exits.{k}; grains {then}"))
    return rows
