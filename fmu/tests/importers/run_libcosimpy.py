"""Runs a job in libcosimpy (FMI 2), whose manipulator overrides the inputs before each step. Its observers see the start only
in hindsight: as the first sample of a time series."""

from job import Job
from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

job = Job()
execution = CosimExecution.from_step_size(step_size=round(1e9 * job.step))
pad = execution.add_local_slave(CosimLocalSlave(fmu_path=job.fmu, instance_name="pad"))
last, series = CosimObserver.create_last_value(), CosimObserver.create_time_series()
manipulator = CosimManipulator.create_override()
assert execution.add_observer(last) and execution.add_observer(series) and execution.add_manipulator(manipulator)
assert all(series.start_time_series(pad, reference, CosimVariableType.REAL) for reference in job.references)
for reference, value in zip(job.input_references, job.inputs[0]):
    assert execution.real_initial_value(pad, reference, value)
rows = []
for inputs in job.inputs[:-1]:
    assert manipulator.slave_real_values(pad, job.input_references, inputs)
    assert execution.step()
    rows.append(last.last_real_values(pad, job.references))
job.row(series.time_series_real_samples(pad, reference, from_step=0)[2][0] for reference in job.references)
for row in rows:
    job.row(row)
