"""Runs a job in fmuloader (FMI 3): its functions are those of the standard, so that every row is carried, the start included."""

from job import Job
from fmuloader.fmi3 import Fmi3Slave

job = Job()
pad = Fmi3Slave(job.fmu, model_identifier=job.identifier)
pad.instantiate_co_simulation("pad", instantiation_token=job.token)
pad.enter_initialization_mode(start_time=0.0)
for i, inputs in enumerate(job.inputs):
    pad.set_float64(job.input_references, inputs)
    if i:
        pad.do_step((i - 1) * job.step, job.step)
    else:
        pad.exit_initialization_mode()
    job.row(pad.get_float64(job.references))
pad.terminate()
pad.free_instance()
