"""A run that a test asks of another importer, and the rows that it prints for the test. Needs the standard library only."""

import json
import sys


class Job:
    """Attributes: fmu, identifier, token; step (s); inputs: their values, one row per communication point, those of row i
    set before the step that begins there; input_names, input_references; names, references of the variables asked for."""

    def __init__(self):
        self.__dict__.update(json.load(open(sys.argv[1])))

    def row(self, values):
        """Prints the values at a communication point, exactly."""
        print("row", *(float(x).hex() for x in values), flush=True)
