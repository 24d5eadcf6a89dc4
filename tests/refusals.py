"""Messages of the program about invalid input."""

from frictionmap.command_line.cli import main


def refusal(capsys, *arguments):
    """The one line on standard error of a command that is refused."""
    assert main([str(argument) for argument in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err
