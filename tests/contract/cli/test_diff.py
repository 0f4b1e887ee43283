"""`runner diff`, the former name of `runner compare`."""


def test_the_former_name_does_the_same_and_says_how_it_is_called_now(cli, copy_run):
    run = copy_run("goal")
    former, now = cli("diff", run, run), cli("compare", run, run)
    assert (former.code, former.out) == (0, now.out)
    assert (
        former.err == "runner: `runner diff` is now called `runner compare`; the old name goes with the next release\n"
    )
    assert now.err == ""
