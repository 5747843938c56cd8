"""What a hostile case may end in: a result, or one line a fault that names where it is; in time."""

import signal
from contextlib import contextmanager
from html.parser import HTMLParser

LIMIT_S = 20.0
LONGEST = 1500  # signs of a line that a person still reads


@contextmanager
def in_time(limit_s=LIMIT_S):
    """Fail where the work does not end."""

    def late(*_):
        raise AssertionError(f"no answer within {limit_s:g} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, limit_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def answer(work, names, told=""):
    """The lines that the work ends in, [] for none; any exception but a ValueError is a failure.

    names: what each line must name, such as the file. told: what one of the lines must say.
    """
    text = None
    try:
        with in_time():
            work()
    except ValueError as error:
        text = str(error)
    if text is None:
        assert not told, f"expected to be told: {told}"
        return []
    lines = text.splitlines()
    assert lines, "an error without a word"
    for line in lines:
        assert line.strip(), lines
        assert len(line) <= LONGEST, line[:200]
        assert names in line, line
    assert told in text, text
    return lines


class Tags(HTMLParser):
    """All tags of a page with their attributes, and the texts of its scripts."""

    def __init__(self, page):
        super().__init__()
        self.seen, self.values, self.scripts = set(), [], []
        self._script = False
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.seen.add((tag, *(name for name, _ in attrs)))
        self.values += [value for _, value in attrs if value]
        self._script = tag == "script"

    def handle_endtag(self, tag):
        self._script = False

    def handle_data(self, data):
        if self._script:
            self.scripts.append(data)
