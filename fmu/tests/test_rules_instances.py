"""Rules of creating and freeing instances: one test per rule, for both versions, each with the answer that the rule states."""

import os
from ctypes import c_double, c_void_p

from raw import ERROR, H, Instance, NULL, refused


def test_01_wrong_token_gives_null_and_a_message(library):
    assert refused(library, token=b"{wrong}")
    assert refused(library, token=b"{wrong}", logging=False)


def test_02_null_or_blank_name_or_null_token_gives_null(library):
    assert refused(library, name=None)
    assert refused(library, name=b"")
    assert refused(library, name=b"  ")
    assert refused(library, token=NULL)


def test_03_null_resources_are_found_beside_the_library(library):
    pad = Instance(library, resources=None)
    assert pad.c
    pad.free()
    os.rename(library.folder + "/resources", library.folder + "/elsewhere")
    assert refused(library, resources=None)


def test_04_resource_locations_are_decoded_or_refused(library):
    assert b"%20" in library.resources or library.version == 3
    assert refused(library, resources=library.resources.rstrip(b"/") + b"/missing")
    if library.version == 2:
        assert refused(library, resources=b"http://example.org/resources")
        assert refused(library, resources=b"file:///a%2")
        plain = library.resources.replace(b"file:///", b"file:/")
        pad = Instance(library, resources=plain)
        assert pad.c
        pad.free()
    else:
        pad = Instance(library, resources=library.resources.rstrip(b"/"))
        assert pad.c
        pad.free()


def test_05_free_of_null_is_ignored(library, pad):
    free = library.dll.fmi2FreeInstance if library.version == 2 else library.dll.fmi3FreeInstance
    free(None)
    free(c_void_p(0x12345678))  # nor is a foreign pointer touched
    freed = Instance(library)
    stale = freed.c
    freed.free()
    free(c_void_p(stale))


def test_06_null_freed_and_foreign_instances_are_errors(library):
    pad = Instance(library)
    alive = pad.c
    pad.free()
    for pointer in (None, alive, 0x12345678):
        pad.c = pointer
        assert pad.step(0.0, H) == ERROR
        assert pad.reset() == ERROR
        assert pad.save()[0] == ERROR
        assert pad.get_refs([1], (c_double * 1)()) == ERROR
