# What is current: decided by content, before Snakemake looks at times (CONTRIBUTING.md, "What is done again").
import atexit
import logging
import os
import shutil

from snakemake.logging import logger
from snakemake.persistence import PersistenceBase
from snakemake.settings.enums import RerunTrigger
from snakemake.settings.types import DAGSettings, SchedulingSettings
from snakemake_interface_logger_plugins.common import LogEvent

from bladeroot import runs, statement
from bladeroot.runs import system_fault

# Snakemake's own checksums of inputs only prevent jobs, whichever profile is used: files whose content is
# another count as the same where a record says so. Contents are compared here.
DAGSettings.max_checksum_file_size = property(lambda _: 0, lambda *_: None)
# Nor does `rerun-triggers: mtime` of somebody's own profile hide changed settings and code.
DAGSettings.rerun_triggers = property(lambda _: RerunTrigger.all(), lambda *_: None)
# A limit of jobs a second is for a cluster. Here each choice of jobs would wake the scheduler every second from
# then on, and the run would wait a second for that at its end.
SchedulingSettings.max_jobs_per_timespan = property(
    lambda asked: None if workflow.local_exec else vars(asked)["limit"],
    lambda asked, limit: vars(asked).update(limit=limit),
)

# No parameter here is a table: pandas, an eighth of a plan's time, is not loaded to ask whether one is.
PersistenceBase._serialize_param_pandas = PersistenceBase._serialize_param_builtin

RESULTS = Path("results")
CONTENTS = statement.Contents(Path(".snakemake") / "bladeroot_contents.json")


def refuse_what_is_no_folder():
    """End in a line where a file, or a link to nowhere, stands in a folder's place, or one folder in two."""
    names = (*CAMPAIGNS, "structures", "bench", "logs", "benchmarks", statement.FOLDER)
    usual = Path(".snakemake")
    inside = [one for name in names[-3:] for one in RESULTS.glob(f"{name}/*")]
    seen = {}
    for place in (
        usual,
        RESULTS,
        usual / "bladeroot_runs",
        *map(RESULTS.joinpath, names),
        *inside,
    ):
        fault = ""
        if os.path.lexists(place) and not place.is_dir():
            fault = "must be a folder; move away what is there"
        elif (other := seen.setdefault(place.resolve(), place)) != place:
            fault = (
                f"leads to {other}; two stages' or campaigns' results need two folders"
            )
        if fault:
            print(f"bad input: {place} {fault}", file=sys.stderr)
            sys.exit(1)


def keep_records_with_results():
    """Snakemake's records of parameters and inputs travel with the results, and outlive .snakemake."""
    kept, usual = (
        RESULTS / statement.FOLDER / "snakemake",
        Path(".snakemake") / "metadata",
    )
    kept.parent.mkdir(parents=True, exist_ok=True)
    usual.parent.mkdir(exist_ok=True)
    if usual.is_dir() and not usual.is_symlink():
        if kept.is_dir():
            shutil.rmtree(usual)  # a copy that followed the link
        else:
            usual.rename(kept)
    kept.mkdir(exist_ok=True)
    led = Path("..") / kept
    if not usual.is_symlink() or usual.readlink() != led:
        usual.unlink(missing_ok=True)
        usual.symlink_to(led)


def tell_other_folders():
    """Results of another campaign folder of the same name, which this run replaces."""
    stated = statement.statements(RESULTS, "report")
    for place in {Path(path).parent for one in stated for path in one["inputs"]}:
        campaign = CAMPAIGNS.get(place.name)
        other = campaign and (place / "campaign.yaml").is_file()
        if other and not campaign.folder.samefile(place):
            print(
                f"warning: results/{place.name} are those of {place}, and become those of {campaign.folder}",
                file=sys.stderr,
            )


def settle():
    """Have the times of outputs say what their statements say."""
    late = statement.settle(RESULTS, CONTENTS)
    for path, why in list(late.items())[:3]:
        print(f"not current: {path}: {why}", file=sys.stderr)
    if len(late) > 3:
        print(f"not current: {len(late) - 3} more (bladeroot check)", file=sys.stderr)


class Stated(logging.Handler):
    """Writes a job's statement as it ends, if its inputs are then what they were as it began."""

    def __init__(self):
        super().__init__(logging.INFO)
        self.jobs, self.began = {}, {}

    def job(self, number):
        if number not in self.jobs:
            self.jobs = {job.jobid: job for job in workflow.dag.jobs}
        return self.jobs[number]

    def emit(self, record):
        event = getattr(record, "event", None)
        if event == LogEvent.JOB_STARTED:
            for number in record.jobs:
                self.began[number] = {
                    file: statement.identity(file) for file in self.read(number)
                }
        elif event == LogEvent.JOB_FINISHED:
            self.state(record.job_id)

    def read(self, number):
        return [str(file) for file in self.job(number).input]

    def state_rest(self):
        """Those whose end is told to nobody: Snakemake's --quiet."""
        if self.began:
            for job in workflow.dag.finished_jobs:
                if job.jobid in self.began:
                    self.state(job.jobid)

    def state(self, number):
        job, began = self.job(number), self.began.pop(number, {})
        if not job.log:
            return
        inputs = {
            file: (
                CONTENTS.of(file)
                if statement.identity(file) == began.get(file)
                else statement.UNSURE
            )
            for file in self.read(number)
        }
        place = (
            RESULTS / statement.FOLDER / Path(job.log[0]).relative_to("results/logs")
        )
        try:
            statement.state(
                place.with_suffix(".json"),
                job.rule.name,
                inputs,
                {str(file): CONTENTS.of(file) for file in job.output},
                list(map(str, job.non_derived_params)),
                dict(workflow.config_settings.config),
            )
        except (ValueError, OSError) as error:
            print(f"{place}: {error}; its job is done again", file=sys.stderr)


STATED = Stated()


def as_one_line(record):
    """Of what the system refuses (no space, no right) Snakemake's log has the reason, not where in its code."""
    fault = system_fault(record.getMessage())
    if fault:
        record.msg, record.args, record.exc_info = fault, (), None
    return True


def begin():
    """Sign in, tidy up after dead runs, and settle what is current."""
    run = runs.Run()
    if workflow.dryrun:
        if run.alone():
            settle()
        return None
    alone = run.begin(lambda line: print(line, file=sys.stderr))
    atexit.register(run.end)
    atexit.register(CONTENTS.keep)
    if alone:
        runs.remove_what_is_left()
        settle()
    else:
        print(
            "another run is at work here, or was when its machine went: what is current is told by times alone"
            f" (signs: {Path('.snakemake') / 'bladeroot_runs'})",
            file=sys.stderr,
        )
    logger.addHandler(STATED)
    return run


logger.addFilter(as_one_line)
logging.raiseExceptions = False  # a log that has no room is no fault of the run

# With a storage plugin results are elsewhere, and Snakemake decides by itself.
RUN = None
if workflow.is_main_process and not workflow.storage_settings.default_storage_prefix:
    refuse_what_is_no_folder()
    tell_other_folders()
    keep_records_with_results()
    RUN = begin()
elif not workflow.is_main_process:
    # A cluster job's own Snakemake outlives a killed run, and sets its outputs' times after the stage.
    runs.work()
