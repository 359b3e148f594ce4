"""This module shows a progress bar with the rate and the remaining time."""

import rich.progress
from rich.console import Console


def new_bar(what: str) -> rich.progress.Progress:
    """Return a bar on standard error over a number of items; ``rate`` is one of its fields."""
    return rich.progress.Progress(
        rich.progress.TextColumn(f"{{task.completed:,}}/{{task.total:,}} {what}"),
        rich.progress.BarColumn(),
        rich.progress.TextColumn("{task.fields[rate]}"),
        rich.progress.TimeElapsedColumn(),
        rich.progress.TimeRemainingColumn(),
        console=Console(stderr=True),
    )


class Progress:
    """A bar over a number of experiments, as a context manager."""

    def __init__(self, num_experiments: int) -> None:
        """Prepare the bar; entering the context shows it."""
        self._bar = new_bar("experiments")
        self._task = self._bar.add_task("", total=num_experiments, rate="")
        self._steps = self._experiments = 0

    def __enter__(self) -> "Progress":
        """Show the bar."""
        self._bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        """Stop the bar; let errors pass."""
        self._bar.stop()

    def advance(self, experiments: int, steps: int) -> None:
        """Advance the bar by a number of experiments and by their steps of moving HAVs.

        Without steps, an earlier run did the experiments: they do not count for the rate.
        """
        self._steps += steps
        self._experiments += experiments if steps else 0
        seconds = self._bar.tasks[0].elapsed or 1e-9
        rate = (
            f"{self._experiments / seconds:,.0f}/s, {self._steps / seconds / 1e6:.2f} M HAV-steps/s"
        )
        self._bar.update(self._task, advance=experiments, rate=rate)
