"""The report: one file a section, each turns Datasets into prose, tables and figures."""
