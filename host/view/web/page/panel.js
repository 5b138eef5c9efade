// The side panel: what is in the scene, and what can be changed.
import { Curve, percent, shape } from "./curve.js";

/** An element of HTML. Properties that begin with "on" are listeners. */
export const make = (name, properties = {}, ...children) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key in element && typeof value !== "string") element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children.filter(child => child !== null));
  return element;
};

const labels = { ior: "Index (IOR)", clearcoat: "Coat", clearcoat_roughness: "Coat roughness", specular_weight: "Specular" };
const label = name => labels[name] ?? name.replaceAll("_", " ").replace(/^./, letter => letter.toUpperCase());
const short = number => +(+number).toPrecision(4);
const unused = (name, number) => name || `${number}`;

// Colours are linear in the scene, and sRGB in the page (IEC 61966-2-1).
const encoded = x => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
const decoded = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
const hexOf = color => "#" + color.map(x => encoded(Math.min(Math.max(x, 0), 1)).toString(16).padStart(2, "0")).join("");
const colorOf = hex => [1, 3, 5].map(i => decoded(parseInt(hex.slice(i, i + 2), 16)));

// What each kind of material reads.
const base = ["albedo", "emission", "opacity"];
const readBy = {
  lambert: base, mirror: base, unlit: base,
  metal: [...base, "roughness"],
  glass: [...base, "roughness", "ior", "attenuation"],
  "blinn-phong": [...base, "specular", "shininess"],
  principled: [...base, "roughness", "metallic", "ior", "transmission", "clearcoat", "clearcoat_roughness", "specular_weight",
               "specular_tint", "sheen", "sheen_roughness", "anisotropy", "iridescence", "attenuation"],
};

let count = 0;

/** Inputs of one value. `set(value)` shows another; `change(value)` is called for each that the user chooses. */
class Slider {
  /** `curved`: positions are logarithmic, with 0 at the left. */
  constructor(link, text, least, most, change, { curved = false, step = 0.001 } = {}) {
    const id = `value-${++count}`;
    const toValue = p => curved ? (most - least + 1) ** p - 1 + least : least + p * (most - least);
    const toPlace = v => curved ? Math.log(Math.max(v - least, 0) + 1) / Math.log(most - least + 1) : (v - least) / (most - least);
    this.place = v => Math.min(Math.max(toPlace(v), 0), 1);
    this.range = make("input", { type: "range", id, min: "0", max: "1", step: `${step}`,
      onpointerdown: () => link.send("hold", "on"), onpointerup: () => link.send("hold", "off"), onpointercancel: () => link.send("hold", "off"),
      oninput: () => { const value = short(toValue(+this.range.value)); this.number.value = value; this.tell(value); change(value); } });
    this.number = make("input", { type: "number", step: "any", "aria-label": text,
      onchange: () => { const value = +this.number.value; if (this.number.value !== "" && Number.isFinite(value)) { this.set(value, true); change(value); } } });
    this.row = make("div", { class: "row" }, make("label", { for: id, title: text }, text), this.range, this.number);
  }
  tell(value) { this.range.setAttribute("aria-valuetext", `${value}`); }
  set(value, force = false) {
    if (!force && this.row.contains(document.activeElement) && this.row.matches(":active, :has(input[type=number]:focus)")) return;
    this.range.value = this.place(value), this.number.value = short(value), this.tell(short(value));
  }
}

/** A colour, with a strength where it may exceed 1. */
class Color {
  constructor(link, text, most, change) {
    const id = `value-${++count}`;
    this.color = [1, 1, 1], this.strength = 1;
    const tell = () => change(this.color.map(x => x * this.strength));
    this.input = make("input", { type: "color", id, onfocus: () => link.send("hold", "on"), onblur: () => link.send("hold", "off"),
      oninput: () => { this.color = colorOf(this.input.value); tell(); } });
    this.strong = most > 1 ? new Slider(link, `${text}, strength`, 0, most, value => { this.strength = value; tell(); }, { curved: true }) : null;
    const row = make("div", { class: "row wide" }, make("label", { for: id, title: text }, text), this.input);
    this.rows = this.strong ? [row, this.strong.row] : [row];
    if (this.strong) this.strong.row.querySelector("label").textContent = "Strength";
  }
  set(value) {
    if (document.activeElement === this.input) return;
    this.strength = this.strong ? Math.max(...value) : 1;
    if (!(this.strength > 0)) this.strength = 0;
    else this.color = value.map(x => x / this.strength);
    this.input.value = hexOf(this.strong ? this.color : value);
    if (!this.strong) this.color = value;
    this.strong?.set(this.strength);
  }
}

class Place {
  constructor(text, change) {
    this.inputs = ["X", "Y", "Z"].map(axis => make("input", { type: "number", step: "any", "aria-label": `${text} ${axis}`,
      onchange: () => { const values = this.inputs.map(input => +input.value); if (values.every(Number.isFinite)) change(values); } }));
    this.row = make("div", { class: "row wide" }, make("span", { class: "label" }, text), make("div", { class: "triple" }, ...this.inputs));
  }
  set(value) {
    this.inputs.forEach((input, i) => { if (document.activeElement !== input) input.value = short(value[i]); });
  }
}

const choice = (text, options, change) => {
  const id = `value-${++count}`;
  const select = make("select", { id, onchange: () => change(select.value) },
    ...options.map(([value, name]) => make("option", { value }, name)));
  return { select, row: make("div", { class: "row wide" }, make("label", { for: id }, text), select) };
};

const check = (text, change) => {
  const id = `value-${++count}`, input = make("input", { type: "checkbox", id, onchange: () => change(input.checked) });
  return { input, row: make("div", { class: "row wide" }, make("label", { for: id }, text), input) };
};

/** A list of which one row is selected; arrow keys go along it. */
class List {
  constructor(name, pick) {
    this.element = make("div", { class: "list", role: "listbox", "aria-label": name });
    this.pick = pick, this.rows = new Map();
    this.element.addEventListener("keydown", e => {
      const step = { ArrowDown: 1, ArrowUp: -1 }[e.key], rows = [...this.rows.values()], at = rows.indexOf(document.activeElement);
      if (!step || at < 0) return;
      e.preventDefault(), e.stopPropagation();
      rows[Math.min(Math.max(at + step, 0), rows.length - 1)].focus();
      document.activeElement.click();
    });
  }
  fill(items) {
    const signature = JSON.stringify(items);
    if (signature === this.signature) return;
    this.signature = signature;
    const focused = [...this.rows].find(([, row]) => row === document.activeElement)?.[0];
    this.rows = new Map(items.map(item => [item.key, make("button", { role: "option", "aria-selected": "false", title: item.name, tabIndex: -1, onclick: () => this.pick(item.key) },
      item.color ? swatch(item.color) : null, make("span", { class: "name" }, item.name), make("span", { class: "more" }, item.more))]));
    this.element.replaceChildren(...this.rows.values());
    this.select(this.selected);
    this.rows.get(focused)?.focus();
  }
  select(key) {
    const isNew = key !== this.selected;
    this.selected = key;
    let first = true;
    for (const [other, row] of this.rows) {
      row.setAttribute("aria-selected", `${other === key}`);
      row.tabIndex = other === key || (first && !this.rows.has(key)) ? 0 : -1;
      first = false;
    }
    const row = this.rows.get(key);
    if (!isNew || !row) return;
    const list = this.element, above = row.offsetTop - list.offsetTop;  // the panel itself stays where it is
    if (above < list.scrollTop || above + row.offsetHeight > list.scrollTop + list.clientHeight) list.scrollTop = above - list.clientHeight / 2;
  }
}

/** Of a lamp its light. */
const colorOfMaterial = m => m ? m.values.albedo.map((x, i) => Math.max(x, m.values.emission[i])) : [0, 0, 0];

const swatch = color => {
  const element = make("span", { class: "swatch" });
  element.style.background = hexOf(color);
  return element;
};

export class Panel {
  scene = null;

  constructor(root, link, actions) {
    this.root = root, this.link = link, this.actions = actions;
    this.plot = shape("svg", { id: "curve", role: "img" });
    this.curve = new Curve(this.plot);
    this.forecast = make("p", { class: "note" });
    this.objects = new List("Objects", key => link.send("object", key));
    this.materials = new List("Materials", key => link.send("edit", key));
    this.lights = new List("Lights", key => link.send("select", key));
    this.effects = make("div", { class: "body" });
    this.materialValues = make("div", { class: "body" });
    this.lightValues = make("div", { class: "body" });
    this.console = make("p", { class: "note", role: "log" });
    this.values = [];
    root.replaceChildren(
      this.#section("Noise", "", this.plot, this.forecast),
      this.#section("Picture", "", ...this.#picture()),
      this.objectSection = this.#section("Objects", "", this.objects.element, this.#history()),
      this.materialSection = this.#section("Materials", "", this.materials.element, this.materialValues),
      this.lightSection = this.#section("Lights", "", this.lights.element, this.lightValues),
      this.#section("Camera", "", ...this.#camera()),
      this.effectSection = this.#section("Effects and their cost", "", this.effects),
      this.#section("Files and commands", "", ...this.#files()));
    new ResizeObserver(() => this.curve.draw()).observe(this.plot);
  }

  #section(title, extra, ...body) {
    const count = make("span", { class: "count" }, extra);
    const fields = make("fieldset", { class: "body", "aria-label": title }, ...body);
    const details = make("details", { open: true }, make("summary", {}, title, count), fields);
    details.count = count, details.fields = fields;
    return details;
  }

  #history() {
    this.undo = make("button", { onclick: () => this.link.send("undo") }, "Undo");
    this.redo = make("button", { onclick: () => this.link.send("redo") }, "Redo");
    return make("div", { class: "actions" }, this.undo, this.redo, make("button", { onclick: () => this.link.send("deselect") }, "Select nothing"));
  }

  #picture() {
    const send = (...command) => this.link.send(...command);
    this.exposure = new Slider(this.link, "Exposure", -8, 8, value => send("stops", value), { step: 0.00625 });
    this.tone = choice("Tone map", [["aces", "ACES, filmic"], ["none", "None"]], value => send("tone", value));
    this.show = choice("Layer", [], value => send("show", value));
    this.denoise = check("Denoise", on => send("denoise", on ? "on" : "off"));
    this.scale = choice("Size", [["auto", "Automatic"], ["1", "Full"], ["0.5", "Half"], ["0.25", "Quarter"]], value => this.actions.scale(value));
    return [this.show.row, this.exposure.row, this.tone.row, this.denoise.row, this.scale.row];
  }

  #camera() {
    const link = this.link, look = (position, target) => link.send("look", ...position, ...target);
    this.position = new Place("Position", value => look(value, link.state.camera.target));
    this.target = new Place("Target", value => look(link.state.camera.position, value));
    this.fov = new Slider(link, "Field of view", 5, 120, value => link.send("fov", value));
    this.aperture = new Slider(link, "Lens radius", 0, 1, value => link.send("aperture", value * this.scene.size * 0.02));
    this.aperture.number.hidden = true;
    this.spin = new Slider(link, "Turntable", -90, 90, value => link.send("spin", Math.abs(value) < 1 ? 0 : value), { step: 1 / 180 });
    return [this.position.row, this.target.row, this.fov.row, this.aperture.row, this.spin.row];
  }

  #files() {
    const input = make("input", { id: "line", type: "text", placeholder: "orbit 30 0", "aria-label": "Command", spellcheck: false,
      onkeydown: e => { if (e.key === "Enter" && input.value.trim()) { this.link.line(input.value); input.select(); } } });
    const files = make("input", { type: "file", multiple: true, hidden: true, onchange: () => this.actions.open([...files.files]) });
    this.jobs = [make("button", { onclick: this.actions.saveJob }, "Save a job file"), make("button", { onclick: this.actions.copyCommand }, "Copy the command line")];
    return [
      make("div", { class: "actions" },
        make("button", { onclick: () => files.click() }, "Open files"),
        make("button", { onclick: this.actions.save }, "Save the picture"), ...this.jobs, files),
      make("div", { class: "row wide" }, make("label", { for: "line" }, "Command"), input), this.console];
  }

  /** The scene that the server describes. */
  fill(scene) {
    this.scene = scene;
    const big = n => n < 1e4 ? `${n}` : n < 1e6 ? `${+(n / 1e3).toPrecision(3)}k` : `${+(n / 1e6).toPrecision(3)}M`;
    this.objectSection.count.textContent = `${big(scene.triangles)} triangles`;
    this.objects.fill(scene.objects.map((o, i) => ({ key: o.instance, name: unused(o.name, `object ${i}`), more: big(o.triangles), color: colorOfMaterial(scene.materials[o.material]) })));
    this.materialSection.count.textContent = `${scene.materials.length}`;
    this.materials.fill(scene.materials.map((m, i) => ({ key: i, name: unused(m.name, `material ${i}`), more: m.kind, color: colorOfMaterial(m) })));
    this.lightSection.count.textContent = `${scene.lights.length}`;
    this.lightSection.hidden = !scene.lights.length;
    this.lights.fill(scene.lights.map((l, i) => ({ key: i, name: unused(l.name, `light ${i}`), more: l.kind })));
    this.undo.disabled = !scene.undo, this.redo.disabled = !scene.redo;
    for (const button of this.jobs) button.hidden = !scene.has_job;
    this.exposure.set(scene.exposure);
    this.tone.select.value = scene.tone;
    if (!this.show.select.options.length) this.show.select.append(...scene.shows.map(name => make("option", { value: name }, label(name))));
    this.#fillEffects(scene.effects, this.link.state?.measures);
    this.curve.begin(this.link.numbered(scene.run), scene.curve);
    this.shown = null;
    if (this.link.state) this.update(this.link.state);
  }

  #fillEffects(effects, measures = false) {
    this.measures = measures;
    this.effectSection.count.textContent = `${effects.length}`;
    const measured = effects.some(effect => "cost" in effect);
    const unclear = effects.some(effect => effect.noise);
    const most = Math.max(0.01, ...effects.map(effect => effect.cost ?? 0));
    this.effects.replaceChildren(...effects.map(effect => {
      const fill = make("div", { class: "fill" });
      fill.style.width = `${100 * Math.max(0, effect.noise ? 0 : effect.cost ?? 0) / most}%`;
      const figure = measures ? "measuring" : !("cost" in effect) ? (measured ? "needed" : "") : effect.noise ? "unclear" : percent(effect.cost);
      return make("div", { class: "cost", title: `${effect.name}: ${effect.by}${effect.count > 1 ? ` and ${effect.count - 1} more` : ""}` },
        make("span", { class: "name" }, effect.name), make("div", { class: "track", "aria-hidden": "true" }, fill), make("span", { class: "figure" }, figure));
    }), make("div", { class: "actions" }, this.measure = make("button", { onclick: () => this.link.send("explain") }, measured ? "Measure again" : "Measure the cost")),
    make("p", { class: "note" }, measures ? "Renders the scene with and without each effect." : measured ? `Share of the time of a sample that each effect takes.${unclear ? " Unclear: too small for the rounds to agree on; measure again while the computer does nothing else." : ""}` : "Renders the scene with and without each effect. The first time the kernels are compiled, which takes a while."));
  }

  /** What belongs to the last frame. */
  update(state) {
    this.curve.add(state);
    this.forecast.textContent = this.curve.forecast();
    this.plot.setAttribute("aria-label", `Noise against time: ${this.curve.forecast()}`);
    this.console.textContent = state.told;
    this.show.select.value = state.shows, this.denoise.input.checked = state.denoises;
    this.position.set(state.camera.position), this.target.set(state.camera.target);
    this.fov.set(state.camera.fov), this.spin.set(state.spin);
    if (!this.scene) return;
    this.aperture.set(state.camera.aperture / (this.scene.size * 0.02));
    for (const section of this.root.children) section.fields.disabled = !state.steers;
    if (state.measures !== this.measures) this.#fillEffects(this.scene.effects, state.measures);
    this.measure.disabled = state.measures;
    this.objects.select(state.instance), this.materials.select(state.material), this.lights.select(state.light);
    const { materials, lights } = this.scene;
    const shown = `${state.material} ${materials[state.material]?.kind} ${state.light}`;
    if (shown !== this.shownKind) {
      this.shownKind = shown, this.shown = null;
      const names = readBy[materials[state.material]?.kind] ?? base;
      const rows = this.scene.material_values.filter(row => names.includes(row.name)).sort((a, b) => names.indexOf(a.name) - names.indexOf(b.name));
      this.materialInputs = this.#build(this.materialValues, materials[state.material] ? rows : [], "material");
      const light = lights[state.light], cone = light?.kind === "spot";
      const ofLight = this.scene.light_values.filter(row => row.name === "intensity" || (row.name === "position" && !light?.far) || (row.name === "direction" && light?.kind !== "point")
        || (row.name.endsWith("angle") && cone) || (row.name === "range" && !light?.far));
      this.lightInputs = this.#build(this.lightValues, light ? ofLight : [], "lamp");
    }
    if (this.shown === this.scene) return;
    this.shown = this.scene;
    for (const [name, input] of this.materialInputs) input.set(materials[state.material].values[name]);
    for (const [name, input] of this.lightInputs) input.set(lights[state.light].values[name]);
  }

  #build(body, rows, command) {
    const inputs = rows.map(row => {
      const send = value => this.link.send(command, row.name, ...(Array.isArray(value) ? value : [value, 0, 0]));
      if (row.kind === "color") return [row.name, new Color(this.link, label(row.name), row.most, send)];
      if (row.kind === "place") return [row.name, new Place(label(row.name), send)];
      return [row.name, new Slider(this.link, label(row.name), row.least, row.most, send, { curved: row.most > 10 })];
    });
    body.replaceChildren(...inputs.flatMap(([, input]) => input.rows ?? [input.row]));
    body.hidden = !rows.length;
    return inputs;
  }
}
