"""This module writes a page for every named scenario and every vehicle of the catalogue.

``python docs/make_pages.py`` writes ``docs/catalogue``, its pictures too. ``docs/make_scores.py``
measures the scores.
"""

import json
import pathlib
import re

import numpy as np
from make_scores import MOST_STEPS, SCORES, SEED, count_episodes, vehicle_of

from baselines.figures.catalogue import draw_vehicles
from baselines.figures.drawn_havs import draw_obstacles, draw_units
from baselines.figures.trajectory_plot import HAV_COLORS, Figure, new_figure, save_figure, sheet
from baselines.figures.vehicle_tables import turn_table
from baselines.replay.trajectory import Trajectory, record_trajectory
from hav_env import Task, catalogue, find_scenario, make_policy, parallel_env
from hav_env.scenarios.presets import FIELDS, SCENARIOS, SITES
from hav_env.vehicles import COMBINATIONS, VEHICLES

DOCS = pathlib.Path(__file__).parent
NAMES = list(SCENARIOS | FIELDS | SITES)
_SHARES = {
    "jackknifed": "jackknifed",
    "actual_collision": "collided",
    "obstacle_collision": "hit an obstacle",
    "goal_1_hit": "goal 1",
    "goal_2_hit": "goal 2",
}
_FAMILIES = {
    "paper-single": (
        "The paper's scenario with one HAV. It starts at a random pose and has two random goals.",
        "The goal needs a heading too. A truck that turns too tightly for its trailers jackknifes.",
    ),
    "paper-pair": (
        "The paper's scenario with two HAVs, in a square four times as large as their footprints.",
        "Both must evade without reversing. The next goals come when both HAVs have hit theirs.",
    ),
    "swarm": (
        "The paper's scenario with more HAVs, in a square four times as large as all footprints.",
        "One HAV that misses its first goal keeps all others from their second ones.",
    ),
    "dense": (
        "The paper's scenario in half the area: the square is twice as large as all footprints.",
        "Ways cross everywhere. HAVs that wait for each other can block the whole square.",
    ),
    "crossing": (
        "HAVs start at even angles on a circle. Each drives through its centre to the other side.",
        "All HAVs meet at the centre at the same time, and none has a right of way.",
    ),
    "yard": (
        "HAVs start in a row of bays, and drive across an aisle into random bays opposite.",
        "Ways cross in the aisle, and a HAV must be straight when it enters its bay.",
    ),
    "column": (
        "Five HAVs stand one behind the other. Their goals are the same column 200 m further on.",
        "The footprints are 10 m apart: a HAV that starts too early hits the one ahead.",
    ),
    "field": (
        "Real vehicles start among 32 random walls in 120 m x 120 m. Each HAV's own way is free.",
        "The Dubins path to the goal leads through walls. `--guidance witness` gives a free way.",
    ),
}


def _record_start(name: str) -> Trajectory:
    """Return the first step of episode 0, to be drawn."""
    models = Task(max_steps=1), VEHICLES.make(vehicle_of(name))
    return record_trajectory(make_policy("random"), find_scenario(name), SEED, 0, *models)


@sheet
def _draw_start(name: str) -> Figure:
    """Draw the HAVs where an episode starts, their goals and the obstacles."""
    trajectory = _record_start(name)
    figure = new_figure(5.0, 6.0)
    axes = figure.subplots()
    size = 0.03 * float(np.ptp(np.concatenate([trajectory.x[0], trajectory.goals[..., 0].ravel()])))
    for hav in range(len(trajectory.length)):
        color = HAV_COLORS[hav % len(HAV_COLORS)]
        draw_units(axes, trajectory, hav, 0, color)
        for number, (x, y, heading) in enumerate(trajectory.goals[hav]):
            tip = size * np.cos(heading), size * np.sin(heading)
            style = {"fc": color if number == 0 else "white", "ec": color, "lw": 0.8}
            axes.arrow(x, y, *tip, head_width=0.7 * size, head_length=0.8 * size, **style)
    draw_obstacles(axes, trajectory, 0)
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.margins(0.05)
    return figure


def _shorten(reason: str) -> str:
    """Return an error without the parameters of models."""
    shorter = re.sub(r"\([^()]*\)", "", reason)
    return shorter if shorter == reason else _shorten(shorter)


def _score_table(name: str, scores: dict[str, dict]) -> str:
    """Return the table of shares, and why policies cannot drive in the scenario."""
    rows, refused = [], []
    measured = {policy: row for policy, row in scores[name].items() if isinstance(row, dict)}
    columns = [field for field in _SHARES if any(field in row for row in measured.values())]
    for policy, row in scores[name].items():
        if policy in measured:
            shares = [f"{100.0 * row[field]:.1f} %" for field in columns]
            rows.append(f"| `{policy}` | {' | '.join(shares)} |")
        else:
            refused.append(f"- `{policy}` has no row: {_shorten(row)}.")
    head = f"| policy | {' | '.join(_SHARES[field] for field in columns)} |"
    ruler = f"|---|{'--:|' * len(columns)}"
    return "\n".join([head, ruler, *rows, "", *refused]).rstrip() + "\n"


def _scenario_page(name: str, scores: dict[str, dict]) -> str:
    """Return the page of a scenario."""
    scenario, vehicle = find_scenario(name), vehicle_of(name)
    env = parallel_env(scenario=name, vehicle=vehicle)
    family = name if name in _FAMILIES else name.rsplit("-", 1)[0]
    if name in SITES:
        what = f"A real place. [The catalogue of sites](../../sites-catalogue.md#{name}) describes"
        what += " its walls, its vehicles and what is hard."
        hard, picture, drawn = "", f"site_{name}.png", "at the start, and all drives between places"
    else:
        what, hard = _FAMILIES[family]
        hard = f"**What is hard.** {hard}\n\n"
        picture, drawn = (
            f"scenario_{name}.png",
            "at the start of episode 0",
        )
    shapes = {
        "HAVs": f"{scenario.num_havs}",
        "goals of each HAV": f"{scenario.num_goals}",
        "trailers at most": f"{scenario.max_trailers}",
        "vehicle": f'`"{vehicle}"`',
        "observation of an agent": f"`{env.observation_space('hav_0').shape}`",
        "action of an agent": f"`{env.action_space('hav_0').shape}`",
        "central state": f"`{env.state_space.shape}`",
    }
    if hasattr(scenario, "num_segments"):
        shapes["segments of obstacles"] = f"{scenario.num_segments}"
    table = "\n".join(f"| {key} | {value} |" for key, value in shapes.items())
    extra = "" if vehicle == "on_axle" else f', vehicle="{vehicle}"'
    option = "" if vehicle == "on_axle" else f" --vehicle {vehicle}"
    filled = " Filled arrows are first goals, empty ones second goals." if name not in SITES else ""
    return f"""# {name}

{what}

{hard}![HAVs of {name} {drawn}](../../images/{picture})

*HAVs {drawn}.{filled}*

## Use it

```python
import hav_env

env = hav_env.parallel_env(scenario="{name}"{extra})
```

    hav-env evaluate avoid_jack --scenario {name}{option} --episodes 20

| what | value |
|---|---|
{table}

## Scores

Shares of HAVs in {count_episodes(name)} episodes of seed {SEED}, of at most {MOST_STEPS:,} steps:

{_score_table(name, scores)}
`python docs/make_scores.py` measures them. `hav-env evaluate` prints their 95 % intervals.
"""


def _anchor(title: str) -> str:
    """Return the anchor that the site gives a heading."""
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", title).strip().lower())


def _vehicle_page(name: str) -> str:
    """Return the page of a vehicle of the catalogue."""
    vehicle = catalogue(name)
    head, _, *rows = turn_table().splitlines()
    titles = [cell.strip() for cell in head.strip("|").split("|")]
    row = next(line for line in rows if f"`{name}`" in line)
    turns = zip(titles[1:], (cell.strip() for cell in row.strip("|").split("|")[1:]), strict=True)
    units = [
        f"| {'truck' if k == 0 else f'trailer {k}'} | {unit.length:.2f} | {unit.hitch:.2f} |"
        f" {2.0 * unit.half_width:.2f} | {unit.front:.2f} | {unit.rear:.2f} |"
        f" {np.degrees(unit.articulation_max):.0f} |"
        for k, unit in enumerate(vehicle.units)
    ]
    lines = "\n".join(f"| {title} | {value} |" for title, value in turns)
    dimensions = f"../../vehicle-dimensions.md#{_anchor(vehicle.title)}"
    return f"""# {name}

{vehicle.title}. [Its dimensions]({dimensions}) stand with their sources.

![{name} from above](../../images/vehicle_{name}.png)

## Use it

```python
from hav_env import RandomPoses, catalogue_fleet, parallel_env

scenario = RandomPoses(num_havs=2, fleet=catalogue_fleet(["{name}"]))
env = parallel_env(scenario=scenario, vehicle="realistic")
```

## Units

Lengths are in metres, the greatest articulation in degrees.

| unit | length | hitch offset | width | front | rear | articulation |
|---|--:|--:|--:|--:|--:|--:|
{chr(10).join(units)}

## How it turns

[Vehicles](../../vehicles.md#how-they-turn) explains the rows.

| figure | value |
|---|--:|
{lines}
"""


def pages() -> dict[str, str]:
    """Return the text of every page by its path below ``docs/catalogue``."""
    scores = json.loads(SCORES.read_text())
    found = {f"scenarios/{name}.md": _scenario_page(name, scores) for name in NAMES}
    found |= {f"vehicles/{name}.md": _vehicle_page(name) for name in COMBINATIONS.names()}
    listed = "\n".join(
        f"| [`{name}`](scenarios/{name}.md) | {find_scenario(name).num_havs} |"
        f" `{vehicle_of(name)}` |"
        for name in NAMES
    )
    found["scenarios.md"] = (
        "# Scenarios\n\nFor users who choose a scenario. Each has a page with picture, shapes"
        " and scores. The meaning\nof a name does not change.\n\n"
        f"| scenario | HAVs | vehicle |\n|---|--:|---|\n{listed}\n"
    )
    listed = "\n".join(
        f"| [`{name}`](vehicles/{name}.md) | {catalogue(name).title} |"
        f" {len(catalogue(name).units) - 1} | {catalogue(name).overall_length:.2f} m |"
        for name in COMBINATIONS.names()
    )
    found["vehicles.md"] = (
        "# Vehicles of the catalogue\n\nFor users who choose a vehicle. Each has a page with a"
        " picture and its numbers.\n\n"
        f"| vehicle | title | trailers | length |\n|---|---|--:|--:|\n{listed}\n"
    )
    return found


def main() -> None:
    """Write all pages and pictures."""
    for path, text in pages().items():
        file = DOCS / "catalogue" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    for name in NAMES:
        if name not in SITES:
            save_figure(_draw_start(name), DOCS / "images", f"scenario_{name}", ("png",))
    for name in COMBINATIONS.names():
        figure = draw_vehicles([catalogue(name)])
        wide = max(catalogue(name).overall_length, 25.0) + 2.0  # m; the picture of all is wider
        figure.axes[0].set_xlim(-1.0, wide - 1.0)
        figure.set_size_inches(7.0, 7.0 * 7.0 / wide + 0.4)
        save_figure(figure, DOCS / "images", f"vehicle_{name}", ("png",))


if __name__ == "__main__":
    main()
