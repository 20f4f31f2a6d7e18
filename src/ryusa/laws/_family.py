"""A family of named choices, and the compiled function that calls a law by its number."""

import inspect
import math
from collections.abc import Callable
from enum import IntEnum
from functools import cache
from typing import Any, Self, TypeVar, cast

from ryusa.compiled.function import compiled_law
from ryusa.compiled.lanes import known_lanes

F = TypeVar("F", bound=Callable[..., Any])


class Family(IntEnum):
    """A closed set of choices, one per line; base of the tables in `ryusa.laws.families`.

    A member is written as a tuple of its number and the attributes below. Scenes, checkpoints and kernels
    hold the number, which never changes; case files use the word.

    Attributes
    ----------
    word : value in a case file; empty if a case file cannot select it.
    function : the law; None if there is nothing to evaluate, or if the choice is a rule.
    about : its meaning, in one line.
    source : publication or equation.
    takes : case keys, in the section of the family, that apply to this choice but not to all choices.
    marks : properties that distinguish a rule from the others of its family; read by `marked`.
    """

    _value_: int
    word: str
    function: Callable[..., Any] | None
    about: str
    source: str
    takes: tuple[str, ...]
    marks: tuple[str, ...]

    key: str  # case key of the family

    def __new__(
        cls,
        number: int,
        word: str,
        function: Callable[..., Any] | None,
        about: str,
        source: str = "",
        takes: tuple[str, ...] = (),
        marks: tuple[str, ...] = (),
    ) -> Self:
        if number in cls._value2member_map_:
            taken = cls._value2member_map_[number].name
            raise ValueError(
                f"{cls.__name__}: '{word}' = {number}, the number of {taken}; take one above all others"
            )
        member = int.__new__(cls, number)
        member._value_ = number
        member.word, member.function, member.about, member.source = word, function, about, source
        member.takes, member.marks = takes, marks
        return member

    def __init_subclass__(cls, key: str = "") -> None:
        super().__init_subclass__()
        cls.key = key

    @classmethod
    def words(cls) -> tuple[str, ...]:
        """Words that a case file may use, in the order of their numbers."""
        return tuple(choice.word for choice in cls if choice.word)

    @classmethod
    def of(cls, word: str) -> Self:
        """Return the choice with a given word.

        Raises
        ------
        ValueError : no choice has this word.
        """
        found = _by_word(cls).get(word)
        if found is None:
            raise ValueError(
                f"{cls.key or cls.__name__}: {word!r} is none of {', '.join(map(repr, cls.words()))}"
            )
        return cast(Self, found)

    @classmethod
    def all_takes(cls) -> tuple[str, ...]:
        """Case keys that apply to at least one choice of the family."""
        return _all_takes(cls)


@cache
def _by_word(family: type[Family]) -> dict[str, Family]:
    """Choices of a family that a case file can select, by their words."""
    return {choice.word: choice for choice in reversed(family) if choice.word}  # of two alike the first


@cache
def _all_takes(family: type[Family]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(key for choice in family for key in choice.takes))


def dispatch(
    family: type[Family],
    arguments: tuple[str, ...],
    *,
    answers: int = 1,
    unasked: tuple[Family, ...] = (),
    fastmath: bool | set[str] = False,
) -> Any:
    """Build the compiled function that evaluates the law with a given number: f(number, *arguments).

    Parameters
    ----------
    family : the choices.
    arguments : names of the arguments of f, in order. A law receives those that its parameters name.
    answers : number of values that each law returns; a tuple if more than one.
    unasked : choices that callers handle themselves, without calling f.
    fastmath : passed to Numba.

    Notes
    -----
    For a number outside the family f returns nan, on which every engine stops. The function is compiled
    into its callers, on the CPU and for CUDA; from Python use `evaluate`.

    Raises
    ------
    TypeError : a choice has no function, or its function has a parameter that is not among `arguments`.
    """
    flags = frozenset(fastmath) if isinstance(fastmath, set) else fastmath
    chain = _nothing_known(answers, flags)
    for choice in reversed(family):
        if choice in unasked:
            continue
        places = tuple(map(arguments.index, _asked_by(choice, arguments)))
        name = f"{family.__name__}.{choice.name}.{'_'.join(arguments)}"
        chain = _link(int(choice), choice.function, _picker(places, flags), chain, flags, name)
    return chain


def lanes_of_law(choice: Family, arguments: tuple[str, ...], read: Any, write: Any, lanes: int) -> Any:
    """Build the compiled loop of one law over lanes: f(m, batch, shared), which becomes vector instructions.

    Parameters
    ----------
    choice, arguments : the law, and the names of the arguments of its family, in order.
    read : compiled; read(lane, batch, shared) returns all arguments, in order.
    write : compiled; write(lane, batch, answer) keeps what the law answers.
    lanes : the most there are, a power of two; the loop is over the first m, 1 or more.
    """
    law: Any = choice.function
    pick = _picker(tuple(map(arguments.index, _asked_by(choice, arguments))), False)

    @_link_of(False, f"{type(choice).__name__}.{choice.name}")
    def loop(m: Any, batch: Any, shared: Any) -> None:
        for lane in range(known_lanes(m, lanes)):
            write(lane, batch, law(*pick(read(lane, batch, shared))))

    return loop


def marked(family: type[Family], mark: str) -> Any:
    """Build the compiled function that returns whether the choice with a given number has a mark: f(number).

    Raises
    ------
    TypeError : no choice of the family has this mark.
    """
    bits = sum(1 << int(choice) for choice in family if mark in choice.marks)
    if not bits:
        raise TypeError(f"no choice of {family.__name__} is marked '{mark}' in laws/families.py")

    @_link_of(False, f"{family.__name__}.{mark}")
    def carries(chosen: Any) -> Any:
        return (bits >> chosen) & 1 != 0

    return carries


def rules(family: type[Family], *marks: str) -> tuple[Any, ...]:
    """Build the compiled functions of `marked` for a family whose choices differ only in these marks.

    Raises
    ------
    TypeError : two choices have the same marks, or a choice has another mark or another function.
    """
    first = next(iter(family))
    for choice in family:
        twins = [one for one in family if one < choice and set(one.marks) == set(choice.marks)]
        if twins or not set(choice.marks) <= set(marks) or choice.function is not first.function:
            raise TypeError(
                f"{_name(choice)} must differ from the choices before it by marks alone, and by none but "
                f"{', '.join(map(repr, marks))}"
            )
    return tuple(marked(family, mark) for mark in marks)


def numbers(where: str, *choices: Family) -> tuple[int, ...]:
    """Numbers of all choices of a family, for a module that distinguishes them by comparisons.

    Parameters
    ----------
    where : name of the module.
    choices : all choices of the family; their numbers are returned in this order.

    Raises
    ------
    TypeError : a choice of the family is not listed.
    """
    for choice in type(choices[0]):
        if choice not in choices:
            raise TypeError(f"{_name(choice)} has no branch in {where}")
    return tuple(map(int, choices))


def evaluate(choice: Family, **given: Any) -> Any:
    """Evaluate the law of a choice from Python, with those of the `given` values that its parameters name.

    Raises
    ------
    TypeError : the choice has no function, or one of its parameters is not given.
    """
    names = _asked_by(choice, tuple(given))
    assert choice.function is not None
    return choice.function(*(given[name] for name in names))


def _asked_by(choice: Family, arguments: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the parameters of the law of a choice."""
    if choice.function is None:
        raise TypeError(f"{_name(choice)} has no function in laws/families.py, and its dispatch asks for one")
    names = _parameters(choice.function)
    for name in names:
        if name not in arguments:
            raise TypeError(f"{_name(choice)} asks for '{name}'; its family is given {', '.join(arguments)}")
    return names


@cache
def _parameters(function: Callable[..., Any]) -> tuple[str, ...]:
    """Names of the parameters of a law; kept, because a settling velocity evaluates a law a hundred times."""
    return tuple(inspect.signature(getattr(function, "py_func", function)).parameters)


def _name(choice: Family) -> str:
    """A choice as messages name it: family, name and word."""
    return f"{type(choice).__name__}.{choice.name} ('{choice.word}')"


def _link_of(fastmath: Any, name: str) -> Callable[[F], F]:
    """A part of a dispatch, with the laws in its closure; `name` tells what it holds to whoever lists it."""
    fast = set(fastmath) if isinstance(fastmath, frozenset) else fastmath

    def decorate(function: F) -> F:
        function.__qualname__ = f"{function.__qualname__}.{name}"
        return compiled_law(fastmath=fast, forceinline=True)(function)

    return decorate


@cache
def _picker(places: tuple[int, ...], fastmath: Any) -> Any:
    """Function that selects the arguments of a law, by their positions, from all arguments of its family."""
    if not places:

        @_link_of(fastmath, "none")
        def none(given: Any) -> Any:
            return ()

        return none
    first, rest = places[0], _picker(places[1:], fastmath)

    @_link_of(fastmath, "_".join(map(str, places)))
    def pick(given: Any) -> Any:
        return (given[first], *rest(given))

    return pick


def _link(number: int, law: Any, pick: Any, rest: Any, fastmath: Any, name: str) -> Any:
    """One branch of a dispatch: this law if the number matches, else the remaining branches."""

    @_link_of(fastmath, name)
    def link(chosen: Any, *given: Any) -> Any:
        if chosen == number:
            return law(*pick(given))
        return rest(chosen, *given)

    return link


def _nothing_known(answers: int, fastmath: Any) -> Any:
    """Last branch of a dispatch: a number outside the family."""
    lost = math.nan if answers == 1 else (math.nan,) * answers

    @_link_of(fastmath, str(answers))
    def unknown(chosen: Any, *given: Any) -> Any:
        return lost

    return unknown
