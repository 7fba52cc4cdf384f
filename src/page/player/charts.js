// A film's plots: what they show where one points, and a cursor there.

import { clock, numeral } from "./values.js";

export class Charts {
  /**
   * @param {any} film
   * @param {import("./reel.js").Reel} reel
   */
  constructor(film, reel) {
    this.reel = reel;
    this.time = reel.numbers[film.time];
    this.duration = film.duration;
    this.frames = reel.frames;
    /** @type {any[]} */
    this.charts = film.charts;
    /** @type {{chart: any, frame: number} | null} */
    this.cursor = null;
  }

  /** The chart over time at a place of the page. */
  at(x, y) {
    return this.charts.find((c) => c.time && x >= c.left - 12 && x <= c.right + 12 && y >= c.top - 12 && y <= c.bottom + 12);
  }

  /** The frame that a place of a chart is of: the last one up to its time. */
  frame_at(chart, x) {
    const time = chart.first + ((x - chart.left) / (chart.right - chart.left)) * (chart.last - chart.first);
    let low = 0,
      high = this.frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time.at(middle) <= time + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Words on all lines of a chart in a frame. */
  words(chart, frame) {
    return [`t = ${clock(this.time.at(frame), 3, this.duration)}`].concat(
      chart.lines.map(
        (/** @type {any} */ line) =>
          `${line.name} = ${numeral(this.reel.numbers[line.number].at(frame), line.within)}${line.unit ? " " + line.unit : ""}`,
      ),
    );
  }

  /**
   * @param {CanvasRenderingContext2D} c in page units
   * @param {string} color
   */
  draw(c, color) {
    if (!this.cursor) return;
    const { chart, frame } = this.cursor,
      time = this.time.at(frame);
    const x = chart.left + ((time - chart.first) / (chart.last - chart.first)) * (chart.right - chart.left);
    c.lineWidth = 1.5;
    c.lineCap = "butt";
    c.strokeStyle = color;
    c.setLineDash([6, 5]);
    c.beginPath();
    for (const each of this.charts) {
      if (!each.time || each.left !== chart.left) continue;
      c.moveTo(x, each.top);
      c.lineTo(x, each.bottom);
    }
    c.stroke();
    c.setLineDash([]);
    for (const each of this.charts) {
      if (!each.time || each.left !== chart.left) continue;
      for (const line of each.lines) {
        const v = this.reel.numbers[line.number].at(frame);
        if (!(v >= each.low && v <= each.high)) continue;
        c.beginPath();
        c.arc(x, each.bottom - ((v - each.low) / (each.high - each.low)) * (each.bottom - each.top), 5, 0, 2 * Math.PI);
        c.fillStyle = line.color;
        c.fill();
      }
    }
  }
}
