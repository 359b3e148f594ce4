"""Models are checked by their annotations, including those from outside the package."""

from __future__ import annotations

import collections
import dataclasses
import typing
from fractions import Fraction
from typing import Annotated, Any, Literal, NamedTuple, Optional, Union

import numpy as np
import pytest

from hav_env import Observation, OnAxle, RandomFleet, RandomPoses, Task, parallel_env
from hav_env.compiled import canonical
from hav_env.models.annotations import Range
from hav_env.models.checks import check_fields, check_relations, check_value

if typing.TYPE_CHECKING:
    from somewhere import Unknown


class Inner(NamedTuple):
    """A model in a model."""

    gain: float = 1.0


class Stranger(NamedTuple):
    """A model with annotations that are strings, as in a user's module."""

    share: Annotated[float, Range(0.0, 1.0, "m", "a share")] = 0.5
    length: Annotated[float, Range(0.1, 20.0, "m")] = 4.0
    count: Annotated[int, Range(1, 9)] = 3
    plain: float = 0.0
    whole: int = 0
    flag: bool = False
    word: Literal["left", "right"] = "left"
    inner: Inner = Inner()
    array: np.ndarray = np.zeros(2)
    maybe: int | None = None
    old: Optional[float] = None  # noqa: UP045
    either: Union[Inner, int] = 0  # noqa: UP007
    several: tuple[Annotated[int, Range(1, 5)], ...] = (1, 2)
    text: str = ""
    anything: Any = 1.0
    unknown: Unknown = None


GOOD = [
    *(("share", value) for value in (0, 1, 0.5, np.float32(0.5), np.int8(1), Fraction(1, 3))),
    *(("count", value) for value in (1, 9, np.int64(5), np.uint8(9))),
    *(("plain", value) for value in (-1e308, 1e308, 5, np.float16(3), np.longdouble(1))),
    *(("whole", value) for value in (-(2**63), 2**63 - 1, np.int8(-1))),
    *(("flag", value) for value in (True, np.False_)),
    *(("word", value) for value in ("left", np.str_("right"))),
    *(("inner", value) for value in (Inner(), Inner(3), Inner(np.float32(2)))),
    *(("array", value) for value in (np.zeros(0), np.ones((2, 2), np.float32), np.arange(3))),
    *(("maybe", value) for value in (None, 3, np.int64(3))),
    *(("old", value) for value in (None, 3.5)),
    *(("either", value) for value in (3, Inner())),
    *(("several", value) for value in ((), (5,), (np.int64(1), 2))),
    ("text", "words"),
    *(("anything", value) for value in (None, "x", 1, Inner(), np.ones(2), np.float32(1))),
    *(("unknown", value) for value in (None, "x", 1)),
]


@pytest.mark.parametrize(("field", "value"), GOOD)
def test_what_is_allowed_passes(field, value):
    check_fields("stranger", Stranger()._replace(**{field: value}))


NAN, INF = float("nan"), float("inf")
BAD = [
    ("share", -1e-9, ValueError, "stranger share is -1e-09, but must be a share"),
    ("share", NAN, ValueError, "stranger share is nan, but must be a share"),
    ("length", 1e-3, ValueError, "is 0.001, but must be at least 0.1 m and at most 20 m"),
    ("length", "4", TypeError, "is 4, a str and not a number, but must be at least 0.1 m"),
    ("length", True, TypeError, "is True, a bool and not a number"),
    ("count", 0, ValueError, "stranger count is 0, but must be at least 1 and at most 9"),
    ("count", 2.5, ValueError, "is 2.5, but must be at least 1 and at most 9, a whole number"),
    ("count", 2.0, ValueError, "stranger count is 2.0, but must be .* a whole number"),
    ("count", np.True_, TypeError, "count is True, a bool_? and not a whole number"),
    ("plain", INF, ValueError, "stranger plain is inf, but must be finite"),
    ("plain", 10**400, ValueError, "stranger plain is 1000.* but must be finite"),
    ("whole", 2**63, ValueError, "whole is 9223372036854775808, but must be a whole number of 64"),
    ("flag", 1, ValueError, "stranger flag is 1, but must be True or False"),
    ("flag", "no", TypeError, "stranger flag is 'no', but must be True or False"),
    ("word", "up", ValueError, "stranger word is 'up', but must be left or right"),
    ("word", 0, ValueError, "stranger word is 0, but must be left or right"),
    ("word", np.array(["left"]), ValueError, "stranger word is array"),
    ("inner", None, TypeError, "stranger inner is None, but must be an Inner"),
    ("inner", (1.0,), TypeError, "stranger inner is .*, but must be an Inner"),
    ("inner", Inner(NAN), ValueError, "^inner gain is nan, but must be finite"),
    ("array", [1.0], TypeError, "stranger array is .*, a list, but must be an array"),
    ("array", np.array(["1"]), TypeError, "but must be an array of real numbers"),
    ("array", np.array([1j]), TypeError, "but must be an array of real numbers"),
    ("array", np.array([True]), TypeError, "but must be an array of real numbers"),
    ("array", np.array([1.0, NAN]), ValueError, "array is .*, which holds nan, but must be finite"),
    ("maybe", 1.5, ValueError, "stranger maybe is 1.5, but must be a whole number"),
    ("maybe", "", TypeError, "stranger maybe is"),
    ("old", "1", TypeError, "stranger old is 1, a str"),
    ("either", "1", TypeError, "stranger either is 1"),
    ("several", [1], TypeError, "several is .*, but must be a tuple"),
    (
        "several",
        (1, 6),
        ValueError,
        r"several is \(1, 6\): a part of it is 6, but must be at least",
    ),
    ("text", 3, TypeError, "stranger text is 3, but must be a str"),
    ("anything", NAN, ValueError, "stranger anything is nan, but must be finite"),
    ("anything", np.array([INF]), ValueError, "stranger anything is"),
    ("anything", Inner(INF), ValueError, "gain is inf, but must be finite"),
    ("unknown", INF, ValueError, "stranger unknown is inf"),
]


@pytest.mark.parametrize(("field", "value", "error", "message"), BAD)
def test_what_is_not_allowed_is_named(field, value, error, message):
    with pytest.raises(error, match=message) as told:
        check_fields("stranger", Stranger()._replace(**{field: value}))
    assert "\n" not in str(told.value)


def test_a_long_value_is_cut_and_one_that_cannot_be_shown_is_not():
    class Rude:
        def __str__(self):
            raise RuntimeError

    with pytest.raises(ValueError, match="dt is an int that cannot be shown, but must be"):
        check_fields("task", Task(dt=10**5000))
    for value in ("x" * 10**6, Rude(), list(range(10**5))):
        with pytest.raises(TypeError, match="dt is") as told:
            check_fields("task", Task(dt=value))
        assert len(str(told.value)) < 300


def test_models_of_other_kinds_are_checked_too():
    untyped = collections.namedtuple("untyped", "gain")

    @dataclasses.dataclass
    class Arguments:
        gain: float = 1.0

    for model in (untyped(NAN), Arguments(NAN)):
        with pytest.raises(ValueError, match=r"^gain is nan, but must be finite"):
            check_fields("", model)
    for nothing in (None, 3, "x", [1]):
        with pytest.raises(TypeError, match=r"it is .*, but must be a NamedTuple"):
            check_fields("it", nothing)


class Pair(NamedTuple):
    low: float = 0.0
    high: float = 1.0


@check_relations.register
def _(pair: Pair) -> None:
    if pair.high < pair.low:
        raise ValueError(f"pair high is {pair.high}, but must be at least low")


class Holder(NamedTuple):
    pair: Pair = Pair()


def test_relations_of_fields_hold_wherever_the_model_stands():
    check_fields("holder", Holder())
    for model in (Pair(2.0), Holder(Pair(2.0))):
        with pytest.raises(ValueError, match=r"pair high is 1\.0"):
            check_fields("it", model)
    with pytest.raises(ValueError, match=r"^pair low is nan"):  # and each field comes first
        check_fields("it", Holder(Pair(NAN)))


def test_arguments_without_a_model_are_checked_alike():
    check_value("num_worlds", Annotated[int, Range(1, 10)], np.int64(10))
    with pytest.raises(ValueError, match=r"^num_worlds is 11, but must be at least 1"):
        check_value("num_worlds", Annotated[int, Range(1, 10)], 11)


def test_compiled_code_gets_pythons_numbers_whatever_was_given():
    mixed = Stranger(share=1, length=np.float32(4), count=np.int8(3), flag=np.True_, word="right")
    found = canonical(mixed._replace(inner=Inner(np.int64(2))))
    assert found[:7] == (1.0, 4.0, 3, 0.0, 0, True, 1)
    assert [type(value) for value in found[:7]] == [float, float, int, float, int, bool, int]
    assert (found.inner, type(found.inner.gain)) == (Inner(2.0), float)
    assert canonical(found)[:7] == found[:7]  # once more changes nothing


def test_numbers_of_numpy_make_the_same_environment():
    fleet = RandomFleet(max_trailers=np.int64(3), speed_max=np.float32(1.0))
    plain = parallel_env(
        scenario=RandomPoses(2, 2, RandomFleet(max_trailers=3)),
        task=Task(dt=0.5, max_steps=100),
        vehicle=OnAxle(substeps=2),
        observation=Observation(1),
        frame_skip=2,
    )
    typed = parallel_env(
        scenario=RandomPoses(np.uint8(2), np.int16(2), fleet, area_factor=np.int64(4)),
        num_havs=np.int32(2),
        task=Task(dt=np.float64(0.5), max_steps=np.int64(100)),
        vehicle=OnAxle(substeps=np.int64(2), simultaneous=np.False_),
        observation=Observation(np.int64(1), np.False_),
        frame_skip=np.int64(2),
        threads=np.int64(1),
    )
    assert (plain.max_cycles, type(typed.max_cycles)) == (typed.max_cycles, int)
    told = [env.reset(seed=np.int64(3))[0] for env in (plain, typed)]
    for _ in range(5):
        for one, other in zip(*(rows.values() for rows in told), strict=True):
            assert np.array_equal(one, other)
        told = [env.step(dict.fromkeys(env.agents, np.ones(2)))[0] for env in (plain, typed)]
