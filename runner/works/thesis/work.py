"""The work: the thesis on Macro-Mini control."""

from runner.works.thesis.caveats import EXPECTED
from runner.works.thesis.dynamics_benchmark import measure_into
from runner.works.thesis.plan import plan
from runner.works.thesis.report import document
from runner.works.work import Work

WORK = Work(plan, document, EXPECTED, measure=measure_into)
