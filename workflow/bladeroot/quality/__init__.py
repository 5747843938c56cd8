"""Whether a record can be trusted: one check a file in `findings`, judged together in `integrity`.

In: a recording and the decay cut from it. Out: the decay with its findings and the mask of usable
samples. Read `integrity` first; `examined` is what every check looks at: the samples of one record,
not its load (records are compared in `pooling`). `second_opinion` sets a curve by peak fitting
(`peak_fit`) beside a record's own, and `agreement` compares the two. A new check is a file of
`findings`, whose first page says what it must define; its threshold stands there.
"""
