"""Merged parts equal the whole, byte for byte: whoever runs them, in whatever order, and who is killed meanwhile."""

import contextlib
import multiprocessing
import os
import random
import re
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from layouts import Layout, lay_out_again
from test_cli import in_one_line, run

import z2r
from z2r.cluster import RayExecutor
from z2r.errors import DatasetError, Fault, Unreachable
from z2r.format.dataset import in_order
from z2r.reading.inspection import metrics_json

N_EPISODES = len(z2r.load("messy").episodes)


class Shuffled(Executor):
    """Runs what it is given in another order, once somebody waits, in one thread."""

    def __init__(self, seed: int) -> None:
        self._random, self._waiting = random.Random(seed), []

    def submit(self, function: Callable, /, *args: object) -> Future:
        owner = self

        class Waiting(Future):
            def result(self, timeout: float | None = None) -> object:
                owner.run()
                return super().result(timeout)

        future = Waiting()
        self._waiting.append((future, function, args))
        return future

    def run(self) -> None:
        self._random.shuffle(self._waiting)
        while self._waiting:
            future, function, args = self._waiting.pop()
            future.set_result(function(*args))


def kill_the_worker(*args: object) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def told(dataset: object, executor: Executor | None = None) -> tuple[bytes, dict]:
    """All that is said of a dataset."""
    inspection = z2r.inspect_dataset(dataset, executor=executor)
    return metrics_json(inspection.metrics("", 0)), z2r.audit(dataset, executor=executor).to_dict("")


def split(root: Path, cuts: set[int]) -> Path:
    """The episodes of `messy`, in files that end at these of them."""
    ends = [*sorted(cuts), N_EPISODES]
    files = [end - start for start, end in zip([0, *ends[:-1]], ends, strict=True)]
    lay_out_again(z2r.MESSY, root, Layout(files=files, shards=[N_EPISODES]))
    return root


@pytest.fixture(scope="module")
def many_files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return split(tmp_path_factory.mktemp("split") / "messy", set(range(1, N_EPISODES)))


@pytest.fixture(scope="module")
def whole(many_files: Path) -> tuple[bytes, dict]:
    return told(many_files)


@pytest.fixture(scope="module")
def cluster() -> Iterator[RayExecutor]:
    pytest.importorskip("ray")
    for patience in (True, True, False):  # Ray gives up after half a minute, which a busy machine may need
        with contextlib.suppress(DatasetError) if patience else contextlib.nullcontext():
            executor = RayExecutor()
            break
    with executor:
        yield executor


@settings(max_examples=12)
@given(cuts=st.sets(st.integers(1, N_EPISODES - 1)), seed=st.integers(0, 99))
def test_splits_into_whole_files_in_any_order(cuts: set[int], seed: int, whole, tmp_path_factory) -> None:
    root = split(tmp_path_factory.mktemp("split") / "messy", cuts)
    metrics, audit = told(root, Shuffled(seed))
    assert metrics == whole[0]
    assert (metrics, audit) == told(root)
    assert sorted(map(without_file, audit["findings"])) == sorted(map(without_file, whole[1]["findings"]))


def without_file(finding: dict) -> tuple:
    return finding["check"], finding["severity"], finding["found"], finding["expected"], finding["episodes"]


@pytest.mark.parametrize("n_threads", [1, 2, 7])
def test_threads(n_threads: int, many_files: Path, whole) -> None:
    with ThreadPoolExecutor(n_threads) as threads:
        assert told(many_files, threads) == whole


@pytest.fixture
def processes() -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        yield executor


def test_processes(many_files: Path, whole, processes: ProcessPoolExecutor) -> None:
    assert told(many_files, processes) == whole


@pytest.mark.parametrize("nth", [1, 3, N_EPISODES])
def test_a_worker_that_is_killed_changes_nothing(nth: int, many_files: Path, whole, processes) -> None:
    class Fatal(Executor):
        def submit(self, function: Callable, /, *args: object) -> Future:
            nonlocal nth
            nth -= 1
            if not nth:
                processes.submit(kill_the_worker)
            return processes.submit(function, *args)

    assert told(many_files, Fatal()) == whole


KINDS = (DatasetError, Unreachable)


@pytest.mark.parametrize("kind", KINDS)
def test_what_goes_wrong_in_a_process_is_said_here(kind: type, processes: ProcessPoolExecutor) -> None:
    with pytest.raises(kind, match="nothing"):
        [*in_order(fail, [kind] * 3, processes)]


def fail(kind: type) -> None:
    raise kind(Fault(Path("file"), "", "nothing", "something"))


# Functions inside of a test are sent to a cluster as they are: it cannot import this module.


@pytest.mark.parametrize("kind", KINDS)
def test_what_goes_wrong_in_a_cluster_is_said_here(kind: type, cluster: RayExecutor) -> None:
    error = kind(Fault(Path("file"), "", "nothing", "something"))

    def fail(_: int) -> None:
        raise error

    with pytest.raises(kind, match="nothing"):
        [*in_order(fail, range(3), cluster)]


def test_a_cluster_says_the_same(cluster: RayExecutor, many_files: Path, whole) -> None:
    assert told(many_files, cluster) == whole


def test_a_task_whose_worker_is_killed_runs_again(cluster: RayExecutor, tmp_path: Path) -> None:
    def die_once(path: Path) -> str:
        if not path.exists():
            path.touch()
            os.kill(os.getpid(), 9)
        return path.name

    assert [*in_order(die_once, [tmp_path / str(number) for number in range(3)], cluster)] == ["0", "1", "2"]


def test_the_command_line_takes_a_cluster(cluster: RayExecutor, many_files: Path) -> None:
    import ray

    here, address = many_files.parent, ray.get_runtime_context().gcs_address
    near, far = (run("audit", "--json", "messy", *options, cwd=here) for options in ([], ["--ray", address]))
    assert (far.returncode, far.stdout, far.stderr) == (near.returncode, near.stdout, near.stderr)
    assert far.returncode in (0, 1)


def test_a_dataset_is_no_address_of_a_cluster(tmp_path: Path) -> None:
    refused = run("audit", "--ray", "messy", cwd=tmp_path)
    assert refused.returncode == 2
    assert "put DATASET before --ray" in in_one_line(refused)


def test_a_cluster_that_does_not_start_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def give_up(*_: object, **__: object) -> None:
        raise Exception  # as bare as Ray raises it

    monkeypatch.setattr(pytest.importorskip("ray"), "init", give_up)
    with pytest.raises(DatasetError, match=r"no cluster at local \(Exception\)"):
        RayExecutor()


def test_nobody_at_an_address_is_an_error(tmp_path: Path) -> None:
    pytest.importorskip("ray")
    for address in ("127.0.0.1:1", "ray://127.0.0.1:1"):
        nobody = run("audit", "messy", "--ray", address, cwd=tmp_path)
        assert nobody.returncode == 2
        assert nobody.stderr.startswith(f"z2r: --ray: found no cluster at {address} (")
        assert nobody.stderr.count("\n") == 1


def test_the_line_in_the_readme_runs_on_dask(many_files: Path, whole) -> None:
    distributed = pytest.importorskip("distributed")
    readme = (Path(z2r.__file__).parents[1] / "README.md").read_text()
    [line] = re.findall(r"z2r\.audit\(.*executor=client\.get_executor\(\)\)", readme)
    with distributed.Client(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as client:
        names = {"z2r": z2r, "client": client}
        assert eval(line.replace("my_dataset", str(many_files)), names).to_dict("") == whole[1]
        assert told(many_files, client.get_executor()) == whole
