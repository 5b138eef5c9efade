// The page of the view.
import { duration, percent, shape } from "./curve.js";
import { Gizmo } from "./gizmo.js";
import { Link } from "./link.js";
import { Panel, make } from "./panel.js";
import { boxOf, listen } from "./pointer.js";

const at = id => document.getElementById(id);
const [stage, image, chip, message, help] = ["stage", "view", "chip", "message", "help"].map(at);
const link = new Link();

// One line at the bottom of the image.
let forget = 0;
const say = (text, { failed = false, seconds = failed ? 12 : 4 } = {}) => {
  clearTimeout(forget);
  message.textContent = text, message.hidden = !text;
  message.classList.toggle("failed", failed);
  if (seconds) forget = setTimeout(() => { message.hidden = true; }, 1000 * seconds);
};

// The image follows the size of its place. Where sampling is slow it has half of the sides; where it is fast, the pixels of the display.
const plenty = 2e8, enough = 2e7, tooFew = 8e6;  // samples a second
let scale = "auto", automatic = 0.5, asked = "", askedAt = 0;
const fit = () => {
  const state = link.state;
  if (!state?.steers) return;
  const factor = scale === "auto" ? automatic : +scale, size = side => Math.max(16, Math.round(side * factor));
  const wanted = `${size(stage.clientWidth)} ${size(stage.clientHeight)}`;
  const now = performance.now(), waits = wanted === asked && now < askedAt + 1500;
  if (waits || wanted === `${state.width} ${state.height}` || stage.clientWidth < 2) return;
  asked = wanted, askedAt = now;
  link.send("resize", ...wanted.split(" ").map(Number));
};
const judgeSpeed = state => {
  if (state.spp < 8 || state.seconds < 0.3) return;
  const speed = state.spp * state.width * state.height / state.seconds, before = automatic;
  automatic = speed > plenty ? Math.min(devicePixelRatio, 2) : speed > enough ? 1 : speed < tooFew ? 0.5 : automatic;
  if (automatic !== before) fit();
};
new ResizeObserver(() => setTimeout(fit, 120)).observe(stage);

const save = () => make("a", { href: "picture.png", download: "view.png" }).click();
const saveJob = () => make("a", { href: "job.json", download: "job.json" }).click();
const copy = async (text, what) => {
  try {
    await navigator.clipboard.writeText(text.trim());
    say(`copied: ${what}`);
  } catch {
    say(text.trim(), { seconds: 0 });  // browsers copy only for pages of this computer or by https
  }
};
const copyCommand = async () => copy(await link.text("command-line"), "the command line");
const copyCamera = () => copy(link.state.camera.options, "the camera");

// Files arrive in pieces.
const piece = 1 << 20;
const sceneName = /\.(gltf|glb|obj|ply|stl|fbx|dae|3ds|off|3mf|usd[acz]?|blend|pbrt|xml|vrm|pcd)$/i;
const open = async files => {
  const scene = files.map(file => file.webkitRelativePath || file.path || file.name).find(name => sceneName.test(name)) ?? files[0]?.name;
  if (!scene || !await link.post("drop")) return;
  for (const file of files) {
    const name = file.webkitRelativePath || file.path || file.name;
    for (let begin = 0; begin === 0 || begin < file.size; begin += piece) {
      say(`sends ${name}, ${Math.round(100 * begin / Math.max(file.size, 1))} %`, { seconds: 0 });
      if (!await link.post("upload", file.slice(begin, begin + piece), { name, at: begin })) return;
    }
  }
  say(`loads ${scene}`, { seconds: 0 });
  await link.post("open", "", { name: scene });
};

const panel = new Panel(at("panel"), link, { scale: value => { scale = value; fit(); }, save, saveJob, copyCommand, open });
const gizmo = new Gizmo(at("gizmo"), link, () => {
  const box = boxOf(image), origin = stage.getBoundingClientRect();
  return { ...box, x: box.x - origin.x, y: box.y - origin.y };
});

// Tools: a name, a key, a picture, and what they do.
const icons = {
  move: "M9 1v16M1 9h16M9 1L7 3.5M9 1l2 2.5M9 17l-2-2.5M9 17l2-2.5M1 9l2.5-2M1 9l2.5 2M17 9l-2.5-2M17 9l-2.5 2",
  rotate: "M15 9a6 6 0 1 1-2-4.5M13.5 1.5v3.2h-3.2", scale: "M2.5 9.5v6h6v-6zM6 6h0M8 2.5h7.5V10M15.5 2.5l-6 6",
  home: "M2.5 8.5L9 2.5l6.5 6M4.5 7v8.5h9V7", spin: "M2 9c0-2 3-3.5 7-3.5S16 7 16 9s-3 3.5-7 3.5M9 12.500l2-2M9 12.500l2 2",
  pause: "M6 3v12M12 3v12", play: "M5 2.500v13l10-6.500z", undo: "M4 7h7a4 4 0 0 1 0 8H7M4 7l3-3M4 7l3 3", redo: "M14 7H7a4 4 0 0 0 0 8h4M14 7l-3-3M14 7l-3 3",
  save: "M9 2v9M5.500 8L9 11.500 12.500 8M3 15h12", panel: "M2 3h14v12H2zM11 3v12", help: "M6.500 6.500a2.500 2.500 0 1 1 3.600 2.300c-.8.4-1.100.9-1.100 1.900M9 14h0",
};
const setMode = mode => {
  gizmo.mode = mode;
  for (const name of ["move", "rotate", "scale"]) buttons[name].setAttribute("aria-pressed", `${name === mode}`);
  if (link.state) gizmo.draw(link.state);
};
const togglePanel = () => {
  document.body.classList.toggle("wide");
  buttons.panel.setAttribute("aria-pressed", `${!document.body.classList.contains("wide")}`);
};
const tools = [
  ["move", "Move what is selected", "G", () => setMode("move")], ["rotate", "Turn what is selected", "R", () => setMode("rotate")],
  ["scale", "Scale what is selected", "B", () => setMode("scale")], null,
  ["undo", "Undo", "Ctrl Z", () => link.send("undo")], ["redo", "Redo", "Ctrl Shift Z", () => link.send("redo")], null,
  ["home", "First camera", "H", () => link.send("home")], ["spin", "Turntable", "O", () => link.send("spin", link.state?.spin ? 0 : 20)],
  ["play", "Play the animation", "L", () => link.send("play")], ["pause", "Pause sampling", "P", () => link.send("pause")], null,
  ["save", "Save the picture", "K", save], ["panel", "Panel", "F", togglePanel], ["help", "Keys", "?", () => showHelp()],
];
const buttons = {};
for (const tool of tools) {
  if (!tool) { at("tools").append(make("span", { class: "gap", "aria-hidden": "true" })); continue; }
  const [name, text, key, act] = tool;
  buttons[name] = make("button", { "aria-label": text, title: `${text} (${key})`, onclick: act, class: ["undo", "redo"].includes(name) ? "spare" : "" },
    shape("svg", { viewBox: "0 0 18 18", "aria-hidden": "true" }, shape("path", { d: icons[name] })));
  at("tools").append(buttons[name]);
}
setMode("move"), buttons.panel.setAttribute("aria-pressed", "true");

const showHelp = () => {
  const row = (keys, text) => make("div", {}, make("dt", {}, ...keys.flatMap((key, i) => [i ? " " : "", make("kbd", {}, key)])), make("dd", {}, text));
  const rows = [
    [["Drag"], "orbit"], [["Shift", "Drag"], "pan; two fingers"], [["Wheel"], "zoom; pinch"], [["Click"], "select"], [["Double click"], "focus"],
    [["Ctrl", "Drag"], "move what is selected"], [["Arrows"], "orbit"], [["W", "A", "S", "D", "Q", "E"], "fly"],
    ...tools.filter(Boolean).map(([, text, key]) => [key.split(" "), text.toLowerCase()]),
    [["1 – 7"], "image, depth, normal, albedo, primitive, heat, error"], [["+", "-"], "brighter, darker"], [["N", "M"], "denoise, as it is"],
    [["T"], "select the next light"], [["C"], "copy the camera"], [["Esc"], "select nothing"], [["X"], "end the view"]];
  help.replaceChildren(make("header", {}, make("h2", { id: "help-title" }, "Mouse and keys"), make("button", { onclick: () => help.close() }, "Close")),
                       make("dl", {}, ...rows.map(([keys, text]) => row(keys, text))));
  help.showModal();
};
help.addEventListener("click", e => { if (e.target === help) help.close(); });

const own = { g: () => setMode("move"), r: () => setMode("rotate"), b: () => setMode("scale"), o: () => buttons.spin.click(), k: save, c: copyCamera,
              "?": showHelp, f: togglePanel, Escape: () => { message.hidden = true; link.send("deselect"); } };
window.addEventListener("keydown", e => {
  if (help.open) return;
  const key = e.key.length === 1 ? e.key.toLowerCase() : e.key, target = e.target;
  const writes = target.matches("input:not([type=range], [type=checkbox]), select"), onImage = target === image || target === document.body;
  if ((e.ctrlKey || e.metaKey) && !writes && (key === "z" || key === "y")) {
    e.preventDefault();
    return link.send(key === "y" || e.shiftKey ? "redo" : "undo");
  }
  if (writes || e.ctrlKey || e.altKey || e.metaKey) return;
  if (!onImage && (key.length > 1 || key === " ")) return;  // arrows and blank belong to what has the focus
  const command = panel.scene?.keys[key];
  if (!own[key] && !command) return;
  e.preventDefault();
  own[key] ? own[key]() : link.send(...command.split(" ").map(word => Number.isNaN(+word) ? word : +word));
});

for (const kind of ["dragenter", "dragover"]) window.addEventListener(kind, e => { e.preventDefault(); at("drop").hidden = false; });
window.addEventListener("dragleave", e => { if (!e.relatedTarget) at("drop").hidden = true; });
window.addEventListener("drop", async e => {
  e.preventDefault();
  at("drop").hidden = true;
  open((await Promise.all([...e.dataTransfer.items].map(item => item.webkitGetAsEntry()).filter(Boolean).map(filesOf))).flat());
});
/** A dropped folder keeps its structure, to which files of scenes refer. */
const filesOf = async entry => {
  if (entry.isFile) {
    const file = await new Promise((give, fail) => entry.file(give, fail));
    file.path = entry.fullPath.replace(/^\//, "");
    return [file];
  }
  const reader = entry.createReader(), files = [];
  for (let batch; (batch = await new Promise((give, fail) => reader.readEntries(give, fail))).length; )
    for (const child of batch) files.push(...await filesOf(child));
  return files;
};

const bitmaps = image.getContext("bitmaprenderer");
link.show = async (blob, state) => {
  const bitmap = await createImageBitmap(blob);  // decodes in another thread
  if (image.width !== bitmap.width || image.height !== bitmap.height) image.width = bitmap.width, image.height = bitmap.height;
  bitmaps.transferFromImageBitmap(bitmap);
  image.dataset.revision = state.revision;  // that the picture shows
  const stretch = image.clientWidth * state.height / (image.clientHeight * state.width);
  image.style.objectFit = Math.abs(stretch - 1) < 0.02 ? "fill" : "contain";  // half of an odd size is rounded
  gizmo.draw(state);
};

let revision = "", describes = false, told = null;
const describe = async () => {
  if (describes) return;
  describes = true;
  try {
    do {
      revision = link.state.revision;
      panel.fill(await link.json("scene"));
      Object.assign(mouse, panel.scene.mouse);
      buttons.undo.disabled = !panel.scene.undo, buttons.redo.disabled = !panel.scene.redo;
      buttons.play.hidden = !panel.scene.animated;
      document.title = panel.scene.name ? `${panel.scene.name} – claray view` : "claray view";
      await new Promise(wait => setTimeout(wait, 150));
    } while (revision !== link.state.revision);
  } catch { revision = ""; }
  describes = false;
};

link.addEventListener("state", ({ detail: state }) => {
  const spp = panel.scene?.spp ?? 0, begins = state.spp < 4;  // what noise and seconds there are belong to the run before
  const noise = state.noise > 0 && !state.denoises && !begins ? `noise ${percent(state.noise)}` : "";
  const bar = chip.querySelector("progress") ?? make("progress", { max: 1, "aria-label": "Samples" });
  bar.value = spp ? Math.min(1, state.spp / spp) : 0;
  const texts = [`${state.width}×${state.height}`, `${state.spp}${spp ? ` of ${spp}` : ""} samples`, noise, state.paused ? "paused" : state.seconds > 0 && !begins ? duration(state.seconds) : "",
                 state.pages > 1 ? `${state.pages} pages` : "", state.measures ? "measuring effects" : ""];
  chip.replaceChildren(bar, ...texts.filter(Boolean).map(text => make("span", {}, text)));
  at("steering").hidden = state.steers;
  buttons.pause.setAttribute("aria-pressed", `${state.paused}`), buttons.spin.setAttribute("aria-pressed", `${state.spin !== 0}`);
  buttons.play.setAttribute("aria-pressed", `${state.playing}`);
  panel.update(state);
  if (state.revision !== revision) describe();
  const now = `${state.failed} ${state.told}`;
  if (told !== null && now !== told && state.told && (state.failed || /^(loads|measures|opened|nothing) /.test(state.told)))
    say(state.told, { failed: state.failed, seconds: state.told.startsWith("loads ") ? 0 : undefined });
  else if (now !== told && message.textContent.startsWith("loads ")) message.hidden = true;
  told = now;
  fit(), judgeSpeed(state);
});
link.addEventListener("failed", ({ detail }) => say(detail, { failed: true }));
link.addEventListener("lost", () => say("the view has ended or the connection is lost", { failed: true, seconds: 0 }));
link.addEventListener("found", () => { message.hidden = true; revision = "", asked = ""; });
at("take").addEventListener("click", async () => { await link.post("steer"); asked = ""; });

const mouse = { degrees: 0.4, zoom: 1.1, click: 4 };
listen(image, link, mouse);
if (matchMedia("(max-width: 720px)").matches) togglePanel();
link.watch();
