# What a job asks a cluster for: the one table. A local run does not limit itself by it.

# A job on a node runs a Snakemake of its own beside the stage's process: 150 to 165 MB (10,000 records).
SNAKEMAKE_MB = 200

# Of each stage: MB and minutes, and how many MB more for 1,000 input files and for each MB of the largest
# one. MB: measured (results/timings.csv), and half as much again; minutes: many times the measured, for a
# node that is slow or shared. What was not measured stands as its like does.
NEEDS = {
    "accuracy": (1400, 20, 0, 0),
    # a user's matrices: their factors hold many times what the files do
    "assembly_reduced": (1100, 60, 0, 20),
    "amplitude": (600, 30, 500, 0),
    "bench": (500, 20, 0, 0),
    "calibrate": (2000, 120, 0, 0),
    "checks": (1100, 20, 0, 0),
    "curves": (300, 10, 500, 0),
    # covariances between records: 200 MB for 112, 1,360 for 1,000
    "diagnosis": (1000, 30, 0, 10),
    "export": (1100, 10, 0, 10),
    "export_assembly": (1100, 10, 0, 10),
    "export_tables": (300, 10, 500, 0),
    "extended_joint": (400, 30, 0, 0),
    "extended_nonlinear": (600, 30, 0, 0),
    "extended_structure": (600, 20, 0, 0),
    "fe_forces": (300, 5, 0, 0),
    "frequency_maps": (400, 20, 0, 0),
    "integrity": (400, 10, 200, 0),
    "joint": (400, 30, 0, 0),
    "ledger": (500, 10, 0, 0),
    # a user's matrices: their factors hold many times what the files do
    "matrices_accuracy": (1400, 60, 0, 20),
    "matrices_checks": (1100, 60, 0, 20),
    "matrices_mesh": (400, 10, 0, 10),
    "matrices_reduced": (1100, 60, 0, 20),
    "nonlinear": (600, 30, 0, 0),
    "observations": (300, 10, 500, 0),
    "parametric": (600, 20, 0, 0),
    "paraview": (1100, 10, 0, 20),
    "reduced": (1100, 10, 0, 0),
    "report": (700, 10, 300, 0),
    # a record at a time, of two bytes a sample or more
    "ringdown": (600, 20, 0, 40),
    "score": (300, 5, 500, 0),
    "search": (300, 10, 0, 0),
    "shapes": (800, 10, 0, 0),
    "shortfall": (600, 10, 0, 0),
    "slider": (500, 10, 0, 0),
    "stick": (300, 10, 500, 0),
    "stiffness": (300, 5, 0, 0),
    "theory": (300, 5, 0, 0),
    "thesis_search": (300, 10, 0, 0),
    "verdict": (100, 5, 0, 0),
}


# Which of the jobs that could run goes first: what the longest chain waits for (structure, bench, records,
# inference with curves, and the report), then short ones that wait for each other (fe_forces to theory)
# and the long ones, so that none is left alone at the end.
PRIORITY = {
    "reduced": 50,
    "parametric": 40,
    "bench": 30,
    "ringdown": 30,
    "stick": 30,
    "integrity": 30,
    "observations": 30,
    "amplitude": 30,
    "diagnosis": 28,
    "fe_forces": 25,
    "search": 25,
    "stiffness": 25,
    "theory": 25,
    "joint": 20,
    "accuracy": 10,
    "checks": 10,
    "slider": 10,
}


# Seconds each, whatever the number of records: a place in a queue costs more than they do.
localrules:
    fe_forces,
    ledger,
    stiffness,
    theory,
    verdict,


def megabytes(path):
    """Size of an input file; those that are still to be made count when they are there."""
    return os.path.getsize(path) / 1e6 if os.path.isfile(path) else 0.0


def needs(stage):
    """Memory and time of a stage's job, doubled each time that it is asked for again."""
    base, minutes, for_files, for_size = NEEDS[stage]

    def mem_mb(wildcards, input, attempt):
        largest = max(map(megabytes, input), default=0.0) if for_size else 0.0
        asked = SNAKEMAKE_MB + base + for_files * len(input) / 1000 + for_size * largest
        return round(asked * 2 ** (attempt - 1))

    def runtime(wildcards, input, attempt):
        # what reads a thousand files takes some minutes on a slow disk
        return round((minutes + 5 * len(input) / 1000) * 2 ** (attempt - 1))

    return {"mem_mb": mem_mb, "runtime": runtime}
