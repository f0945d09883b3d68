"""Every Python example of the pages runs and gives what it says."""

import doctest
import pathlib
import re

import optional
import pytest

import qless

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGES = [ROOT / "docs" / "python.md", ROOT / "README.md", ROOT / "crates" / "qless-python" / "README.md"]


#: What the example of an adapter imports.
ADAPTERS = [name for name in optional.WHEELS if name != "highspy"]


def needs(example):
    """The package that an example imports, if it is the example of an adapter."""
    return next((name for name in ADAPTERS if f"import {name}" in example), None)


def run(example, page, known):
    """Runs an example; returns the names that it leaves."""
    if ">>>" not in example:
        exec(compile(example, str(page), "exec"), known)
        return known
    parsed = doctest.DocTestParser().get_doctest(example, known, page.name, str(page), 0)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    assert runner.run(parsed, clear_globs=False).failed == 0
    return parsed.globs


def examples(page):
    found = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
    assert found
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name + "/" + page.name)
def test_examples_of_a_page(page, monkeypatch):
    monkeypatch.chdir(ROOT)
    known: dict = {}
    for example in examples(page):
        if needs(example) is None:
            # An example goes on where the one before it ends.
            known = run(example, page, known)


@pytest.mark.parametrize("package", ADAPTERS)
def test_examples_of_an_adapter(package):
    optional.package(package)
    page = PAGES[0]
    own = [example for example in examples(page) if needs(example) == package]
    assert own
    for example in own:
        run(example, page, {})


def test_examples_of_the_package():
    assert doctest.testmod(qless).attempted > 2 and doctest.testmod(qless).failed == 0
