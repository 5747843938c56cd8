# Beam and slots joined at one axial force (5.1), and the frequencies of the joint as a map of kn, kt.


rule assembly:
    input:
        reduced=rules.reduced.output.reduced,
    output:
        assembly="results/structures/{structure}/assembly/{force}.nc",
    log:
        "results/logs/assembly/{structure}/{force}.log",
    benchmark:
        "results/benchmarks/assembly/{structure}/{force}.tsv"
    threads: 1
    params:
        code=code("assembly"),
    message:
        "assembly of {wildcards.structure} at {wildcards.force} N (5.1)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/assembly.py --reduced {input.reduced:q} --force {wildcards.force}"
        " --output {output.assembly} > {log} 2>&1"


rule frequency_map:
    input:
        assembly=rules.assembly.output.assembly,
    output:
        map="results/structures/{structure}/map/{force}.nc",
    log:
        "results/logs/frequency_map/{structure}/{force}.log",
    benchmark:
        "results/benchmarks/frequency_map/{structure}/{force}.tsv"
    threads: 1
    params:
        code=code("frequency_map"),
    message:
        "frequencies of {wildcards.structure} over (kn, kt) at {wildcards.force} N (5.4-5.7)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/frequency_map.py --assembly {input.assembly:q}"
        " --output {output.map} > {log} 2>&1"
