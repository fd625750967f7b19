"""Runs a job in ecospy. Values set before a step are those of its beginning; the initial ones go through a parameter set too."""

from job import Job
from ecospy import EcosSimulation, EcosSimulationStructure
from ecospy.EcosParameterSet import EcosParameterSet

job = Job()
with EcosSimulationStructure() as structure, EcosParameterSet() as start:
    structure.add_model("pad", job.fmu)
    for name, value in zip(job.input_names, job.inputs[0]):
        start.add_real(f"pad::{name}", value)
    structure.add_parameter_set("start", start)
    with EcosSimulation(structure=structure, step_size=job.step) as simulation:
        assert simulation.init(parameter_set="start")
        job.row(simulation.get_real(f"pad::{name}") for name in job.names)
        for inputs in job.inputs[:-1]:
            for name, value in zip(job.input_names, inputs):
                simulation.set_real(f"pad::{name}", value)
            simulation.step()
            job.row(simulation.get_real(f"pad::{name}") for name in job.names)
        simulation.terminate()
