"""The work: the report on xArm7 path planning."""

from runner.works.work import Work
from runner.works.xarm7.caveats import EXPECTED
from runner.works.xarm7.plan import plan
from runner.works.xarm7.report import document

WORK = Work(plan, document, EXPECTED)
