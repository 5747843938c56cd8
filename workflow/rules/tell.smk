# What a person is told when a run ends.
import csv
import re
import subprocess
from contextlib import suppress


def tell_results():
    """Bad records, where the reports are, and the time of every rule (benchmark files)."""
    # of a storage plugin that is no folder of this machine nothing is told
    results = Path(workflow.storage_settings.default_storage_prefix or "", "results")
    if not results.is_dir():
        return
    write_timings(results)
    for name in CAMPAIGNS:
        page = (results / name / "report.html").resolve()
        tell_bad_records(results / name)
        if page.is_file():
            print(f"report of {name}: {page}")
    print(f"time of every rule: {results / 'timings.csv'}")


def tell_bad_records(campaign):
    """Rejected records, and those unlike their repeats, once both stages that tell are done."""
    stick, integrity = (campaign / f"{stage}.nc" for stage in ("stick", "integrity"))
    if stick.is_file() and integrity.is_file():
        log = campaign.parent / "logs" / "bad_records" / f"{campaign.name}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        # as a stage: this process has no library loaded that reads results
        with suppress(subprocess.CalledProcessError):  # its log says why
            shell(
                "{PYTHON:q} {SCRIPTS:q}/bad_records.py --stick {stick:q} --integrity {integrity:q}"
                " > {log} 2>&1"
            )
        print(log.read_text(encoding="utf-8"), end="")


def write_timings(results):
    """One row a rule: jobs, total and longest wall time in seconds, largest memory in MB."""
    stages = {}
    for file in sorted((results / "benchmarks").glob("*/**/*.tsv")):
        with file.open(newline="") as sheet:
            rows = list(csv.DictReader(sheet, delimiter="\t"))
        stages.setdefault(file.relative_to(results / "benchmarks").parts[0], []).extend(
            rows
        )
    lines = [("rule", "jobs", "total_s", "longest_s", "memory_MB")]
    for name, rows in stages.items():
        seconds = [float(row["s"]) for row in rows]
        memory = [
            float(row["max_rss"]) for row in rows if row["max_rss"] not in ("-", "NA")
        ]
        lines.append(
            (
                name,
                len(rows),
                round(sum(seconds), 1),
                round(max(seconds), 1),
                round(max(memory, default=0.0)),
            )
        )
    with open(results / "timings.csv", "w", newline="") as sheet:
        csv.writer(sheet, lineterminator="\n").writerows(lines)


def tell_failures(logs):
    """Each failed job with the last line of its log, and the command that continues."""
    logs = [logs] if isinstance(logs, str) else logs
    text = "".join(
        Path(log).read_text(errors="replace") for log in logs if Path(log).is_file()
    )
    for name, block in re.findall(r"Error in rule (\S+):\n((?:    .*\n)+)", text):
        output = re.search(r"output: (.*)", block)
        job_log = re.search(r"log: (\S+)", block)
        print(
            f"failed: {name} ({output.group(1) if output else 'no output'})",
            file=sys.stderr,
        )
        if job_log and Path(job_log.group(1)).is_file():
            lines = (
                Path(job_log.group(1)).read_text(errors="replace").strip().splitlines()
            )
            print(f"    {lines[-1] if lines else 'its log is empty'}", file=sys.stderr)
    print("finished stages are kept; the same command continues", file=sys.stderr)
