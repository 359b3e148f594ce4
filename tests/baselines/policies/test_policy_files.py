"""A policy file acts as the saved policy; invalid files are named; none is partly written."""

import pathlib

import numpy as np
import pytest

from baselines.policies import files as policy_files
from baselines.policies.files import load_policy, load_trained, save_policy
from baselines.policies.network import input_names, pack_layers, unpack_layers
from hav_env import Batch, Observation, RandomFleet, RandomPoses, Task
from hav_env.evaluation.rollout import rollout
from hav_env.observation import name_columns
from hav_env.policies.checks import check_policy
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.names import make_policy
from tests.support.budgets import budget
from tests.support.networks import actions_of, doctor, random_network

ABOUT = {"algorithm": "chance", "curve": [{"score": 0.5}], "hours": 1.5}


@pytest.fixture
def path(tmp_path) -> pathlib.Path:
    """Return the file of a policy for a single HAV, which is blind to others."""
    save_policy(random_network(), tmp_path / "chance.policy", ABOUT)
    return tmp_path / "chance.policy"


# there and back


@pytest.mark.parametrize(
    ("fields", "chains"),
    [
        ({}, False),
        ({"hidden": (), "limit": 1.7976931348623157e308, "frame_skip": 1}, False),
        ({"hidden": (5, 4, 3), "neighbors": 4, "max_trailers": 3}, False),
        ({"neighbors": 2, "max_trailers": 1}, True),
        ({"hitched": True, "rectangles": True}, False),
    ],
    ids=str,
)
def test_a_policy_is_the_same_again(fields, chains, tmp_path):
    """Weights of single precision are kept exactly, and with them every action."""
    policy = random_network(3, **fields, chains=chains)
    save_policy(policy, tmp_path / "chance.policy", ABOUT)
    loaded, about, safety, backup = load_trained(tmp_path / "chance.policy")
    assert (about, safety, backup) == (ABOUT, None, None)
    for field, value in policy._asdict().items():
        again = getattr(loaded, field)
        assert type(again) is type(value), field
        if isinstance(value, np.ndarray):
            assert again.dtype == value.dtype, field
            assert again.tobytes() == value.tobytes(), field
        else:
            assert again == value, field
    rows = np.random.default_rng(0).normal(size=(50, policy.sizes[0]))
    assert np.array_equal(actions_of(loaded, rows), actions_of(policy, rows))


def test_weights_are_kept_to_single_precision(tmp_path):
    policy = random_network()
    exact = np.random.default_rng(0).normal(size=policy.weights.size)
    policy = policy._replace(weights=exact)
    save_policy(policy, tmp_path / "chance.policy", {})
    loaded = load_policy(tmp_path / "chance.policy")
    assert loaded.weights == pytest.approx(policy.weights, rel=2.0**-24)
    assert np.array_equal(loaded.weights, policy.weights.astype(np.float32))


def test_episodes_of_a_file_are_those_of_the_policy(path):
    task, scenario = Task(max_steps=budget(300, 20)), RandomPoses(3)
    tables = [
        rollout(policy, scenario, 4, np.arange(3), task).to_pylist()
        for policy in (random_network(), load_policy(path), make_policy(str(path)))
    ]
    assert repr(tables[0]) == repr(tables[1]) == repr(tables[2])


def test_a_driver_takes_a_file_by_its_name(path):
    batch = Batch(RandomPoses(2), 3)
    batch.reset(0)
    found = PolicyDriver(str(path), batch).decide()
    assert np.array_equal(found, PolicyDriver(random_network(), batch).decide())


# invalid files


def test_every_cut_and_every_flipped_byte_is_noticed(path):
    whole, policy = path.read_bytes(), load_policy(path)
    broken = path.with_name("broken.policy")
    for cut in [*range(0, len(whole), len(whole) // 40), len(whole) - 1]:
        broken.write_bytes(whole[:cut])
        with pytest.raises(ValueError, match=r"broken\.policy is no policy file, or a broken one"):
            load_trained(broken)
    for place in range(0, len(whole), 5):
        for flipped in (0xFF, 0x01):
            changed = bytes([whole[place] ^ flipped])
            broken.write_bytes(whole[:place] + changed + whole[place + 1 :])
            try:
                again, about, *_ = load_trained(broken)
            except ValueError as error:
                assert "broken.policy is no policy file, or a broken one: " in str(error)  # noqa: PT017
                continue
            # a byte that only archive tools read may change unnoticed, a number may not
            assert repr(again) == repr(policy)
            assert again.weights.tobytes() == policy.weights.tobytes()
            assert about == ABOUT


@pytest.mark.parametrize("text", [b"", b"hello", b"PK", b"{}\n", b"\x80\x04N.", bytes(5_000)])
def test_other_files_are_named(text, tmp_path):
    (tmp_path / "other.policy").write_bytes(text)
    with pytest.raises(ValueError, match=r"other\.policy is no policy file, or a broken one"):
        load_policy(tmp_path / "other.policy")


def test_arrays_alone_and_folders_are_no_policy(tmp_path):
    with open(tmp_path / "array.policy", "wb") as file:
        np.save(file, np.zeros(3))
    with open(tmp_path / "arrays.policy", "wb") as file:
        np.savez(file, sizes=np.zeros(3))
    for name in ("array", "arrays"):
        with pytest.raises(ValueError, match="is no policy file, or a broken one"):
            load_policy(tmp_path / f"{name}.policy")
    (tmp_path / "folder.policy").mkdir()
    for name in ("folder", "nowhere"):
        with pytest.raises(ValueError, match=rf"there is no policy file .*{name}\.policy"):
            load_policy(str(tmp_path / f"{name}.policy"))


OURS = list(name_columns(Observation(0), 10))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"columns": [*OURS, "mood"]}, "no policy file, or a broken one: policy sizes"),
        ({"columns": OURS[1:]}, "no policy file, or a broken one: policy sizes"),
        ({"columns": [*OURS[1:], OURS[1]]}, "no policy file, or a broken one: columns must be"),
        ({"columns": []}, "no policy file, or a broken one: columns must be"),
        ({"columns": ["mood", *OURS[1:]]}, "observes what this version does not: mood$"),
        ({"max_trailers": 9}, "does not: length_10, articulation_cosine_10, articulation_sine_10$"),
        ({"observation": {"neighbors": 0, "smell": True}}, "no policy file, or a broken one"),
        ({"observation": {"neighbors": "all"}}, "no policy file, or a broken one"),
        ({"limit": "far"}, "no policy file, or a broken one"),
        ({"frame_skip": None}, "no policy file, or a broken one"),
        ({"columns": 5}, "no policy file, or a broken one"),
        ({"weights": ["a"]}, "no policy file, or a broken one"),
        ({"layout": "{"}, "no policy file, or a broken one"),
        ({"layout": "[]"}, "no policy file, or a broken one"),
        ({"hitched": 1}, "hitched is 1, but must be true or false"),
        ({"about": "nothing"}, "no policy file, or a broken one"),
    ],
)
def test_contents_that_are_not_of_this_version_are_named(changes, message, path):
    doctor(path, **changes)
    with pytest.raises(ValueError, match=rf"chance\.policy .*{message}"):
        load_policy(path)


def without_a_column(policy, path, names):
    """Write a policy as one that has never known some columns, and all others in reverse order.

    Returns the file, and the same policy with weights of zero for these columns.
    """
    columns = input_names(policy)
    kept = [k for k, name in enumerate(columns) if name not in names][::-1]
    (first, biases), *others = unpack_layers(policy)
    lost = [k for k in range(len(columns)) if k not in kept]
    first[:, lost] = 0.0
    sizes, weights = pack_layers([(first[:, kept], biases), *others])
    fewer = policy._replace(
        sizes=sizes,
        weights=weights,
        mean=policy.mean[kept],
        scale=policy.scale[kept],
        inputs=np.array(kept, np.int64),
    )
    save_policy(fewer, path, ABOUT)
    return policy._replace(weights=pack_layers([(first, biases), *others])[1])


@pytest.mark.parametrize("lost", [(), ("waits",), ("length_10", "goal_distance", "waits")])
def test_columns_are_found_by_name_wherever_they_stand(lost, tmp_path):
    policy, path = random_network(2, (8,), 1), tmp_path / "fewer.policy"
    same = without_a_column(policy, path, lost)
    loaded, batch = load_policy(path), Batch(RandomPoses(2), 3)
    assert input_names(loaded) == tuple(n for n in input_names(policy)[::-1] if n not in lost)
    batch.reset(0)
    found = PolicyDriver(loaded, batch).decide()
    # sums of products have another order
    assert np.array(found) == pytest.approx(np.array(PolicyDriver(same, batch).decide()), abs=1e-12)


@pytest.mark.parametrize(
    "inputs", [np.full(52, 52), np.full(52, -1), np.zeros((2, 2), int), np.zeros(52), np.zeros(51)]
)
def test_inputs_that_are_no_columns_are_refused(inputs):
    with pytest.raises(ValueError, match=r"policy (inputs|sizes)"):
        check_policy(random_network()._replace(inputs=inputs), RandomPoses(1))


# writing


@pytest.mark.parametrize("name", ["chance.npz", "chance", "chance.policy.old", ".policy"])
def test_a_name_without_the_suffix_is_refused(name, tmp_path):
    with pytest.raises(ValueError, match=r"must end with \.policy"):
        save_policy(random_network(), tmp_path / name, {})
    assert not list(tmp_path.iterdir())


def test_there_is_never_half_a_file(path, monkeypatch):
    whole = path.read_bytes()

    def fail(file, **arrays):
        file.write(b"half")
        raise OSError("no space left")

    with monkeypatch.context() as patch:
        patch.setattr(policy_files.np, "savez_compressed", fail)
        with pytest.raises(OSError, match="no space left"):
            save_policy(random_network(1), path, {})
    with pytest.raises(TypeError):  # a type that JSON does not know
        save_policy(random_network(1), path, {"about": object()})
    assert path.read_bytes() == whole
    assert [file.name for file in path.parent.iterdir()] == ["chance.policy"]
    save_policy(random_network(1), path, {})
    assert path.read_bytes() != whole
    assert [file.name for file in path.parent.iterdir()] == ["chance.policy"]


def test_a_policy_of_pairs_is_refused_where_it_would_see_fewer(tmp_path):
    policy = random_network(neighbors=1)
    with pytest.raises(ValueError, match="observe 1 neighbors"):
        PolicyDriver(policy, Batch(RandomPoses(1)))
    for num_havs in (2, 7):
        batch = Batch(RandomPoses(num_havs))
        batch.reset(0)
        assert np.isfinite(PolicyDriver(policy, batch).decide()).all()
    with pytest.raises(ValueError, match=r"up to 10 trailers, but .* up to 4 trailers"):
        PolicyDriver(policy, Batch(RandomPoses(2, fleet=RandomFleet(max_trailers=4))))
