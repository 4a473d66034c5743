#!/usr/bin/env python3
"""Prints how long a page takes to open, and how fast it plays.

    measure_page.py viewer.html…
"""
import pathlib
import sys

from devtools import Browser

FRAMES_PER_SECOND = """(async () => {
  document.querySelector('#speed').value = '0';
  dcemViewer.seek(0);
  dcemViewer.play(true);
  const drawn = dcemViewer.drawn, start = performance.now();
  await new Promise((done) => setTimeout(done, 3000));
  dcemViewer.play(false);
  return (dcemViewer.drawn - drawn) / (performance.now() - start) * 1000;
})()"""


def measure(path):
    with Browser(1280, 820) as browser:
        seconds = browser.open(path)
        megabytes = pathlib.Path(path).stat().st_size / 1e6
        print(f"{path}: {megabytes:.1f} MB, opened in {seconds:.2f} s")
        if browser.evaluate("dcemViewer.data.frameCount") < 2:
            return
        before_s, drawn = browser.cpu_seconds(), browser.evaluate("dcemViewer.drawn")
        rate = browser.evaluate(FRAMES_PER_SECOND)
        processor_s = (browser.cpu_seconds() - before_s) / (browser.evaluate("dcemViewer.drawn") - drawn)
        print(f"  plays at {rate:.0f} frames per second, {1e3 * processor_s:.0f} ms of processor time per frame")


if __name__ == "__main__":
    for page in sys.argv[1:]:
        measure(page)
