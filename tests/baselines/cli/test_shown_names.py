"""Names are shown unchanged, whatever they contain, and never act on the program around them."""

import io
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from matplotlib.figure import Figure
from rich.console import Console
from rich.text import Text

from baselines.__main__ import main
from baselines.cli.markup import code, file_names, markdown, plot_text
from baselines.policies.files import save_policy
from hav_env.evaluation.comparison import Figure as Column
from hav_env.evaluation.comparison import Score
from hav_env.evaluation.statistics import Interval
from hav_env.models.text import one_line, visible
from tests.support.budgets import budget
from tests.support.networks import random_network
from train.comparison_plots import draw_bars

SHORT = ["--task.max-steps", str(budget(50, 5)), "--episodes", "1"]
HOSTILE = [
    "[/]", "[red]x", "[link=https://e.org]x", "a|b", "a`b", "<b>x", "&amp;", "$x$", "$", "x\\",
    "*a*", "_a_", "~a~", "[a](b)", "a\nb", "\x1b[31mred", "\r", "\u202eabc", "\udcff",
    "\x9b0m", "é",
]  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_nothing_that_a_terminal_acts_on_is_left(name):
    shown = visible(name)
    assert shown.isprintable()
    shown.encode()
    assert (shown == name) == name.isprintable()
    assert one_line(f"a\n{name}").isprintable()


@pytest.mark.parametrize("name", HOSTILE)
def test_a_table_in_markdown_keeps_its_cells(name):
    lines = markdown([["", name, "c"], [name, "1.0 [0.5, 1.5] *", "x_y"]]).splitlines()
    assert len(lines) == 3
    cells = [re.split(r"(?<!\\)(?:\\\\)*\|", line)[1:-1] for line in (lines[0], lines[2])]
    assert [len(row) for row in cells] == [3, 3]
    # as CommonMark reads them: a backslash makes the next sign literal
    told = [re.sub(r"\\([!-/:-@\[-`{-~])", r"\1", cell.strip()) for row in cells for cell in row]
    assert told == ["", visible(name), "c", visible(name), "1.0 [0.5, 1.5] *", "x_y"]
    for cell in cells[0]:
        plain = re.sub(r"\\.", "", cell)
        assert not re.search(r"[`<&~|]|\]\(|(^|\W)_|_(\W|$)|\S\*|\*\S", plain.strip()), cell


def test_published_tables_do_not_move():
    row = ["goal 1 driven / Dubins", "1.04 [1.03, 1.05]; +0.5 pp [+0.1, +0.9] *", "ppo_pair"]
    assert markdown([row]).splitlines()[0] == f"| {' | '.join(row)} |"
    assert code("Random(hold=5)") == "`Random(hold=5)`"
    assert code("a``b") == "``` a``b ```"


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.filterwarnings("ignore:Glyph")
def test_a_plot_shows_a_name_as_it_is(name):
    scores = [[Score(name, Column("hit", "hit", True, True), Interval(0.1, 0.2, 0.3, 5), None)]]
    figure = draw_bars(scores, name)
    figure.savefig(io.BytesIO(), format="png")
    label = figure.axes[0].get_xticklabels()[0]
    text, is_formula = label._preprocess_math(label.get_text())
    assert not is_formula
    assert text.replace("\n", "_").strip() == visible(name).strip()


def test_no_label_hides_from_a_legend():
    axes = Figure().add_subplot()
    axes.plot([0, 1], label=plot_text("_mine"))
    assert [text.get_text().strip() for text in axes.legend().get_texts()] == ["_mine"]


def test_names_get_files_of_their_own():
    names = [
        "a|b",
        "a-b",
        "a.b",
        "random",
        "chance.policy",
        "A-B",
        "x" * 500,
        "é" * 300,
        "[/]",
        "|",
    ]
    labels = file_names(names)
    assert len({label.casefold() for label in labels}) == len(names)
    assert labels[3:5] == ["random", "chance-policy"]
    assert all(re.fullmatch(r"[\w-]+", label) for label in labels)
    assert all(len(f"{label}.parquet".encode()) < 200 for label in labels)
    assert file_names(names[::-1]) == labels[::-1]
    assert len(set(file_names(["a", "a"]))) == 1


class _Title(HTMLParser):
    scripts = 0

    def handle_starttag(self, tag, attributes):
        self.scripts += tag == "script"


@pytest.mark.parametrize("name", ["[/]", "[red]x", "a|b", "<script>x", "$a$", "\x1b[31mx", "a\nb"])
def test_commands_take_files_of_any_name(name, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / f"{name}.policy"
    path.parent.mkdir(exist_ok=True)
    save_policy(random_network(), path, {})
    words = ["evaluate", f"{name}.policy", "--output", "r", *SHORT]
    assert main(words) == 0
    told = capsys.readouterr().out
    assert visible(f"{name}.policy") in told
    assert "\x1b" not in told
    assert len((tmp_path / "r/table.md").read_text().splitlines()) == 11
    page = ["--output", f"{name}.html", *SHORT[:2]]
    assert main(["watch", f"{name}.policy", *page]) == 0
    parser = _Title()
    parser.feed((tmp_path / f"{name}.html").read_text())
    plain = _Title()
    assert main(["watch", "random", "--output", "plain.html", *SHORT[:2]]) == 0
    plain.feed((tmp_path / "plain.html").read_text())
    assert parser.scripts == plain.scripts


def test_two_policies_whose_names_look_alike_have_tables_of_their_own(
    tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    for seed, name in enumerate(("a|b", "a-b")):
        save_policy(random_network(seed), tmp_path / f"{name}.policy", {})
    for _ in range(2):
        assert main(["evaluate", "a|b.policy", "a-b.policy", "--output", "r", *SHORT]) == 0
    assert len(list((tmp_path / "r").glob("*.parquet"))) == 2


@pytest.mark.parametrize("name", HOSTILE)
def test_an_error_shows_a_name_in_one_line(name, tmp_path, capsys):
    assert main(["evaluate", f"{name}.policy", "--output", str(tmp_path / "r")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert told[:-1].isprintable()


def test_rich_takes_text_as_it_is():
    console = Console(file=io.StringIO(), width=80)
    console.print(Text(visible("[/] [red]x")))
    assert console.file.getvalue() == "[/] [red]x\n"  # type: ignore[attr-defined]
    assert np.all([Text(visible(name)).plain == visible(name) for name in HOSTILE])
