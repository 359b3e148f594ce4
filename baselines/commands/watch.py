"""This module is ``hav-env watch``: one episode in a window, as a film or as a page."""

from baselines.cli.options import asks_for_help, read_options, take_words
from baselines.cli.run_options import (
    Display,
    Watch,
    backup_of,
    guidance_for,
    known_names,
    model_fields,
    options_elsewhere,
    take_guidance,
    take_scenario,
    take_vehicle,
)
from baselines.evaluation.runs import Experiments
from baselines.replay import watch
from baselines.replay.trajectory import cut_trajectory, record_trajectory
from baselines.replay.trajectory_files import load_trajectory, save_trajectory
from hav_env.cli.errors import report_errors
from hav_env.models.changes import name_with_changes
from hav_env.policies.filtered import filter_policy
from hav_env.policies.names import POLICIES

_USAGE = "hav-env watch POLICY|RUN.npz [--scenario NAME] [--vehicle NAME]"
_ABOUT = "Show one episode in a window, as a film (mp4, gif) or as a page to replay (html)."


def main(words: list[str]) -> int:
    """Show one episode in a window, as a film or as a page to replay."""
    return report_errors(_watch, words, "nothing is half written")


def _watch(arguments: list[str]) -> None:
    words, arguments = take_words(arguments)
    if len(words) > 1:
        raise ValueError(f"watch shows one policy, but {len(words)} are named: {', '.join(words)}")
    if not words and not asks_for_help(arguments):
        raise ValueError(f"name what to watch: {POLICIES.known()} or a RUN.npz")
    if words and words[0].endswith(".npz"):
        options = read_options(_USAGE, _ABOUT, arguments, [], Display())
        watch.check_pace(options.speed, options.fps, options.begin, options.end)
        trajectory = load_trajectory(words[0])
        watch.check_display(options.output)
        part = cut_trajectory(trajectory, options.begin, options.end)
        watch.show(part, options.output, options.speed, options.fps)
        return
    scenario_name, named, arguments = take_scenario(arguments)
    vehicle, arguments = take_vehicle(arguments)
    guidance, arguments = take_guidance(arguments)
    makers = [POLICIES.find(name) for name in words]
    fields = model_fields(makers, named, vehicle, guidance)
    helpers = known_names(), options_elsewhere
    options = read_options(_USAGE, _ABOUT, arguments, fields, Watch(), *helpers)
    usual = POLICIES.make(makers[0])
    policy = getattr(options, "policy", usual)
    rules = options.task, options.vehicle
    driver = filter_policy(policy, options.safety, *rules, backup_of(options.backup, options.task))
    scenario = getattr(options, "scenario", named)
    shown = options.output is not None or options.record is None
    watch.check_pace(options.speed, options.fps, options.begin, options.end)
    ways = guidance_for(policy, getattr(options, "guidance", guidance))
    models = options.task, options.vehicle, ways
    job = Experiments(driver, scenario, 1, options.seed, *models)
    watch.check_episode(job, options.episode, options.every)
    if options.record is not None:
        watch.check_output(options.record, (".npz",))
    if shown:
        watch.check_display(options.output)
    episode = scenario, options.seed, options.episode, *models[:2], options.every, models[2]
    trajectory = record_trajectory(driver, *episode)._replace(
        policy=name_with_changes(words[0], policy, usual),
        scenario=name_with_changes(scenario_name, scenario, named),
    )
    part = cut_trajectory(trajectory, options.begin, options.end)
    if options.record is not None:
        save_trajectory(trajectory, options.record)
    if shown:
        watch.show(part, options.output, options.speed, options.fps)
