"""Code between backticks in the text of a page, in Markdown."""

from cranktopo.report.result_table import escaped, escaped_prose


def test_code_stays_code_and_all_else_is_shown_as_it_is() -> None:
    """Backslashes before backticks were seen on the page of `accuracy`."""
    assert escaped_prose("That of `evaluate_x` is 2 * 3.") == r"That of `evaluate_x` is 2 \* 3."
    assert escaped_prose("one ` alone\n_x_") == r"one \` alone \_x\_"
    assert escaped_prose("1. no list") == escaped("1. no list")
    assert escaped_prose("no code | here") == escaped("no code | here")
