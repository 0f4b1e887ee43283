from runner.commands.columns import aligned


def test_columns_are_aligned():
    assert aligned([["a", "long"], ["longer", "b"]]) == "  a       long\n  longer  b"


def test_no_cell_speaks_to_the_terminal():
    assert aligned([["robot.name", "\x1b]0;title\x07", "two\nlines"]]) == r"  robot.name  \x1b]0;title\x07  two\nlines"
