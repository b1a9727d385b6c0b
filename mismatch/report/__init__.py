"""The report: data to one self-contained page; nothing is computed here and no file is written."""
