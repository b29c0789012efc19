"""The page in a real browser: while a run plays and afterwards, its report, a phone, the dark.

Usage: browser.py RATETABLE FOLDER
Prints {"checked": [...]}; a check that fails is an error. Pictures are left in the folder.
"""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

from webdriver import Browser

SHOWN = "window.ratetable.shown"


def csv(path):
    header, *rows = (line.split(",") for line in path.read_text().splitlines())
    return {int(row[0]): dict(zip(header, map(float, row))) for row in rows}


def start(ratetable, *arguments):
    """A run that is shown: the process and where."""
    run = subprocess.Popen([ratetable, *arguments, "--live=0"], stderr=subprocess.PIPE, text=True)
    for line in run.stderr:
        if found := re.match(r"live: (\S+)", line):
            return run, found[1]
    raise AssertionError(f"no address: {run.wait()}")


def rotation(w, x, y, z):
    """Of a body by a quaternion, row by row (any textbook)."""
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def apart(a, b):
    return max(abs(p - q) for row, other in zip(a, b) for p, q in zip(row, other))


def quiet(browser, where):
    """Nothing was complained of, and nothing asked elsewhere."""
    assert not (said := browser.complaints()), said
    own = (where, where.replace("http", "ws", 1), "data:", "chrome:", "about:")
    strange = [url for url in browser.fetched() if not url.startswith(own)]
    assert not strange, strange


def while_it_plays(browser, ratetable, folder):
    run, url = start(ratetable, "run", "table-1", "--for", "10s", "--out", str(folder / "run"))
    browser.open(url)
    browser.until(f"{SHOWN}.t > 3 && {SHOWN}.estimate && {SHOWN}.sensors.every(s => s.last)")
    seen = []
    for _ in range(8):
        before = browser.run(f"return {SHOWN}.drawn")
        browser.until(f"{SHOWN}.drawn > {before + 3}")
        seen.append(browser.run(f"return {SHOWN}"))
    browser.picture(folder / "live.png")
    # Paused, the view stays where it is while the run goes on; then it follows again.
    browser.press(" ")
    held = browser.until(f"{SHOWN}.paused && {SHOWN}.t")
    browser.until("window.ratetable.store.t > " + str(held + 0.5))
    assert browser.run(f"return {SHOWN}.t") == held
    browser.press(" ")
    browser.until(f"!{SHOWN}.paused && {SHOWN}.t > {held}")
    browser.press("1")
    browser.until(f"!{SHOWN}.sensors[0].visible")
    browser.press("1")
    wide = browser.run(f"return {SHOWN}.window_s")
    browser.press("-")
    browser.until(f"{SHOWN}.window_s != {wide}")
    told = run.communicate()[1]
    # On a busy machine the demonstration's reader may be late, and then samples are lost and told.
    assert run.returncode in (0, 1), told
    browser.until("document.querySelector('[data-figure=\"attitude by vqf\"]')")
    browser.picture(folder / "ended.png")
    quiet(browser, url)
    return seen


def numbers_agree(browser, folder, seen):
    report = json.loads((folder / "run/report.json").read_text())
    value = lambda name: browser.run("return document.querySelector(arguments[0]).textContent", name)
    rms = value('[data-figure="attitude by vqf"]')
    assert f"{report['attitude']['rms_deg']:.4g}" in rms, (rms, report["attitude"])
    late = value('[data-figure="gyro late, p99"]')
    assert f"{report['sensors'][0]['late_us']['p99']:.4g}" in late, (late, report["sensors"][0])
    text = browser.run("return document.body.textContent")
    for sensor in report["sensors"]:
        assert str(sensor["made"]) in text, sensor
    assert str(report["links"][0]["bytes"]) in text
    truth, gyro, estimate = (csv(folder / f"run/{name}.csv") for name in ("truth", "gyro", "estimate"))
    for shown in seen:
        body = shown["truth"]
        # Truth is drawn where the newest is; the dataset has it at every tick, each of a millisecond.
        row = truth[min(truth, key=lambda t: abs(t - (shown["t"] - body["age_s"]) * 1e9))]
        drawn = rotation(row["qw"], row["qx"], row["qy"], row["qz"])
        # At 20 deg/s a body turns 0.7 mrad in 2 ms, which is how far apart the times may be.
        assert apart(body["rotation"], drawn) < 8e-3, (shown["t"], body, row)
        assert apart(rotation(*body["q"]), body["rotation"]) < 1e-9, "what is drawn is what is told"
        held = (shown["t"] - shown["estimate"]["age_s"]) * 1e9
        told = estimate[min(estimate, key=lambda t: abs(t - held))]
        drawn = rotation(told["qw"], told["qx"], told["qy"], told["qz"])
        assert apart(shown["estimate"]["rotation"], drawn) < 1e-3, (shown["t"], shown["estimate"], told)
        last = shown["sensors"][0]["last"]
        t = round(last["t"] * 1e9)
        # A point of the strip is a stretch of ten milliseconds that begins with this reading.
        of = [gyro[k] for k in range(t, t + 10_000_000, 1_000_000) if k in gyro]
        for axis, middle, true in zip("xyz", last["values"], last["true"]):
            read = [math.degrees(row[f"{axis}_rad_s"]) for row in of]
            assert min(read) - 1e-4 <= middle <= max(read) + 1e-4, (t, axis, middle, read)
            assert abs(math.degrees(gyro[t][f"true_{axis}_rad_s"]) - true) < 1e-4, (t, axis, true)
    turned = apart(seen[0]["truth"]["rotation"], seen[-1]["truth"]["rotation"])
    assert turned > 1e-2, "it turns"


def report_plays(browser, folder):
    page = folder / "run/report.html"
    assert page.stat().st_size < 5_000_000, page.stat().st_size
    where = page.as_uri()
    browser.open(where)
    browser.until(f"{SHOWN}.truth && document.querySelector('input[type=range]')")
    scene = csv(folder / "run/truth.csv")
    for t in (2.5, 5.0, 8.75):
        browser.run("""const slider = document.querySelector('input[type=range]');
            const [low, high] = [Number(slider.min), Number(slider.max)];
            slider.value = low + (high - low) * arguments[0] / 10;
            slider.dispatchEvent(new Event('input', {bubbles: true}));""", t)
        browser.until(f"Math.abs({SHOWN}.t - {t}) < 0.1")
        shown = browser.run(f"return {SHOWN}")
        row = scene[min(scene, key=lambda k: abs(k - shown["t"] * 1e9))]
        drawn = rotation(row["qw"], row["qx"], row["qy"], row["qz"])
        assert apart(shown["truth"]["rotation"], drawn) < 1e-2, (t, shown["truth"], row)
    browser.picture(folder / "report.png")
    for width, height, name in ((360, 740, "phone"), (800, 600, "small"), (1920, 1080, "large")):
        browser.resize(width, height)
        browser.until(f"innerWidth == {width}")
        over = browser.run("return document.documentElement.scrollWidth - innerWidth")
        assert over <= 1, (name, over)
        browser.picture(folder / f"{name}.png")
    quiet(browser, where)


def in_the_dark(ratetable, folder):
    bright = "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).slice(0, 3).reduce((a, b) => a + +b, 0)"
    with Browser(dark=True) as dark:
        dark.open((folder / "run/report.html").as_uri())
        dark.until(f"{SHOWN}.truth")
        assert dark.run(f"return {bright}") < 200
        dark.picture(folder / "dark.png")
        assert not (said := dark.complaints()), said


def names_cannot_act(browser, ratetable, folder):
    scene = folder / "hostile.toml"
    scene.write_text('name = "<img src=x onerror=alert(1)></script><script>window.bad = 1</script>"\n'
                     'duration = "1 s"\n[gyro]\nrate = "10 Hz"\n')
    out = folder / "hostile"
    made = subprocess.run([ratetable, "run", str(scene), "--to", "mpu@file:/dev/null", "--out", str(out)],
                          stderr=subprocess.PIPE, text=True)
    assert made.returncode == 0, made.stderr
    browser.resize(1280, 720)
    browser.open((out / "report.html").as_uri())
    browser.until(f"{SHOWN}.truth")
    assert browser.run("return [window.bad === undefined, document.images.length]") == [True, 0]
    assert "<img src=x" in browser.run("return document.body.textContent")
    assert not (said := browser.complaints()), said


def studies_answer(browser, ratetable, folder):
    out = folder / "study"
    made = subprocess.run([ratetable, "study", "accuracy", "--quick", "--out", str(out)], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    browser.open((out / "report.html").as_uri())
    browser.until("document.querySelectorAll('canvas, svg').length > 3")
    browser.picture(folder / "study.png")
    text = browser.run("return document.body.textContent")
    assert "polynomial-fit" in text and "ns" in text, text[:500]
    assert not (said := browser.complaints()), said


def main(ratetable, folder):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with Browser() as browser:
        seen = while_it_plays(browser, ratetable, folder)
        numbers_agree(browser, folder, seen)
        report_plays(browser, folder)
        names_cannot_act(browser, ratetable, folder)
        studies_answer(browser, ratetable, folder)
    in_the_dark(ratetable, folder)
    print(json.dumps({"checked": ["live", "numbers", "report", "names", "study", "dark"]}))


if __name__ == "__main__":
    main(*sys.argv[1:])
