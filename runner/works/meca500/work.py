"""The work: the report on Meca500 calibration and force control."""

from runner.works.meca500.calibration_plan import calibration_jobs
from runner.works.meca500.caveats import EXPECTED
from runner.works.meca500.plan import plan
from runner.works.meca500.report import document
from runner.works.work import Work

WORK = Work(plan, document, EXPECTED, calibrations=calibration_jobs)
