"""Kinds of ring-downs as published data sets hold them, each from its own physics.

Each kind is a structure with a sensor and what the two do to a record: some equations of motion are
integrated, some laws of amplitude are followed as a slow flow, some modes are plain exponentials
(`motion`: motions and their truths). `kinds` draws the records. Nothing is shared with the library.
"""
