// The noise of the image against the seconds of sampling, both on logarithmic axes.

const space = "http://www.w3.org/2000/svg";
const left = 46, right = 8, top = 8, bottom = 20;

/** An element of SVG. */
export const shape = (name, attributes = {}, ...children) => {
  const element = document.createElementNS(space, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
};

export const percent = share => `${+(100 * share).toPrecision(share < 0.0995 ? 2 : 3)} %`;
export const duration = s => s < 0.0995 ? `${+(1000 * s).toPrecision(2)} ms` : s < 100 ? `${+s.toPrecision(2)} s`
  : s < 6000 ? `${+(s / 60).toPrecision(2)} min` : `${+(s / 3600).toPrecision(2)} h`;

export class Curve {
  points = [];  // [seconds, samples, noise]
  #before = [];
  #run = null;
  #svg;

  constructor(svg) { this.#svg = svg; }

  /** The curve of a page that was opened late. */
  begin(run, points) {
    if (run === this.#run && points.length < this.points.length) return;
    this.#run = run, this.points = points;
    this.draw();
  }

  /** The samples began again: what was is drawn pale, for comparison. */
  add({ run, seconds, spp, noise }) {
    if (run !== this.#run) {
      if (this.points.length > 3) this.#before = this.points;
      this.#run = run, this.points = [];
      this.draw();
    }
    const last = this.points.at(-1), more = this.points.at(-2);
    if (!(noise > 0) || spp < 4 || (last && spp <= last[1])) return;
    if (more && spp < 1.15 * more[1]) this.points.pop();
    this.points.push([seconds, spp, noise]);
    this.draw();
  }

  /** Noise falls as one over the square root of the time: when it will be half of what it is. */
  forecast() {
    const last = this.points.at(-1);
    return last ? `${percent(last[2])} noise after ${duration(last[0])}; half of it after ${duration(4 * last[0])}` : "no estimate yet";
  }

  draw() {
    const svg = this.#svg, { width, height } = svg.getBoundingClientRect();
    if (width < 2) return;  // folded
    const all = [...this.points, ...this.#before];
    svg.setAttribute("aria-label", `Noise against time: ${this.forecast()}`);
    if (!all.length) return svg.replaceChildren(shape("text", { x: width / 2, y: height / 2, "text-anchor": "middle" }, "no estimate yet"));
    const range = (index, least) => {
      const logs = all.map(point => Math.log10(point[index]));
      const low = Math.floor(Math.min(...logs)), high = Math.ceil(Math.max(...logs));
      return [low, Math.max(high, low + least)];
    };
    const [x0, x1] = range(0, 2), [y0, y1] = range(2, 1);
    const x = seconds => left + (width - left - right) * (Math.log10(seconds) - x0) / (x1 - x0);
    const y = noise => top + (height - top - bottom) * (y1 - Math.log10(noise)) / (y1 - y0);
    const line = (points, name) => shape("path", { class: name, d: points.map((p, i) => `${i ? "L" : "M"}${x(p[0]).toFixed(1)} ${y(p[2]).toFixed(1)}`).join("") });
    const parts = [];
    for (let decade = x0; decade <= x1; ++decade) {
      const at = x(10 ** decade), anchor = decade === x1 ? "end" : "middle";
      parts.push(shape("line", { class: "grid", x1: at, x2: at, y1: top, y2: height - bottom }),
                 shape("text", { x: at, y: height - 6, "text-anchor": anchor }, decade < 0 ? `${10 ** (decade + 3)} ms` : `${10 ** decade} s`));
    }
    for (let decade = y0; decade <= y1; ++decade) {
      const at = y(10 ** decade);
      parts.push(shape("line", { class: "grid", x1: left, x2: width - right, y1: at, y2: at }),
                 shape("text", { x: left - 5, y: at + 4, "text-anchor": "end" }, percent(10 ** decade)));
    }
    if (this.#before.length) parts.push(line(this.#before, "before"));
    if (this.points.length) {
      const last = this.points.at(-1), [seconds, , noise] = last, end = Math.min(10 ** x1, seconds * (noise / 10 ** y0) ** 2);
      parts.push(line([last, [end, 0, noise * Math.sqrt(seconds / end)]], "ideal"), line(this.points, "now"),
                 shape("circle", { class: "dot", cx: x(last[0]), cy: y(last[2]), r: 3.5 }));
    }
    svg.replaceChildren(...parts);
  }
}
