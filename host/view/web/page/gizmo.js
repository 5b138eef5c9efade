// Handles that move, turn and scale what is selected.
import { shape } from "./curve.js";

const sum = (a, b, s = 1) => a.map((n, i) => n + s * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => a.map(n => n / Math.hypot(...a));
const colors = ["#ff5c5c", "#5fd35f", "#5a9bff"];
const world = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const reach = 92, farthestScale = 120;  // pixels

/** Returns a function from the world to CSS pixels of the box, or null for cameras without straight lines. */
const projector = (camera, box) => {
  const parallel = camera.projection === "orthographic";
  if (!parallel && camera.projection !== "perspective") return null;
  const forward = unit(sum(camera.target, camera.position, -1)), right = unit(cross(forward, camera.up)), up = cross(right, forward);
  const scale = box.height / (parallel ? camera.height : 2 * Math.tan(camera.fov * Math.PI / 360));
  return point => {
    const way = sum(point, camera.position, -1), depth = dot(way, forward), by = parallel ? scale : scale / depth;
    return { x: box.x + box.width / 2 + by * dot(way, right), y: box.y + box.height / 2 - by * dot(way, up), pixels: by, depth, forward, right, up };
  };
};

export class Gizmo {
  mode = "move";
  #svg;
  #link;
  #box;
  #drag = null;

  /** `box()` is where the image lies in the stage. */
  constructor(svg, link, box) {
    this.#svg = svg, this.#link = link, this.#box = box;
    svg.addEventListener("pointerdown", e => this.#begin(e));
    svg.addEventListener("pointermove", e => this.#move(e));
    for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, e => this.#end(e));
  }

  get isDragged() { return this.#drag !== null; }

  #axes(state) { return this.mode === "scale" && state.axes ? state.axes : world; }

  draw(state) {
    const project = state.pivot && state.steers && projector(state.camera, this.#box());
    const middle = project && project(state.pivot);
    if (!middle || !(middle.depth > 0)) return this.#svg.replaceChildren();
    const mode = state.light === null ? this.mode : "move", size = reach / middle.pixels;
    const parts = [];
    this.#axes(state).forEach((axis, i) => {
      const path = mode === "rotate" ? this.#ring(project, state.pivot, axis, size) : this.#arm(project, state.pivot, axis, size);
      const end = project(sum(state.pivot, axis, size));
      parts.push(shape("path", { d: path, fill: "none", stroke: "#000", "stroke-opacity": 0.45, "stroke-width": 5, "stroke-linecap": "round" }),
                 shape("path", { d: path, fill: "none", stroke: colors[i], "stroke-width": 2.5, "stroke-linecap": "round" }),
                 shape("path", { d: path, class: "handle", stroke: "transparent", "stroke-width": 16, "data-axis": i }));
      if (mode === "move") parts.push(shape("circle", { class: "tip", cx: end.x, cy: end.y, r: 5.5, fill: colors[i], stroke: "#0007" }));
      if (mode === "scale") parts.push(shape("rect", { class: "tip", x: end.x - 5, y: end.y - 5, width: 10, height: 10, fill: colors[i], stroke: "#0007" }));
    });
    const free = mode === "rotate" ? [] : [
      shape("circle", { cx: middle.x, cy: middle.y, r: 7, fill: "#fff", stroke: "#0009", "stroke-width": 1.5 }),
      shape("circle", { cx: middle.x, cy: middle.y, r: 8, class: "handle", stroke: "transparent", "stroke-width": 12, "data-axis": 3, "pointer-events": "all" })];
    this.#svg.replaceChildren(...parts, ...free);
  }

  #arm(project, pivot, axis, size) {
    const a = project(sum(pivot, axis, 0.12 * size)), b = project(sum(pivot, axis, size));
    return `M${a.x} ${a.y}L${b.x} ${b.y}`;
  }

  #ring(project, pivot, axis, size) {
    const side = unit(cross(axis, Math.abs(axis[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0])), other = cross(axis, side);
    const points = Array.from({ length: 49 }, (_, i) => {
      const angle = i * Math.PI / 24;
      return project(sum(sum(pivot, side, 0.9 * size * Math.cos(angle)), other, 0.9 * size * Math.sin(angle)));
    });
    return points.map((p, i) => `${i ? "L" : "M"}${p.x.toFixed(1)} ${p.y.toFixed(1)}`).join("");
  }

  #begin(e) {
    const axis = e.target.dataset?.axis;
    if (axis === undefined) return;
    e.preventDefault(), e.stopPropagation();
    this.#svg.setPointerCapture(e.pointerId);
    this.#drag = { axis: +axis, x: e.clientX, y: e.clientY };
    this.#link.send("hold", "on");
  }

  #move(e) {
    const drag = this.#drag, state = this.#link.state;
    if (!drag || !state.pivot) return;
    const box = this.#box(), project = projector(state.camera, box), middle = project(state.pivot);
    const way = { x: e.clientX - drag.x, y: e.clientY - drag.y };
    const mode = state.light === null ? this.mode : "move";
    if (drag.axis === 3) this.#free(mode, way, box);
    else this.#along(mode, this.#axes(state)[drag.axis], drag, way, middle, project, state);
    drag.x = e.clientX, drag.y = e.clientY;
  }

  #free(mode, way, box) {
    const factor = Math.exp((way.x - way.y) / farthestScale);
    if (mode === "scale") this.#link.send("scale", factor, factor, factor);
    else this.#link.send("drag", way.x / box.height, -way.y / box.height);
  }

  #along(mode, axis, drag, way, middle, project, state) {
    const end = project(sum(state.pivot, axis, reach / middle.pixels));
    const on = { x: (end.x - middle.x) / reach, y: (end.y - middle.y) / reach };
    const square = Math.max(on.x * on.x + on.y * on.y, 0.01), pixels = (way.x * on.x + way.y * on.y) / square;
    if (mode === "rotate") {
      const stage = this.#svg.getBoundingClientRect();
      const angle = (x, y) => Math.atan2(y - stage.y - middle.y, x - stage.x - middle.x);
      const turned = angle(drag.x + way.x, drag.y + way.y) - angle(drag.x, drag.y);
      const degrees = (((turned * 180 / Math.PI) + 540) % 360) - 180, faces = dot(axis, middle.forward) > 0 ? 1 : -1;
      this.#link.send("rotate", ...axis, faces * degrees);
    } else if (mode === "scale") {
      this.#link.send("scale", ...[0, 1, 2].map(i => i === drag.axis ? Math.exp(pixels / farthestScale) : 1));
    } else if (state.light !== null) {
      this.#link.send("light", state.light, ...axis.map(n => n * pixels / middle.pixels));
    } else {
      this.#link.send("move", ...axis.map(n => n * pixels / middle.pixels));
    }
  }

  #end() {
    if (!this.#drag) return;
    this.#drag = null;
    this.#link.send("hold", "off");
  }
}
