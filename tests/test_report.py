"""The page that shows a dataset, as it is written: what its HTML says, what it leaves out, and that data stay data."""

import base64
import hashlib
import importlib.util
import io
import json
import re
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import skip_without
from damages import BASES
from jinja2 import UndefinedError
from layouts import lay_out
from notebook_tools import code_cells, committed
from PIL import Image, ImageSequence
from robots import write_arm
from test_cli import run

import z2r
from z2r.errors import DatasetError
from z2r.show import report
from z2r.show.page import moving, templates
from z2r.show.page.content import WRONG_READINGS

HOSTILE = "</script><img src=x onerror=alert(1)>"


class Elements(HTMLParser):
    """Every element of a page as (tag, attributes), and the text in it, scripts and styles apart."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text: dict[str, str] = {}
        self._inside = ""
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self._inside = f"script {dict(attrs).get('type', '')}".strip() if tag == "script" else tag

    def handle_endtag(self, tag):
        self._inside = ""

    def handle_data(self, data):
        kind = self._inside if self._inside.startswith(("script", "style")) else "page"
        self.text[kind] = self.text.get(kind, "") + data


def write(dataset: z2r.Dataset, tmp_path: Path, **how: Any) -> str:
    z2r.write_report(dataset, tmp_path / "report.html", **how)
    return (tmp_path / "report.html").read_text()


def answers(page: str) -> dict[str, tuple[str, str]]:
    """What each reading says: its name, how many reached the target, and the share."""
    found = re.findall(r'class="answer" data-reading="(.*?)".*?percent">(.*?)<.*?tally"><b>(.*?)<', page, re.DOTALL)
    return {name: (tally, percent) for name, percent, tally in found}


@pytest.mark.parametrize(("root", "n_episodes"), [(z2r.STANDIN, 6), (z2r.MESSY, 14), (z2r.MESSY, 3)])
def test_the_html_says_what_metrics_json_says_under_every_reading(root, n_episodes, tmp_path):
    dataset = z2r.load(root).first(n_episodes)
    page = write(dataset, tmp_path)
    expected = {}
    for name in ("right", *WRONG_READINGS):
        mode = None if name == "right" else z2r.break_mode(name)
        metrics = z2r.inspect_dataset(dataset, mode).metrics(root.name, None)
        expected[name] = (f"{metrics['n_reached']} of {metrics['n_episodes']}", f"{metrics['success_rate']:.0%}")
    assert answers(page) == expected
    assert answers(page)["yaw-swap"][1] == "0%"
    metrics = z2r.inspect_dataset(dataset).metrics(root.name, None)
    facts = dict(re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", page))
    assert facts["episodes"] == f"{metrics['n_episodes']}"
    assert facts["frames"] == f"{metrics['n_frames']:,}"
    assert facts["on average"] == f"{metrics['mean_episode_length']:.1f}"
    lengths = re.findall(r'<th scope="row"><a.*?>\d+</a></th><td>[\d,]+</td><td>(\d+)</td>', page)
    assert lengths[: len(dataset.episodes)] == [f"{length}" for length in metrics["episode_lengths"]]


def test_every_dimension_has_its_range(tmp_path):
    dataset = z2r.load(z2r.STANDIN)
    number = '<td class="number">(.*?)</td>'
    rows = re.findall(rf"<tr><td>(.*?) <span>.*?</td>{3 * number}", write(dataset, tmp_path))
    values = np.concatenate([dataset.read("observation.state"), dataset.read("action")], axis=1)
    names = [name for feature in dataset.schema.signals().values() for name in feature.dim_names]
    sums = values.min(axis=0), values.mean(axis=0, dtype=np.float64), values.max(axis=0)
    assert rows == [(name, *(f"{value:z.3f}" for value in each)) for name, *each in zip(names, *sums, strict=True)]


def test_the_page_is_one_file_that_names_no_other(tmp_path):
    page = write(z2r.load(z2r.STANDIN), tmp_path)
    assert len(page) < 400_000
    elements = Elements(page)
    names = {name for _, attributes in elements.elements for name in attributes}
    assert not names & {"src", "style", "srcdoc"}
    links = [attributes["href"] for _, attributes in elements.elements if "href" in attributes]
    assert links
    assert all(link.startswith("#") for link in links)
    assert not [name for name in names if name.startswith("on")]
    assert "@import" not in elements.text["style"]


def test_the_policy_lets_nothing_run_but_the_script_and_the_style_of_the_page(tmp_path):
    elements = Elements(write(z2r.load(z2r.STANDIN), tmp_path))
    [policy] = [a["content"] for tag, a in elements.elements if a.get("http-equiv") == "Content-Security-Policy"]
    directives = dict(directive.strip().split(" ", 1) for directive in policy.split(";"))
    assert directives.pop("media-src") == directives.pop("img-src") == "blob:"  # what cameras saw, which is in the page
    assert directives.pop("default-src") == directives.pop("base-uri") == directives.pop("form-action") == "'none'"
    for name, text in (("script-src", elements.text["script"]), ("style-src", elements.text["style"])):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert directives.pop(name) == f"'sha256-{digest}'"
    assert not directives


def make_hostile(root: Path) -> Path:
    """Put markup wherever a dataset can hold text, in its folder's name too."""
    info = json.loads((root / "meta/info.json").read_text())
    features = info["features"]
    features["action"]["names"] = [HOSTILE, "x" * 3000]
    features[HOSTILE] = {"dtype": f"string{HOSTILE}", "shape": [1], "names": [HOSTILE]}
    features["$data ${title} &amp; \u202e\x1b[2J"] = {"dtype": "string", "shape": [1], "names": None}
    info["codebase_version"] = f"v3.{HOSTILE}"
    info["robot_type"] = HOSTILE
    (root / "meta/info.json").write_text(json.dumps(info))
    return root.rename(root.with_name(HOSTILE.replace("/", " ")))


def test_names_of_a_dataset_are_never_taken_for_markup(standin_copy, tmp_path):
    dataset = z2r.load(make_hostile(standin_copy))
    page = write(dataset, tmp_path)
    elements = Elements(page)
    assert not [tag for tag, _ in elements.elements if tag in ("img", "iframe")]
    assert [tag for tag, _ in elements.elements].count("script") == 2
    assert HOSTILE in elements.text["page"]
    assert "$data ${title} &amp;" in elements.text["page"]
    assert "\x1b" not in page
    assert "\u202e" not in page
    shown = Elements(z2r.panel(dataset)._repr_html_())
    assert [tag for tag, _ in shown.elements].count("iframe") == 1
    assert [tag for tag, _ in shown.elements].count("script") == 1
    assert not [tag for tag, attributes in shown.elements if "onerror" in attributes]


def test_nothing_is_called_markup_but_what_the_package_writes():
    unescaped = set()
    for path in (*templates.FOLDER.glob("*.html"), *templates.FOLDER.glob("*.svg")):
        unescaped |= set(re.findall(r"([^\s>]+) ?\| ?(?:safe|forceescape)", path.read_text()))
    # `render` escapes what could end the element of the data; a whole page is escaped once more, as an attribute.
    pages = {"style", "data", "script", "page"}
    assert unescaped == pages | {"""'vector-effect="non-scaling-stroke"'""", "paint[body.role]"}


def test_a_template_that_is_given_too_little_says_so():
    with pytest.raises(UndefinedError, match="world"):
        templates.fill("scene.svg")


def test_a_large_dataset_leaves_episodes_out_and_says_which(tmp_path, monkeypatch):
    root = tmp_path / "many"
    lay_out(root, [5] * 700, files=[300, 400], shards=[700])
    monkeypatch.setattr(report, "_MAX_BYTES", (12 + 10) * 4 * 52)
    dataset = z2r.load(root)
    written = z2r.write_report(dataset, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert (written.n_episodes, written.n_frames) == (10, 50)
    assert "episodes 10 to 699 are left out" in written.left_out
    assert written.left_out in page
    n_reached = z2r.inspect_dataset(dataset).outcome.n_reached
    assert answers(page)["right"][0] == f"{n_reached} of 700"
    assert frames_of(page).shape == (12, 50)


def test_of_an_episode_that_is_too_long_the_beginning_is_shown(tmp_path, monkeypatch):
    root = tmp_path / "long"
    lay_out(root, [90, 10], files=[2], shards=[2])
    monkeypatch.setattr(report, "_MAX_BYTES", (12 + 10) * 4 * 40)
    dataset = z2r.load(root)
    written = z2r.write_report(dataset, tmp_path / "report.html")
    assert (written.n_episodes, written.n_frames) == (1, 40)
    assert "first 40 frames" in written.left_out
    assert "episode 1 are left out" in written.left_out
    expected = np.concatenate([dataset.read("observation.state"), dataset.read("action")], axis=1)[:40].T
    np.testing.assert_array_equal(frames_of((tmp_path / "report.html").read_text()), expected)


def frames_of(page: str) -> np.ndarray:
    """The frames in the page as the data files have them, (n_columns, n_frames)."""
    return columns_of(page)[: len(data_of(page)["names"])]


def columns_of(page: str) -> np.ndarray:
    """The frames in the page, and what is derived from them."""
    data = data_of(page)
    return np.frombuffer(base64.b64decode(data["frames"]), f"<f{data['bytes']}").reshape(-1, data["shown"])


def data_of(page: str) -> dict[str, Any]:
    return json.loads(Elements(page).text["script application/json"])


TSC = Path(__file__).parents[1] / ".ci/web/node_modules/.bin/tsc"


def test_the_data_are_what_the_script_of_the_page_is_checked_to_be_given(standin_copy, tmp_path):
    skip_without(TSC.exists(), "no TypeScript: npm --prefix .ci/web ci")
    BASES["labelled"](tmp_path / "labelled")
    arm, reading = write_arm(tmp_path / "arm")
    pages = [
        *(write(z2r.load(root), tmp_path) for root in (z2r.MESSY, make_hostile(standin_copy), tmp_path / "labelled")),
        write(arm, tmp_path, reading=reading),
        write(z2r.load("arm"), tmp_path),
    ]
    data = ",\n".join(Elements(page).text["script application/json"] for page in pages)
    (tmp_path / "data.ts").write_text(f"const pages: PageData[] = [{data}];")
    types = Path(report.__file__).with_name("page") / "types.d.ts"
    done = subprocess.run([TSC, "--noEmit", "--strict", types, "data.ts"], cwd=tmp_path, capture_output=True, text=True)
    assert not done.stdout, done.stdout[:2000]


def test_the_page_of_a_million_frames_would_stay_below_5_megabytes(tmp_path, monkeypatch):
    """With one long episode, the most that fits is in the page: all the rest of a page does not grow with it."""
    root = tmp_path / "long"
    lay_out(root, [70_000, *[1] * 3000], files=[3001], shards=[3001])
    page = write(z2r.load(root), tmp_path)
    assert 2_400_000 < columns_of(page).nbytes <= 3_000_000
    assert len(page.encode()) < 5_000_000


def test_a_dataset_of_another_robot_has_no_success_and_no_scene(standin_copy, tmp_path):
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("tee_x", "cube_x"))
    page = write(z2r.load(standin_copy), tmp_path)
    assert not answers(page)
    assert "its reading needs tee_x, which is not there" in page
    assert 'id="scene"' not in page
    assert "reached" not in z2r.panel(z2r.load(standin_copy)).title


def test_numbers_wider_than_float32_are_kept_as_they_are(standin_copy, tmp_path):
    path = next(standin_copy.glob("data/*/*.parquet"))
    table = pq.read_table(path)
    wide = pa.array(np.pi * np.arange(len(table)))
    pq.write_table(table.append_column("observation.torque", wide), path)
    info = json.loads((standin_copy / "meta/info.json").read_text())
    info["features"]["observation.torque"] = {"dtype": "float64", "shape": [1], "names": None}
    (standin_copy / "meta/info.json").write_text(json.dumps(info))
    np.testing.assert_array_equal(frames_of(write(z2r.load(standin_copy), tmp_path))[-1], wide.to_numpy())


def test_a_salvaged_dataset_is_shown_without_what_lies_between_its_episodes(tmp_path):
    whole = z2r.load(z2r.MESSY)
    kept = np.isin(np.arange(14), [1, 4, 13])
    page = write(replace(whole, episodes=whole.episodes.only(kept)), tmp_path)
    expected = np.concatenate([whole.read("observation.state")[whole.episodes[number]] for number in (1, 4, 13)])
    np.testing.assert_array_equal(frames_of(page)[:10], expected.T)
    assert answers(page)["right"][0] == "2 of 3"
    data = data_of(page)
    for reading in data["readings"][:3]:
        assert reading["numbers"] == [1, 4, 13]
        assert reading["episodes"] == [[0, 108], [108, 228], [228, 246]]
    assert data["readings"][3]["episodes"] == [[0, 246]]


def test_the_dataset_is_never_written_to(standin_copy):
    before = sorted(standin_copy.rglob("*"))
    with pytest.raises(z2r.DatasetError, match="found a place in the dataset"):
        z2r.write_report(z2r.load(standin_copy), standin_copy / "meta/report.html")
    assert sorted(standin_copy.rglob("*")) == before


def test_a_fault_in_the_data_is_named_and_no_page_is_written(standin_copy, tmp_path):
    next(standin_copy.glob("data/*/*.parquet")).write_bytes(b"no parquet")
    with pytest.raises(DatasetError, match="parquet"):
        z2r.write_report(z2r.load(standin_copy), tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_a_panel_is_the_page_in_a_frame_that_cannot_touch_the_notebook(tmp_path):
    dataset = z2r.load(z2r.STANDIN)
    panel = z2r.panel(dataset)
    [frame] = [attributes for tag, attributes in Elements(panel._repr_html_()).elements if tag == "iframe"]
    assert frame["sandbox"] == "allow-scripts"
    assert frame["srcdoc"] == write(dataset, tmp_path, with_audit=False).replace('id="switch" open', 'id="switch"')
    assert panel._repr_html_() == z2r.panel(dataset)._repr_html_()
    [picture] = [attributes for tag, attributes in Elements(panel._repr_html_()).elements if tag == "img"]
    assert base64.b64decode(picture["src"].partition(",")[2]) == panel.picture
    assert "6 of 6" in repr(panel)


def pictures_in(panel: report.Panel) -> list[np.ndarray]:
    with Image.open(io.BytesIO(panel.picture)) as file:
        return [np.asarray(each.convert("RGB"), float) for each in ImageSequence.Iterator(file)]


def test_where_no_script_runs_the_bodies_of_the_first_episode_move(monkeypatch):
    dataset = z2r.load(z2r.STANDIN)
    panel = z2r.panel(dataset)
    length, half = int(dataset.episodes.lengths[0]), 0.41  # m: walls at 0.4, and a bit more
    pusher = z2r.decode(dataset.read("observation.state")[:length], z2r.PUSHT, dataset.schema).pose("pusher")
    frames = range(0, length, 2)
    seen = pictures_in(panel)
    assert len(seen) == len(frames)
    for picture, frame in zip(seen, frames, strict=True):
        column, row = (200 + 200 * at / half for at in (pusher.x[frame], -pusher.y[frame]))
        np.testing.assert_allclose(picture[round(row), round(column)], (213, 94, 0), atol=40)
    monkeypatch.setattr(moving, "MAX_BYTES", len(panel.picture) - 1)
    fewer = z2r.panel(dataset)
    assert len(pictures_in(fewer)) == (len(frames) + 1) // 2
    assert len(fewer.picture) < len(panel.picture)


def test_a_panel_needs_no_pillow(monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "PIL" else find(name))
    panel = z2r.panel(z2r.load(z2r.STANDIN))
    assert panel.picture == b""
    assert "<img" not in panel._repr_html_().partition("<iframe")[0]


def test_the_command_says_where_the_page_is(tmp_path):
    result = run("report", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "machine tier" in result.stdout
    assert "z2r-out/report.html" in result.stdout
    assert answers((tmp_path / "z2r-out/report.html").read_text())["right"] == ("6 of 6", "100%")
    assert run("report", "messy", "--out", "a/b.html", cwd=tmp_path).returncode == 0
    assert answers((tmp_path / "a/b.html").read_text())["right"][0] == "11 of 14"


@pytest.mark.parametrize(
    "args", [["nowhere"], [str(z2r.STANDIN), "--out", str(z2r.STANDIN / "x.html")], ["--out", "."]]
)
def test_bad_arguments_exit_with_2_and_write_nothing(args, tmp_path):
    result = run("report", *args, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr
    assert "Traceback" not in result.stderr
    assert not list(tmp_path.iterdir())


def test_the_panel_in_the_first_notebook_is_the_one_that_is_made_today():
    outputs = [output for cell in code_cells(committed("00_start_here")) for output in cell.outputs]
    [shown] = [output.data["text/html"] for output in outputs if "text/html" in output.get("data", {})]
    assert shown == z2r.panel(z2r.load(z2r.STANDIN))._repr_html_()
