"""Every Python example of the pages runs and gives what it says."""

import doctest
import pathlib
import re

import pytest

import qless

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGES = [ROOT / "docs" / "python.md", ROOT / "README.md", ROOT / "crates" / "qless-python" / "README.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name + "/" + page.name)
def test_examples_of_a_page(page, monkeypatch):
    monkeypatch.chdir(ROOT)
    examples = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
    assert examples
    known: dict = {}
    for example in examples:
        if ">>>" in example:
            parsed = doctest.DocTestParser().get_doctest(example, known, page.name, str(page), 0)
            runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
            assert runner.run(parsed, clear_globs=False).failed == 0
            # An example goes on where the one before it ends.
            known = parsed.globs
        else:
            exec(compile(example, str(page), "exec"), known)


def test_examples_of_the_package():
    assert doctest.testmod(qless).attempted > 2 and doctest.testmod(qless).failed == 0
