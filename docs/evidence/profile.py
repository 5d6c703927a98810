"""Where a program's time goes, by the innermost of some named functions, inlined or not.

    perf record -e cpu-clock -F 499 -o PERF.data PROGRAM …
    python3 docs/evidence/profile.py PERF.data PROGRAM NAME…

A sample counts for the first NAME that is found going from the innermost inlined function outwards; what has none counts
for `else`. Needs perf, addr2line and readelf.
"""

import collections
import re
import subprocess
import sys


def run(*command, text=None):
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def file_address(data, program):
    """What turns an address of the running program into one of its file; None outside of it."""
    maps = run("perf", "script", "-i", data, "--show-mmap-events")
    name = re.escape(program.rsplit("/", 1)[-1])
    start, length, offset = re.search(
        rf"\[0x([0-9a-f]+)\(0x([0-9a-f]+)\) @ (?:0x)?([0-9a-f]+) [^\]]*\]: r-xp [^\n]*{name}\n", maps
    ).groups()
    start, length, offset = int(start, 16), int(length, 16), int(offset, 16)
    load = re.search(r"LOAD +0x([0-9a-f]+) 0x([0-9a-f]+) .* R E ", run("readelf", "-lW", program)).groups()
    shift = offset - start - int(load[0], 16) + int(load[1], 16)
    return lambda ip: ip + shift if start <= ip < start + length else None


def main(data, program, *names):
    place = file_address(data, program)
    ips = collections.Counter(place(int(ip, 16)) for ip in run("perf", "script", "-i", data, "-F", "ip").split())
    inlined = collections.defaultdict(list)
    for line in run(
        "addr2line", "-e", program, "-f", "-i", "-C", "-a", text="\n".join(hex(ip) for ip in ips if ip)
    ).splitlines():
        if re.fullmatch(r"0x[0-9a-f]+", line):
            here = inlined[int(line, 16)]
        else:
            here.append(line.split("<")[0].split("::")[-1])
    counts = collections.Counter()
    for ip, n in ips.items():
        counts[next((f for f in inlined[ip][::2] if f in names), "else")] += n
    for name, n in counts.most_common():
        print(f"{100 * n / sum(counts.values()):5.1f} % {name}")


main(*sys.argv[1:])
