"""The blocks of the README run, one after the other."""

import re
from pathlib import Path

import pytest

README = Path(__file__).parent.parent / "README.md"


def test_the_readme_runs(tmp_path, monkeypatch):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pytest.importorskip("geopandas")
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    assert len(blocks) == 4
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)
    assert (tmp_path / "tower.pvs").exists()
    pyplot.close("all")


def test_the_versions_are_those_of_the_package():
    import sightlines as sl

    major_minor = ".".join(sl.__version__.split(".")[:2])
    assert f"\n| {major_minor} | 3.10 and later" in README.read_text()
