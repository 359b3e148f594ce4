"""This module has the curriculum: training differs from scoring.

Harm weighs less at first, and long HAVs are more frequent.
"""

from typing import Any, NamedTuple

from hav_env import RandomFleet
from hav_env.mdp.reward import harm_terms
from hav_env.models.checks import check_relations, check_value
from hav_env.models.quantities import Share


class Curriculum(NamedTuple):
    """Harm weighs its full weight from some part of the training on, and less before.

    With the full weight from the beginning, HAVs that meet others learn to stand still: a
    collision costs more than all the goals that they have not found yet.
    """

    share: Share = 0.5
    """Share of the weights of harm, at the beginning; 1 for no curriculum."""
    begin: Share = 0.1
    """Part of the training after which harm begins to weigh more ..."""
    end: Share = 0.5
    """... and from which on it has its full weight."""


def lengthen(scenario: Any, trailer_sigma: float) -> Any:
    """Return a scenario with another distribution of trailer counts, if it draws its HAVs.

    Of the paper's HAVs one in 300 has nine trailers or more: too few to learn from.

    Args:
        scenario: of any kind; only a fleet that is drawn changes.
        trailer_sigma: of the Rayleigh distribution of the counts.
    """
    if not isinstance(scenario.fleet, RandomFleet):
        return scenario
    return scenario._replace(fleet=scenario.fleet._replace(trailer_sigma=trailer_sigma))


def check_curriculum(curriculum: Curriculum) -> None:
    """Check a curriculum.

    Raises:
        TypeError: when this is none, or a field has a value of another kind.
        ValueError: naming the field, its value and what is allowed.
    """
    check_value("curriculum", Curriculum, curriculum)


@check_relations.register
def _(curriculum: Curriculum) -> None:
    if curriculum.end < curriculum.begin:
        end, begin = curriculum.end, curriculum.begin
        raise ValueError(f"curriculum end is {end}, but must be at least its begin, {begin}")


def harm_share(curriculum: Curriculum, progress: float) -> float:
    """Return by which factor harm weighs when this part of the training is over, 0 to 1."""
    if progress >= curriculum.end:
        return 1.0
    if progress <= curriculum.begin:
        return curriculum.share
    grown = (progress - curriculum.begin) / (curriculum.end - curriculum.begin)
    return curriculum.share + (1.0 - curriculum.share) * grown


def reward_at(curriculum: Curriculum, reward: Any, progress: float) -> Any:
    """Return the reward when this part of the training is over.

    Args:
        curriculum: says how the weights of harm grow.
        reward: with its full weights; ``harm_terms`` names those of harm.
        progress: the part, from 0 to 1.
    """
    share = harm_share(curriculum, progress)
    return reward._replace(**{term: share * getattr(reward, term) for term in harm_terms(reward)})
