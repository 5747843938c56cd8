# The free decay, cut out of each raw record by itself.


def raw_record(wildcards):
    campaign = CAMPAIGNS[wildcards.campaign]
    if campaign.simulated:
        return rules.bench.output.raw
    row = next(r for r in campaign.records if r["record"] == wildcards.record)
    return campaign.folder / row["file"]


def record_facts(wildcards):
    """What is known of a record besides its samples."""
    campaign = CAMPAIGNS[wildcards.campaign]
    row = next(r for r in campaign.records if r["record"] == wildcards.record)
    modes = campaign.description["modes"]
    others = [modes[name]["expected_Hz"] for name in modes if name != row["mode"]]
    facts = {
        "other_modes_Hz": others,
        "simulated": campaign.simulated,
        "load_facts": load_facts(campaign.load),
    }
    return canonical_json({**row, **modes[row["mode"]], **facts})


rule record:
    input:
        raw=raw_record,
    output:
        record="results/{campaign}/records/{record}.nc",
    log:
        "results/logs/record/{campaign}/{record}.log",
    benchmark:
        "results/benchmarks/record/{campaign}/{record}.tsv"
    threads: 1
    params:
        facts=record_facts,
        settings=settings("record"),
        code=code("record"),
    message:
        "free decay of record {wildcards.record} of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/record.py --raw {input.raw:q} --facts {params.facts:q}"
        " --campaign {wildcards.campaign} --settings {params.settings:q}"
        " --output {output.record} > {log} 2>&1"
