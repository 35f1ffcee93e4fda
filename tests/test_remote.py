"""A dataset at a URL is read as the same one in a folder, from no more bytes than that takes; or an error says why not.

The server is real, and on the loopback; a proxy in front of it counts, and goes wrong where a test wants (`storage`).
"""

import json
import multiprocessing
import pickle
import shutil
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from storage import BUCKET, Answer, Storage
from test_cli import run

import z2r
from z2r.data import find_dataset
from z2r.data.urls import Url, place_of
from z2r.errors import DatasetError, Fault, Unreachable
from z2r.format import remote, store
from z2r.format.parquet import open_parquet, read_columns
from z2r.format.remote import FarFile
from z2r.reading.inspection import metrics_json

SHIPPED = ("standin", "messy", "arm")


@pytest.fixture(scope="module")
def urls(server: Storage) -> dict[str, str]:
    """The datasets that ship, behind the door, and the verdicts beside them."""
    for name in SHIPPED:
        root = find_dataset(name)
        server.put(root.with_name(f"{name}.verdict.json"), f"{name}.verdict.json")
    return {name: server.put(find_dataset(name), name) for name in SHIPPED}


def audited(dataset: object, **options: object) -> dict:
    return z2r.audit(dataset, **options).to_dict("")


def without_root(text: str, root: object) -> str:
    """What is said where a line names the folder: of a URL, it names the copy that somebody makes."""
    return text.replace(str(root), Path(str(root)).name)


# --- the same bytes


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_read_at_a_url_is_what_is_read_in_a_folder(name: str, storage: Storage, urls: dict[str, str]) -> None:
    there, here = z2r.inspect_dataset(urls[name]), z2r.inspect_dataset(name)
    assert metrics_json(there.metrics(name, 0)) == metrics_json(here.metrics(name, 0))
    assert without_root(str(audited(urls[name])), "") == without_root(str(audited(name)), find_dataset(name))


@pytest.mark.parametrize(
    ("name", "args"),
    [
        ("arm", ["inspect", "--json"]),
        ("arm", ["audit", "--json", "--pictures"]),
        ("arm", ["report", "--out", "page.html"]),
        ("standin", ["audit", "--keep", "kept.json", "--break", "yaw-swap-everywhere"]),
        ("messy", ["reading", "--out", "draft.toml"]),
    ],
)
def test_a_command_prints_and_writes_the_same(
    name: str, args: list[str], storage: Storage, urls: dict[str, str], tmp_path: Path
) -> None:
    ended = []
    for dataset in (urls[name], find_dataset(name)):
        folder = tmp_path / str(len(ended))
        folder.mkdir()
        done = run(*args, dataset, cwd=folder)
        files = {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        ended.append((done.returncode, without_root(done.stdout, dataset), done.stderr, files))
    assert ended[0] == ended[1]
    assert ended[0][0] in (0, 1)


def test_many_files_and_damage_are_found_as_in_a_folder(recorded: Path, storage: Storage, tmp_path: Path) -> None:
    damaged = Path(shutil.copytree(recorded, tmp_path / "damaged"))
    [_, second, third, *_] = sorted(damaged.glob("data/*/*.parquet"))
    second.write_bytes(second.read_bytes()[:-300])
    third.unlink()
    (damaged / "data/chunk-000/extra.parquet").write_bytes(b"PAR1")
    url = storage.put(damaged, "damaged")
    assert without_root(str(audited(url)), "") == without_root(str(audited(damaged)), damaged)
    with pytest.raises(DatasetError) as caught:
        z2r.inspect_dataset(url)
    with pytest.raises(DatasetError) as local:
        z2r.inspect_dataset(damaged)
    assert str(caught.value) == str(local.value).replace(str(damaged), url)
    assert z2r.salvage(url).left_out == z2r.salvage(damaged).left_out


@pytest.mark.parametrize("scheme", ["memory", "file"])
def test_other_stores(scheme: str, tmp_path: Path) -> None:
    root = shutil.copytree(z2r.STANDIN, tmp_path / "with space" / "standin")
    url = root.as_uri()
    if scheme == "memory":
        fsspec = pytest.importorskip("fsspec")
        fsspec.filesystem("memory").put(str(root), "/robots/standin", recursive=True)
        url = "memory://robots/standin"
    assert z2r.inspect_dataset(url).metrics("", 0) == z2r.inspect_dataset(root).metrics("", 0)
    assert audited(url) == audited(root)


def test_other_processes_read_it_too(storage: Storage, urls: dict[str, str]) -> None:
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as processes:
        assert audited(urls["arm"], executor=processes) == audited(urls["arm"])
        storage.door.fault = lambda number, path: Answer(403, b"") if "data/" in path else None
        with pytest.raises(DatasetError, match="ACCESS_DENIED"):
            z2r.audit(urls["arm"], executor=processes)


# --- no more bytes


def test_no_more_is_fetched_than_the_columns_hold(storage: Storage, tmp_path: Path) -> None:
    root = wide(tmp_path / "wide")
    url = storage.put(root, "wide")
    storage.door.heal()
    assert z2r.inspect_dataset(url).metrics("", 0) == z2r.inspect_dataset(root).metrics("", 0)
    data = next(root.glob("data/*/*.parquet"))
    footer = pq.ParquetFile(data).metadata
    chunks = [
        footer.row_group(group).column(place)
        for group in range(footer.num_row_groups)
        for place in range(footer.num_columns)
    ]
    needed = sum(
        chunk.total_compressed_size
        for chunk in chunks
        if chunk.path_in_schema.startswith(("observation.state", "action"))
    )
    others = sum(path.stat().st_size for path in (root / "meta").rglob("*") if path.is_file())
    assert needed < data.stat().st_size / 2
    assert needed < storage.door.n_bytes - others < 1.05 * needed + 2**16
    assert remote.bytes_fetched() >= storage.door.n_bytes


def test_a_long_footer_and_many_row_groups_are_fetched_once(tmp_path: Path) -> None:
    fsspec = pytest.importorskip("fsspec")
    root = Path(shutil.copytree(z2r.STANDIN, tmp_path / "standin"))
    [data] = root.glob("data/*/*.parquet")
    pq.write_table(pq.read_table(data), data, row_group_size=3)
    footer = pq.ParquetFile(data).metadata
    fsspec.filesystem("memory").put(str(root), "/robots/grouped", recursive=True)
    others = sum(path.stat().st_size for path in (root / "meta").rglob("*") if path.is_file())
    remote.forget()
    before = remote.bytes_fetched()
    assert audited("memory://robots/grouped") == audited(root)
    assert footer.serialized_size > 2**16
    assert remote.bytes_fetched() - before - others <= 1.01 * data.stat().st_size


def wide(root: Path) -> Path:
    """The shipped dataset with a column of noise that no signal is: a picture of 2,000 numbers in each frame."""
    shutil.copytree(z2r.STANDIN, root)
    info = root / "meta/info.json"
    schema = json.loads(info.read_text())
    schema["features"]["depth"] = {"dtype": "float32", "shape": [2000], "names": None}
    info.write_text(json.dumps(schema))
    [data] = root.glob("data/*/*.parquet")
    table = pq.read_table(data)
    noise = np.random.default_rng(0).random(2000 * len(table), dtype=np.float32)
    table = table.append_column("depth", pa.FixedSizeListArray.from_arrays(pa.array(noise), 2000))
    pq.write_table(table, data, row_group_size=100)
    return root


# --- faults


def refused(url: str) -> str:
    """What is said in one line, by the command line, of each command."""
    said = set()
    for asks in (z2r.load, z2r.inspect_dataset, z2r.audit, z2r.audit_beliefs):
        remote.forget()
        with pytest.raises(DatasetError) as caught:
            asks(url)
        said.add(str(caught.value))
    assert all("\n" not in line for line in said)
    return sorted(said)[0]


def test_a_store_that_fails_now_and_then_is_asked_again(storage: Storage, urls: dict[str, str]) -> None:
    right = audited(urls["arm"])
    for fault in (Answer(500, b""), Answer(503, b"<Error><Code>SlowDown</Code></Error>"), "cut"):
        storage.door.heal()
        remote.forget()
        storage.door.fault = lambda number, path, fault=fault: fault if number % 7 == 0 else None
        assert audited(urls["arm"]) == right
        assert len(storage.door.requests) > 14


def test_a_store_that_is_slow_is_waited_for(storage: Storage, urls: dict[str, str]) -> None:
    storage.door.fault = lambda number, path: time.sleep(0.05)
    assert audited(urls["standin"]) == audited("standin") | {"findings": audited(urls["standin"])["findings"]}


@pytest.mark.parametrize("fault", [Answer(500, b""), "cut"])
@pytest.mark.parametrize("what", ["meta/info.json", "meta/episodes", "data/", "videos/"])
def test_a_store_that_always_fails_is_an_error_that_names_the_file(
    fault: object, what: str, storage: Storage, urls: dict[str, str]
) -> None:
    storage.door.fault = lambda number, path: fault if what in path else None
    with pytest.raises(DatasetError) as caught:
        z2r.audit(urls["arm"])
    assert what in str(caught.value)
    assert "expected an answer from where it is stored. Try again" in str(caught.value)


def test_a_store_that_never_answers_is_an_error(storage: Storage, urls: dict[str, str], monkeypatch) -> None:
    monkeypatch.setattr(remote, "_PATIENCE", 0.2)
    monkeypatch.setattr(remote, "_PAUSES", ())
    storage.door.fault = lambda number, path: time.sleep(2) if "data/" in path else None
    with pytest.raises(DatasetError, match=r"data/chunk-000/file-000\.parquet: found .*imeout.*Try again"):
        z2r.inspect_dataset(urls["standin"])


def test_nobody_there_is_an_error(storage: Storage, urls: dict[str, str], monkeypatch) -> None:
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
    assert "AWS_ENDPOINT_URL says which store is asked" in refused(urls["standin"])


def test_credentials_that_are_wrong_or_gone_are_named(storage: Storage, urls: dict[str, str], monkeypatch) -> None:
    mend = "Set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_PROFILE"
    denied = Answer(403, b"<Error><Code>ExpiredToken</Code></Error>")
    storage.door.fault = lambda number, path: denied if "data/" in path else None
    with pytest.raises(DatasetError, match=mend):
        z2r.audit(urls["standin"])
    storage.door.heal()
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "another")
    assert mend in refused(urls["standin"])
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    assert mend in refused(urls["standin"])


def test_the_command_line_says_it_in_one_line(storage: Storage, urls: dict[str, str], tmp_path: Path) -> None:
    storage.door.fault = lambda number, path: Answer(403, b"") if "data/" in path else None
    for args in (["inspect"], ["audit", "--keep", "kept.json"], ["report"], ["reading"]):
        done = run(*args, urls["standin"], cwd=tmp_path)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert done.stderr.startswith(f"z2r: {urls['standin']}/data/chunk-000/file-000.parquet: found ACCESS_DENIED")
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_a_file_that_shrinks_while_it_is_read_is_no_answer(storage: Storage, urls: dict[str, str]) -> None:
    url = storage.put(z2r.STANDIN, "shrinking")
    path = place_of(url) / "data/chunk-000/file-000.parquet"
    file = FarFile(path)
    opened = file.far._opened._replace(size=10**6)
    file.far._opened, file.far._last = opened, (0, memoryview(b""))
    with pytest.raises(Unreachable, match="cut off"):
        file.fetch([(0, 10**6)])


# --- nothing is believed


@pytest.mark.parametrize("path", ["../arm/meta/info.json", "/etc/passwd", "data/../../arm", "a\0b"])
def test_no_path_leaves_the_root(path: str) -> None:
    with pytest.raises(DatasetError, match="leads out of the dataset"):
        store.inside(Url("s3://robots/standin"), path)


def test_what_lies_beside_a_bucket_is_not_asked_for(storage: Storage) -> None:
    assert z2r.read_verdict(Url("s3://robots")) is None
    assert storage.door.requests == []


@pytest.mark.parametrize(
    "url",
    ["https://host/dataset", "s3://", "hf://user/name", "hf://datasets/user", "s3://bucket/../other", "ssh://x/y"],
)
def test_a_url_that_is_none_of_a_dataset_is_refused(url: str) -> None:
    with pytest.raises(DatasetError, match="a URL that no dataset is read from, expected one such as s3://bucket"):
        z2r.load(url)


def test_ranges_are_claims(storage: Storage, urls: dict[str, str], monkeypatch) -> None:
    path = place_of(urls["arm"]) / "data/chunk-000/file-000.parquet"
    whole = z2r.ARM.joinpath("data/chunk-000/file-000.parquet").read_bytes()
    monkeypatch.setattr(remote, "_WHOLE", 0)
    with FarFile(path) as file:
        storage.door.heal()
        assert file.fetch([(-5, 10), (0, 10**15), (7, 3), (100, 200)] * 50).read() == whole
        assert storage.door.n_bytes == len(whole)
        there = file.fetch([(10, 20), (90_000, 90_010)]).read()
        assert there == bytes(10) + whole[10:20] + bytes(89_980) + whole[90_000:90_010] + bytes(len(whole) - 90_010)
        assert file.read() == whole  # what was not fetched before is fetched then
    monkeypatch.setattr(remote, "_AT_ONCE", 1000)
    with FarFile(path) as file, pytest.raises(Unreachable, match=r"bytes to fetch at once, expected at most 1,000"):
        file.fetch([(0, len(whole))])
    with FarFile(path) as file:
        assert file.fetch([(10, 20)]).read(500) == whole[:500]  # too large to lie in memory as a whole: it asks


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="nothing says how much memory is used")
def test_of_a_large_file_what_is_not_fetched_takes_no_memory(storage: Storage, urls: dict[str, str]) -> None:
    def n_pages() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1])

    file = FarFile(place_of(urls["arm"]) / "data/chunk-000/file-000.parquet")
    file.far._opened = file.far._opened._replace(size=2**29)
    before = n_pages()
    there = file.far.in_memory()
    assert there.size() == 2**29
    assert (n_pages() - before) * 4096 < 2**26


def test_python_is_not_asked_for_each_row_group(storage: Storage, tmp_path, monkeypatch) -> None:
    table = pa.table(
        {"a": np.arange(40_000), "b": np.random.default_rng(0).normal(size=40_000), "c": np.arange(40_000)}
    )
    pq.write_table(table, tmp_path / "many.parquet", row_group_size=100)
    path, asked = place_of(storage.put(tmp_path, "many")) / "many.parquet", []
    read = remote._Far.read
    monkeypatch.setattr(remote._Far, "read", lambda far, n=-1: asked.append(n) or read(far, n))
    assert read_columns(open_parquet(path), path, ["a", "b"]).equals(table.select(["a", "b"]))
    assert len(asked) < 10


@pytest.mark.parametrize("piece", [1, 7, 64, 2**23])
def test_pieces_are_put_together(piece: int, storage: Storage, urls: dict[str, str], monkeypatch) -> None:
    whole = z2r.STANDIN.joinpath("meta/info.json").read_bytes()[:200]
    store_of = remote._open(place_of(urls["standin"]) / "meta/info.json")._replace(size=200)
    monkeypatch.setattr(remote, "_PIECE", piece)
    parts = remote._fetch(Url("s3://x/y"), store_of, [(0, 50), (60, 61), (90, 200)])
    assert [bytes(part) for _, part in parts] == [whole[:50], whole[60:61], whole[90:200]]


def test_an_error_survives_pickling() -> None:
    lost = Unreachable(Fault(Url("s3://bucket/file"), "", "nothing", "an answer"))
    again = pickle.loads(pickle.dumps(lost))
    assert again.fault == lost.fault
    assert isinstance(again.fault.path, Url)


def test_a_path_at_a_url_is_joined_as_any(storage: Storage) -> None:
    root = Url("s3://bucket/dataset")
    path = root / "meta" / Path("info.json")
    assert (str(path), path.name, path.parents[1]) == ("s3://bucket/dataset/meta/info.json", "info.json", root)
    assert path.relative_to(root) == Path("meta/info.json")
    assert type(path.relative_to(root)) is type(Path())
    assert root / path == path
    assert pickle.loads(pickle.dumps(path)) == path
    with pytest.raises(TypeError, match="no path of this machine"):
        path.read_bytes()
    assert storage.door.requests == []
    assert BUCKET not in str(path)


# --- before a download


def test_a_verdict_before_a_download_reads_no_frame(storage: Storage, urls: dict[str, str]) -> None:
    found = audited(urls["arm"], meta_only=True)
    assert found == audited("arm", meta_only=True)
    assert (found["exit_code"], found["n_frames"]) == (0, 1881)
    [left_out] = found["not_checked"]
    assert all(f" {check}," in left_out for check in ("finite", "late", "stats", "camera-flat"))
    assert " totals," not in left_out


@pytest.mark.parametrize("name", SHIPPED)
def test_statistics_add_up_and_those_that_do_not_are_found(name: str, tmp_path: Path) -> None:
    root = Path(shutil.copytree(find_dataset(name), tmp_path / name))
    assert not [each for each in z2r.audit(root, meta_only=True).findings if each.check == "stats"]
    path = root / "meta/stats.json"
    stats = json.loads(path.read_text())
    stats["action"]["std"][0] *= 8
    stats["observation.state"]["count"][0] += 1
    path.write_text(json.dumps(stats))
    found = {each.field: each for each in z2r.audit(root, meta_only=True).findings if each.check == "stats"}
    said = {(each.severity, each.field.split("[")[0]) for each in found.values()}
    assert said == {("warning", "action.std"), ("note", "observation.state.count")}
    assert all("which those of the episodes add up to" in each.expected for each in found.values())


def test_a_verdict_before_a_download_fetches_no_frame(storage: Storage, tmp_path: Path) -> None:
    root = wide(tmp_path / "wide")
    url = storage.put(root, "wide-too")
    storage.door.heal()
    assert z2r.audit(url, meta_only=True).n_frames == 427
    metadata = sum(path.stat().st_size for path in (root / "meta").rglob("*") if path.is_file())
    assert storage.door.n_bytes - metadata <= 2**16


def test_what_metadata_and_footers_tell_is_found_before_a_download(recorded: Path, tmp_path: Path) -> None:
    root = Path(shutil.copytree(recorded, tmp_path / "damaged"))
    first, second, third, fourth, *_ = sorted(root.glob("data/*/*.parquet"))
    first.write_bytes(first.read_bytes()[:-300])
    second.unlink()
    table = pq.read_table(third)
    pq.write_table(table.drop_columns("action"), third)
    pq.write_table(table.slice(1), fourth)
    (root / "meta/stats.json").write_text("{")
    found = {(finding.check, finding.file) for finding in z2r.audit(root, meta_only=True).findings}
    places = {path: path.relative_to(root).as_posix() for path in (first, second, third, fourth)}
    assert found >= {
        ("data-file", places[first]),
        ("data-file", places[second]),
        ("columns", places[third]),
        ("file-rows", places[fourth]),
        ("stats-file", "meta/stats.json"),
    }


@pytest.mark.parametrize("options", [{"pictures": True}, {"mode": z2r.break_mode("yaw-swap")}])
def test_a_verdict_before_a_download_goes_with_nothing_that_reads_frames(options: dict) -> None:
    with pytest.raises(ValueError, match="meta_only reads no frame"):
        z2r.audit("standin", meta_only=True, **options)
