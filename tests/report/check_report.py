"""Opens report.html of a short run in headless Chromium, without a network: no error, every chart drawn, every picture there.

usage: check_report.py PLIMSOLL CHROMIUM
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path


def dump(chromium, page):
    """The page after its scripts ran, and what they said."""
    command = [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--v=0"]
    # Names resolve nowhere: what a page needs from outside it does not get.
    command += ["--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=10000", "--dump-dom", page.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=180, check=True)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def main():
    plimsoll, chromium = sys.argv[1:3]
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        # A folder with a blank and a letter outside ASCII.
        out = Path(folder) / "Ergebnis für später"
        done = subprocess.run([plimsoll, "run", "dam_break_front", "--quiet", "--out", out], check=False, capture_output=True)
        # 3: at its end, but outside a limit.
        assert done.returncode in (0, 3), done.stderr
        text, console = dump(chromium, out / "report.html")
        charts = len(re.findall(r'<div id="chart-\d+"', text))
        drawn = len(re.findall(r'<div id="chart-\d+" class="[^"]*js-plotly-plot', text))
        # The library names addresses in its texts and never goes there.
        outside = re.sub(r"(<script[^>]*>).*?</script>", r"\1", text, flags=re.DOTALL)
        pictures = len(re.findall(r'<img src="data:image/png;base64,', text))
        checks = {
            f"{drawn} of {charts} charts are drawn": charts >= 5 and drawn == charts,
            f"{pictures} pictures: moments, end, animation": pictures == 3,
            f"the console is silent: {console[:3]}": not console,
            "nothing is asked of a network": not re.search(r'<(script|img|link)[^>]*="https?://', outside),
            "figures have verdicts": "within the limit" in text,
        }
    for what, passed in checks.items():
        print(f"{'ok  ' if passed else 'FAIL'} report: {what}")
        failures += [] if passed else [what]
    print(f"{len(checks) - len(failures)} passed, {len(failures)} failed")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
