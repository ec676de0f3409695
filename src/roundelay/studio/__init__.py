"""The studio: a local web application in which takes become loops, and the work it leaves.

::

    work.py       what a person decided of a take: a file that opens again
    making.py     from the work to its loops, with or without a browser
    export.py     loops, records, importers of an engine as one zip
    words.py      the command and the Python that repeat the work
    takes.py      a take as the browser shows it
    analyst.py    the process that reads and searches, with limits
    folder.py     the folder that holds takes and work
    server.py     what the browser may ask for
    client/       what runs in the browser
"""

from roundelay.studio.work import Part, Work, read_work

__all__ = ["Part", "Work", "read_work"]
