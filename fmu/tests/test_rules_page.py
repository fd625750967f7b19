"""docs/fmi-rules.md names every numbered test of the rules, under its number, and no other."""

import re
from pathlib import Path

HERE = Path(__file__).parent


def test_the_page_of_rules_names_every_numbered_test():
    named = set()
    for line in (HERE / "../../docs/fmi-rules.md").read_text().splitlines():
        if row := re.match(r"\| (\d+) \| .+? \| (.+) \|$", line):
            tests = re.findall(r"\[`(test_(\d\d)_\w+)`\]\(\.\./fmu/tests/(\w+\.py)\)", row[2])
            assert tests and all(int(number) == int(row[1]) for _, number, _ in tests), line
            named |= {(file, name) for name, _, file in tests}
    held = {
        (path.name, name)
        for path in HERE.glob("test_rules_*.py")
        for name in re.findall(r"^def (test_\d\d_\w+)", path.read_text(), re.M)
    }
    assert named == held
    assert {int(name[5:7]) for _, name in named} == set(range(1, 45))
