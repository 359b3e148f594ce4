"""The place where episodes run: names, addresses, and the message without Ray."""

import importlib.util
import socket

import pytest

from baselines.__main__ import main
from baselines.evaluation import ray_cluster as cluster
from baselines.evaluation.executors import open_engine
from baselines.evaluation.ray_cluster import check_address, load_ray


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--engine", "spark"], "unknown engine 'spark'; known: local, ray"),
        (["--address", "auto"], "address is 'auto', but the engine local has none: use ray"),
    ],
)
def test_a_bad_engine_is_named_before_anything_is_written(words, told, tmp_path, capsys):
    output = tmp_path / "results"
    assert main(["evaluate", "random", "--output", str(output), "--overwrite", *words]) == 2
    assert capsys.readouterr().err == f"error: {told}\n"
    assert not output.exists()


@pytest.mark.parametrize("address", ["here", "10.0.0.1", ":6379", "host:port", "host:123456"])
def test_an_address_is_host_and_port(address):
    with pytest.raises(ValueError, match="must be HOST:PORT or auto"):
        check_address(address)


def test_that_nobody_answers_is_said_at_once():
    with socket.create_server(("127.0.0.1", 0)) as server:
        there = f"127.0.0.1:{server.getsockname()[1]}"
        check_address(there)
    check_address("auto")
    for nobody in (there, "127.0.0.1:99999"):
        with pytest.raises(ConnectionError, match=f"no Ray cluster answers at {nobody}"):
            check_address(nobody)


def test_without_ray_it_is_said_how_to_get_it(monkeypatch, capsys):
    def missing(name):
        raise ImportError(f"No module named {name!r}")

    monkeypatch.setattr(cluster.importlib, "import_module", missing)
    with pytest.raises(ImportError, match=r"run pip install -e '\.\[ray\]' in the clone"):
        load_ray()
    monkeypatch.undo()
    if importlib.util.find_spec("ray") is None:
        assert main(["evaluate", "random", "--engine", "ray"]) == 2
        assert "run pip install -e '.[ray]' in the clone" in capsys.readouterr().err


def test_the_local_engine_runs_part_after_part():
    spans = [range(3), range(3, 5)]
    with open_engine() as engine:
        told = list(engine(lambda span, threads: (sum(span), threads), spans, 2))
    assert told == [(range(3), (3, 2)), (range(3, 5), (7, 2))]
