"""Runs a job in fmuloader (FMI 3): its functions are those of the standard, so that every row is carried, the start included."""

from job import Job
from fmuloader.fmi3 import Fmi3Slave

job = Job()
pad = Fmi3Slave(job.fmu, model_identifier=job.identifier)
pad.instantiate_co_simulation("pad", instantiation_token=job.token)
pad.enter_initialization_mode(start_time=0.0)
pad.set_float64(job.input_references, job.inputs[0])
pad.exit_initialization_mode()
job.row(pad.get_float64(job.references))
for i, inputs in enumerate(job.inputs[:-1]):
    pad.set_float64(job.input_references, inputs)
    pad.do_step(i * job.step, job.step)
    job.row(pad.get_float64(job.references))
pad.terminate()
pad.free_instance()
