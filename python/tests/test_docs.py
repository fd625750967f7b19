"""Every example in a docstring and on the page of the package runs."""

from __future__ import annotations

import doctest
import importlib
import pathlib
import pkgutil
import re

import pytest

import stickslip

MODULES = [module.name for module in pkgutil.iter_modules(stickslip.__path__) if module.name not in ("__main__", "_native")]
PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_modules(name: str) -> None:
    failed, _ = doctest.testmod(importlib.import_module(f"stickslip.{name}"), optionflags=doctest.ELLIPSIS)
    assert failed == 0


def test_examples_of_the_package() -> None:
    """Those of the module, and of the classes and functions of the extension."""
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    tests = finder.find(stickslip, "stickslip")
    for name in ("compile", "step_many"):
        tests += finder.find(getattr(stickslip, name), name, module=False)
    for name in ("Scene", "Model", "Simulator", "State", "Port"):
        found = finder.find(getattr(stickslip, name), name, module=False, globs={})
        tests += found
    for test in tests:
        runner.run(test)
    assert runner.failures == 0 and runner.tries > 20


def test_everything_is_described() -> None:
    for name in stickslip.__all__:
        thing = getattr(stickslip, name)
        assert thing.__doc__, name
        if isinstance(thing, type) and thing.__module__ == "stickslip":
            for member, value in vars(thing).items():
                if not member.startswith("_"):
                    assert value.__doc__, f"{name}.{member}"


def blocks() -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("number", range(len(blocks())))
def test_the_page_runs(number: int, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(blocks()[number], f"{PAGE.name}, block {number}", "exec"), {"__name__": "__main__"})
