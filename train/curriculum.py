"""This module has the curriculum: the differences between training and scoring.

Penalties have smaller weights at first, and long HAVs are more frequent.
"""

from typing import Any, NamedTuple

from hav_env import RandomFleet
from hav_env.mdp.reward import harm_terms
from hav_env.models.checks import check_relations, check_value
from hav_env.models.quantities import Share


class Curriculum(NamedTuple):
    """Penalties start at a share of their weights and reach their full weights during the training.

    With full weights from the start, HAVs that meet others learn to stand still: a collision costs
    more than they gain from goals, which they do not find yet.
    """

    share: Share = 0.5
    """Initial multiplier of all penalty weights, from 0 to 1; 1 disables the curriculum."""
    begin: Share = 0.1
    """Part of the training after which the penalty weights begin to grow, from 0 to 1."""
    end: Share = 0.5
    """Part of the training after which the penalties have their full weights, from 0 to 1."""


def lengthen(scenario: Any, trailer_sigma: float) -> Any:
    """Return a scenario with another distribution of trailer counts, if it draws its HAVs.

    One in 300 of the paper's HAVs has nine trailers or more: too few to learn from.

    Args:
        scenario: Any scenario; only a random fleet changes.
        trailer_sigma: Sigma of the Rayleigh distribution of the counts.
    """
    if not isinstance(scenario.fleet, RandomFleet):
        return scenario
    return scenario._replace(fleet=scenario.fleet._replace(trailer_sigma=trailer_sigma))


def check_curriculum(curriculum: Curriculum) -> None:
    """Check a curriculum.

    Raises:
        TypeError: If this is no curriculum, or a field has another type.
        ValueError: If a value is out of range; the message names the field, its value and the rule.
    """
    check_value("curriculum", Curriculum, curriculum)


@check_relations.register
def _(curriculum: Curriculum) -> None:
    if curriculum.end < curriculum.begin:
        end, begin = curriculum.end, curriculum.begin
        raise ValueError(f"curriculum end is {end}, but must be at least its begin, {begin}")


def harm_share(curriculum: Curriculum, progress: float) -> float:
    """Return the multiplier of the penalty weights after this part of the training, 0 to 1."""
    if progress >= curriculum.end:
        return 1.0
    if progress <= curriculum.begin:
        return curriculum.share
    grown = (progress - curriculum.begin) / (curriculum.end - curriculum.begin)
    return curriculum.share + (1.0 - curriculum.share) * grown


def reward_at(curriculum: Curriculum, reward: Any, progress: float) -> Any:
    """Return the reward after this part of the training.

    Args:
        curriculum: The growth of the penalty weights.
        reward: The reward with its full weights; ``harm_terms`` names its penalties.
        progress: The part of the training, from 0 to 1.
    """
    share = harm_share(curriculum, progress)
    return reward._replace(**{term: share * getattr(reward, term) for term in harm_terms(reward)})
