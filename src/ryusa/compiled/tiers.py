"""The stores that are asked for code."""

from functools import cache

from ryusa.compiled import store
from ryusa.compiled.shipped import shipped
from ryusa.compiled.store import Store


@cache
def in_order() -> tuple[Store, ...]:
    """The user's own store, then what comes as a package."""
    package = shipped().store
    return (store.own(),) if package is None else (store.own(), package)
