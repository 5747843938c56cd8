"""The report: one file a section, each turns Datasets into prose, tables and figures.

In: the Datasets of all stages and what the campaign says. Out: pages (`page`). Read `contents`
first, which lists the chapters and calls most figures; `front` is the first page, and `verdict`
has the words of the verdict for all places that show it. What a figure shows is changed in
`figures`.
"""
