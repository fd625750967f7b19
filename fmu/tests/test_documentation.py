"""documentation/index.html as a reader's browser takes it: well-formed, with a picture, complete, and free of links outside."""

import zipfile
from html.parser import HTMLParser

import fmpy
import pytest

VOID = {"meta", "br", "path", "circle", "rect"}


class Page(HTMLParser):
    """Tags in order with their attributes, cells of the tables, and everything that refers to something."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.rows, self.references = [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.references += [value for name, value in attributes if name in ("href", "src", "xlink:href", "action", "data")]
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        assert tag in VOID, tag
        self.handle_starttag(tag, attributes)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "td" in self.open or "th" in self.open:
            self.rows[-1][-1] += data

    def count(self, tag):
        return sum(t == tag for t, _ in self.tags)


def page_of(fmu):
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("documentation/index.html").decode()
    assert text.startswith("<!DOCTYPE html>")
    return text, Page(text)


def unit_of(variable):
    return variable.unit or (variable.declaredType.unit if variable.declaredType else None) or "1"


@pytest.mark.parametrize("kind", ["2", "3", "3 scalar"])
@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d"])
def test_every_variable_is_listed_with_unit_and_start(pack, scene, kind):
    fmu = pack(scene, kind)
    _, page = page_of(fmu)
    head = ["Name", "Unit", "Kind", "Size", "Start", "Meaning"]
    listed = {row[0]: row for row in page.rows[page.rows.index(head) + 1 :]}
    description = fmpy.read_model_description(str(fmu))
    groups = {}
    for variable in description.modelVariables:
        groups.setdefault(variable.name.split("[")[0], []).append(variable)
    assert len(groups) == len(listed)
    for name, members in groups.items():
        first, last = members[0], members[-1]
        row = listed[first.name if first is last else f"{first.name} ... {last.name}"]
        assert row[1] == unit_of(first), name
        count = 1
        for size in row[3].split("×"):
            count *= int(size.strip() or 1)
        assert count == (sum(1 for _ in members) if not first.dimensions else first.shape[0] * (*first.shape, 1)[1]), name
        assert row[4] == "" if first.causality in ("output", "independent") else float(row[4]) == float(first.start), name
        assert len(row[5]) > 10 and row[5].startswith(first.description[:10]), name


@pytest.mark.parametrize(
    ("scene", "faces", "nodes"),
    [("kazmi2014", 4 * 32 * 16, 32), ("brake_pad_3d", 4 * 16 * 3 + 2 * 8 * (16 + 3), 9 * 17)],
)
def test_the_picture_shows_mesh_contact_and_axes(pack, scene, faces, nodes):
    """One closed path per triangle (in 3D the front, the top and the right side), a dot per contact node."""
    text, page = page_of(pack(scene, "3"))
    assert page.count("svg") == 1 and page.count("circle") == nodes
    most = max((attributes["d"] for tag, attributes in page.tags if tag == "path"), key=len)
    assert most.count("Z") == most.count("M") == faces
    for name in ["x", "y"] + ["z"] * (scene == "brake_pad_3d") + ["1", str(nodes)]:
        assert f">{name}</text>" in text
    width, height = (float(x) for x in dict(page.tags)["svg"]["viewbox"].split()[2:])
    places = [(float(a["cx"]), float(a["cy"])) for tag, a in page.tags if tag == "circle"]
    assert all(0 < x < width and 0 < y < height for x, y in places) and len(set(places)) == nodes


@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d"])
def test_the_page_needs_nothing_outside(pack, scene, version):
    text, page = page_of(pack(scene, version))
    assert page.references == []
    assert "http" not in text and "url(" not in text and "@import" not in text
    assert {"script", "img", "link", "iframe"}.isdisjoint(tag for tag, _ in page.tags)
