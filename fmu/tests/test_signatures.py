"""Signatures and enumeration values of the exported functions equal those of the standard's headers, as FMPy ships them."""

import re
from pathlib import Path

import fmpy
import pytest
import raw

SOURCES = Path(__file__).parents[1] / "src"
HEADERS = Path(fmpy.__file__).parent / "c-code"
COUNT = {"2": 34, "3": 75}
C_TYPES = {
    "void": "void", "char": "c_char", "int": "i32", "unsigned int": "u32", "size_t": "usize", "float": "f32", "double": "f64",
    "bool": "u8", "int8_t": "i8", "uint8_t": "u8", "int16_t": "i16", "uint16_t": "u16", "int32_t": "i32", "uint32_t": "u32",
    "int64_t": "i64", "uint64_t": "u64", "fmi2Byte": "u8",
}  # fmt: skip
RUST_TYPES = {"c_int": "i32", "c_void": "void", "Boolean": "u8", "Callbacks": "fmi2CallbackFunctions"}


def without_comments(text):
    return re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.S)


class Header:
    """The types, functions and enumerations that the headers of one version declare."""

    def __init__(self, version):
        names = {"2": ("fmi2TypesPlatform.h", "fmi2FunctionTypes.h"), "3": ("fmi3PlatformTypes.h", "fmi3FunctionTypes.h")}
        text = without_comments("".join((HEADERS / n).read_text() for n in names[version]))
        self.types = dict(C_TYPES)
        self.enumerations, self.values = set(), {}
        for body, name in re.findall(r"typedef\s+enum\s*\{(.*?)\}\s*(\w+)\s*;", text, flags=re.S):
            self.enumerations.add(name)
            self.values |= {v.strip(): i for i, v in enumerate(body.split(",")) if v.strip()}
        self.callbacks = set(re.findall(r"\(\s*\*\s*(\w+)\s*\)\s*\(", text))
        for of, name in re.findall(r"typedef\s+([\w\s]+\*?)\s*(fmi\d\w+)\s*;", text):
            self.types.setdefault(name, self.canonical(of))
        found = re.findall(r"typedef\s+([\w\s]+?\*?)\s*(fmi\d\w+)TYPE\s*\((.*?)\)\s*;", text, flags=re.S)
        self.functions = {name: self.signature(result, parameters) for result, name, parameters in found}

    def canonical(self, declared):
        """A C type in the words of Rust: `*const T`, `*mut T`."""
        words = declared.replace("*", " * ").split()
        is_const, stars = words[0] == "const", words.count("*")
        name = " ".join(w for w in words if w not in ("const", "*"))
        if name in self.enumerations:
            inner = "i32"
        elif name in self.callbacks:
            inner = "fn"
        else:
            inner = self.types.get(name, name)
        for i in range(stars):
            inner = f"*{'const' if is_const and i == 0 else 'mut'} {inner}"
        return inner

    def signature(self, result, parameters):
        kinds = []
        for parameter in parameters.split(","):
            parameter = " ".join(parameter.split())
            if parameter in ("void", ""):
                continue
            is_array = parameter.endswith("[]")
            # the standard leaves some parameters without a name
            named = re.match(r"(.*?[\s*])\w+(\[\])?$", parameter)
            kind = named.group(1) if named else parameter.removesuffix("[]")
            kinds.append(self.canonical(kind + ("*" if is_array else "")))
        return kinds, self.canonical(result)


def rust_type(declared):
    declared = " ".join(declared.split()).rstrip(",")
    if declared in ("Instance", "Component", "State"):
        return "*mut void"
    if "extern \"C\" fn" in declared or declared in ("LogMessage", "Logger", "Callback"):
        return "fn"
    pointer = re.match(r"\*(const|mut) (.*)", declared)
    if pointer:
        return f"*{pointer.group(1)} {rust_type(pointer.group(2))}"
    return RUST_TYPES.get(declared, declared)


def split(parameters):
    """Types of `name: type` pairs; commas inside brackets do not separate."""
    depth, parts = 0, [""]
    for c in parameters:
        depth += (c in "(<") - (c in ")>" and not parts[-1].endswith("-"))
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return [rust_type(p.split(":", 1)[1]) for p in parts if p.strip()]


def exported(version):
    """The functions that the Rust sources export, those made by macros included."""
    files = [SOURCES / f"fmi{version}.rs", *sorted((SOURCES / f"fmi{version}").rglob("*.rs"))]
    text = "".join(without_comments(p.read_text()) for p in files)
    functions = {}
    plain = r"fn (fmi\d[A-Z]\w+)\(((?:[^()]|\((?:[^()]|\([^()]*\))*\))*)\)\s*(?:->\s*([^{]+?))?\s*\{"
    for name, parameters, result in re.findall(plain, text):
        functions[name] = (split(parameters), rust_type(result) if result else "void")
    for body in re.findall(r"\nwithout_variables!\s*\{(.*?)\n\}", text, flags=re.S):
        for name, values in re.findall(r"(fmi\w+)\(([^)]*)\);", body):
            count = ["usize"] if version == "3" else []
            functions[name] = (["*mut void", "*const u32", "usize", rust_type(values), *count], "i32")
    for body in re.findall(r"\nrefused!\s*\{(.*?)\n\}", text, flags=re.S):
        for name, parameters in re.findall(r"(fmi\w+)\(([^)]*)\);", body):
            functions[name] = (["*mut void", *split(parameters)], "i32")
    return functions


@pytest.mark.parametrize("version", ["2", "3"])
def test_signatures_are_those_of_the_standard(version):
    header, functions = Header(version), exported(version)
    assert len(functions) == COUNT[version], sorted(functions)
    for name, signature in functions.items():
        assert signature == header.functions[name], name


def test_enumeration_values_are_those_of_the_standard(pack):
    fault = (SOURCES / "fault.rs").read_text()
    status = {n: int(v) for n, v in re.findall(r"pub const (OK|WARNING|DISCARD|ERROR): i32 = (\d+);", fault)}
    for version in ("2", "3"):
        values = Header(version).values
        expected = {n.upper(): values[f"fmi{version}{n}"] for n in ("Warning", "Discard", "Error")}
        assert status == {"OK": values[f"fmi{version}OK"], **expected}
    assert raw.OK == status["OK"]
    kinds = Header("2").values
    library = raw.Library(pack("kazmi2014", "2"))
    pad = raw.Instance(library, kind=kinds["fmi2CoSimulation"])
    assert pad.p
    pad.free()
    assert not raw.Instance(library, kind=kinds["fmi2ModelExchange"]).p
    library.close()
