"""The one exception that means: the user's input is wrong, and here is the remedy."""


class InputError(Exception):
    """Bad input from outside: a file, a row, an option.

    The message is one line that names the file, row or option and says what to do. Commands print
    it on stderr and exit with 2; everything else that escapes is a defect of ours.
    """
