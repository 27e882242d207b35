"""How does a command refuse what is wrong? With one line and exit code 2."""

import pytest


@pytest.fixture
def refused(capsys):
    """The line of the error with which a command's ``main`` refuses these arguments."""

    def line(main, *arguments):
        with pytest.raises(SystemExit) as stop:
            main([str(one) for one in arguments])
        assert stop.value.code == 2
        return capsys.readouterr().err.strip().splitlines()[-1]

    return line
