"""A dataset is found by its folder or its name; where it is not, a name that is nearly the same is offered."""

import pytest

import z2r
from z2r.data import find_dataset


def test_a_name_that_ships_is_found_and_a_folder_of_that_name_goes_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert find_dataset(None) == find_dataset("standin") == z2r.STANDIN
    assert find_dataset("messy") == z2r.MESSY
    (tmp_path / "messy").mkdir()
    assert find_dataset("messy").resolve() == tmp_path / "messy"


@pytest.mark.parametrize(
    ("name", "offered"),
    [("standing", "standin"), ("mesy", "messy"), ("my_datset", "my_dataset"), ("there/my_dat", "there/my_data")],
)
def test_a_misspelt_name_offers_the_near_ones(name, offered, tmp_path, monkeypatch):
    (tmp_path / "my_dataset").mkdir()
    (tmp_path / "there/my_data").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(z2r.DatasetError, match=rf"found no such folder, .*\. Did you mean {offered}\?$"):
        find_dataset(name)


@pytest.mark.parametrize("name", ["qqqq", "no/such/parent", "elsewhere/standing"])
def test_a_name_that_is_like_no_other_offers_nothing(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(z2r.DatasetError, match=r"standin or messy$") as caught:
        find_dataset(name)
    assert caught.value.fault.mend == ""
