"""The audit as a report: counts, and one table of equations for each source with the runs of its wrong formulas."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

from runner import provenance
from runner.audit.audit import counts
from runner.audit.inventory import inventory
from runner.audit.rollout import Rollout, run_rollout
from runner.audit.sources import truth_of
from runner.audit.verdict import SAMPLES, VERDICTS, Judged
from runner.reporting.audit.equations import rolled_out, row
from runner.reporting.document import (
    Block,
    Curves,
    Document,
    Equations,
    Notice,
    Origin,
    Panel,
    Provenance,
    Section,
    Series,
    Table,
    Text,
)

COMMAND = "runner reproduce audit"


def audit_document(judged: Mapping[str, Sequence[Judged]]) -> Document:
    """Return the report on the audit.

    Args:
        judged: The verdicts of each source, by its name.
    """
    everything = [each for source in judged.values() for each in source]
    total = counts(everything)
    return Document(
        title="Equations of three published works, checked by machine",
        subtitle="Every printed equation against the arm's true kinematics and dynamics",
        abstract=(
            f"{len(everything)} equations were transcribed as they are printed and tried at {SAMPLES} random "
            f"configurations each. {total['correct']} are correct and {total['correct after repair']} more once damage "
            f"of the text is mended; {total['wrong as printed']} are wrong as printed, each with its right form below; "
            f"{total['unreadable']} can be read no more, and {total['definition']} only name things. Every verdict of "
            "wrong was found in two independent ways."
        ),
        sections=(
            Section("Counts", (_counts(judged), Text(_reading()), _inventory(judged))),
            *(_source(source, each) for source, each in judged.items()),
            Section("Provenance", (_provenance(),)),
        ),
        date=datetime.now(UTC).date().isoformat(),
    )


def _counts(judged: Mapping[str, Sequence[Judged]]) -> Table:
    rows = [[source, *map(str, counts(each).values()), str(len(each))] for source, each in judged.items()]
    total = counts([each for source in judged.values() for each in source])
    rows.append(["all", *map(str, total.values()), str(sum(total.values()))])
    return Table(
        "Equations of each source by verdict.",
        ["source", *VERDICTS, "all"],
        rows,
        tuple(range(1, len(VERDICTS) + 2)),
        Origin(command=COMMAND),
    )


def _reading() -> str:
    return (
        "A form is judged as it stands wherever it can be read, even where the text is more likely to be at fault "
        "than the author: we have the text of the three works as a machine read it, not their pages. It is repaired "
        "only where it cannot be read, or where a line is plainly damaged, and then the repair is stated and keeps "
        "every other sign; a wrong label, too, is judged as it stands unless those around it are plainly "
        "misread. Verdicts are worked out, not written down: the printed form, the repaired and the "
        "corrected one are evaluated at the same configurations and compared with the truth, once from Pinocchio's "
        "model or the like and once in a way that shares nothing with it but the arm's measures. The largest error is "
        "over all configurations and elements, the typical one the median over configurations of the largest "
        "element's."
    )


def _inventory(judged: Mapping[str, Sequence[Judged]]) -> Table:
    rows = []
    for source, each in judged.items():
        audited = [one.entry.place for one in each]
        for place in inventory(source).places:
            lost = ", ".join(place.lost) or "–"
            rows.append([source, place.place, str(len(place.equations)), str(audited.count(place.place)), lost])
    return Table(
        "Equations printed in each place of the text, and equations audited there; the last column names those that "
        "must have stood there and are missing from the text.",
        ["source", "place", "printed", "audited", "lost in the text"],
        [[cell.replace("$", "$$") for cell in line] for line in rows],
        (2, 3),
    )


def _source(source: str, judged: Sequence[Judged]) -> Section:
    ways = sorted({truth_of(source, each.entry.truth).ways for each in judged if each.entry.truth})
    blocks: list[Block] = [
        Notice("finding", "What is wrong, and why", inventory(source).found),
        Equations(f"Equations of the {source} source.", [row(each) for each in judged], Origin(command=COMMAND)),
        Table("Ways to what the equations claim to equal.", ["one way", "another"], ways),
    ]
    runs = tuple(_run(run_rollout(source, name)) for name in rolled_out(list(judged)))
    return Section(
        inventory(source).title,
        blocks,
        runs and (Section("What a robot does when it uses the wrong formulas", (), runs),),
    )


def _run(rollout: Rollout) -> Section:
    series = [Series(name, rollout.x, values) for name, values in rollout.curves.items()]
    panel = Panel("", rollout.x_label, rollout.y_label, series, y_log=rollout.logarithmic)
    figure = Curves(
        f"{rollout.title}: {rollout.y_label} over {rollout.x_label}.",
        [panel],
        columns=1,
        origin=Origin(command=COMMAND),
    )
    return Section(rollout.title, (Text(rollout.text), figure))


def _provenance() -> Provenance:
    return Provenance(
        (
            ("commit", provenance.commit() or "none (installed package)"),
            ("configurations", f"{SAMPLES}, seed 0"),
            ("machine", provenance.machine()),
            *provenance.versions().items(),
        )
    )
