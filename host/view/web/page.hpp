// The web page of the view. web.cpp replaces what stands between @.
#pragma once

namespace claray::view {

inline constexpr const char* page_template = R"page(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>claray view</title>
<style>
  body { margin: 0; background: #181a1b; color: #ddd; font: 14px sans-serif; }
  header { display: flex; flex-wrap: wrap; gap: 8px; padding: 8px; align-items: center; }
  img { display: block; max-width: 100%; cursor: grab; image-rendering: pixelated; user-select: none; }
  pre { margin: 8px; white-space: pre-wrap; }
  #error { color: #ff8a80; }
  button, select, input { font: inherit; }
  a { color: inherit; }
</style>
<header>
  <select id="show" title="what is seen">@shows@</select>
  <label><input id="denoise" type="checkbox">denoise</label>
  <button data-command="exposure -0.5">darker</button>
  <button data-command="exposure 0.5">brighter</button>
  <button data-command="home">home</button>
  <button data-command="pause">pause</button>
  <button data-command="play">play</button>
  <button data-command="next">next light</button>
  <button id="camera">copy the camera</button>
  <a id="save" href="picture.png" download="view.png">save the picture</a>
  <input id="line" size="32" placeholder="command, for example: orbit 30 0" aria-label="command">
  <span>@help@</span>
</header>
<img id="view" alt="the rendered scene" draggable="false">
<pre id="error" role="alert"></pre>
<pre id="status"></pre>
<script>
  const keys = {@keys@}, degreesPerPixel = @degrees@, zoomPerStep = @zoom@, farthestClick = @click@;
  const [view, status, error] = ["view", "status", "error"].map(id => document.getElementById(id));
  const send = async line => {
    if (line === "camera") return copyCamera();
    if (line.startsWith("save ")) return document.getElementById("save").click();
    return post(line);
  };
  const post = async line => {
    const answer = await fetch("command", { method: "POST", body: line });
    error.textContent = answer.ok ? "" : await answer.text();  // until a command is accepted
  };
  const copyCamera = async () => {
    await post("camera");
    for (let i = 0; i < 20; ++i) {
      const told = (await (await fetch("status")).text()).split("\n")[1] || "";
      if (told.startsWith("--camera")) return navigator.clipboard.writeText(told);
      await pause(0.05);
    }
  };
  const pixel = e => {
    const box = view.getBoundingClientRect();
    return Math.floor((e.clientX - box.left) * view.naturalWidth / box.width) + " " +
           Math.floor((e.clientY - box.top) * view.naturalHeight / box.height);
  };
  let drag = null;
  view.addEventListener("mousedown", e => { drag = { x: e.clientX, y: e.clientY, far: 0 }; e.preventDefault(); });
  window.addEventListener("mousemove", e => {
    if (!drag) return;
    const x = e.clientX - drag.x, y = e.clientY - drag.y;
    if (Math.abs(x) + Math.abs(y) < 2) return;
    drag = { x: e.clientX, y: e.clientY, far: drag.far + Math.abs(x) + Math.abs(y) };
    const box = view.getBoundingClientRect();
    if (e.ctrlKey) send(`drag ${x / box.height} ${-y / box.height}`);
    else if (e.shiftKey) send(`pan ${-x / box.height} ${y / box.height}`);
    else send(`orbit ${-x * degreesPerPixel} ${y * degreesPerPixel}`);
  });
  window.addEventListener("mouseup", e => {
    if (drag && drag.far < farthestClick && e.target === view) send("pick " + pixel(e));
    drag = null;
  });
  view.addEventListener("dblclick", e => send("focus " + pixel(e)));
  view.addEventListener("wheel", e => { e.preventDefault(); send("zoom " + (e.deltaY < 0 ? zoomPerStep : 1 / zoomPerStep)); }, { passive: false });
  window.addEventListener("keydown", e => {
    const command = keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    const elsewhere = ["INPUT", "SELECT"].includes(e.target.tagName) || e.ctrlKey || e.altKey || e.metaKey;
    if (command && !elsewhere) { e.preventDefault(); send(command); }
  });
  document.querySelectorAll("button").forEach(b => b.addEventListener("click", () => send(b.dataset.command || b.id)));
  document.getElementById("show").addEventListener("change", e => {
    send("show " + e.target.value);
    e.target.blur();
  });
  document.getElementById("denoise").addEventListener("change", e => {
    send("denoise " + (e.target.checked ? "on" : "off"));
    e.target.blur();  // keys go to the view again
  });
  document.getElementById("line").addEventListener("keydown", e => {
    if (e.key === "Enter" && e.target.value.trim()) { send(e.target.value); e.target.select(); }
  });
  const pause = seconds => new Promise(wait => setTimeout(wait, 1000 * seconds));
  // One request for each frame: Firefox goes on reading the streams of pages that were left, until no connection is free.
  const watch = async () => {
    for (let seen = 0; ; ) {
      try {
        const answer = await fetch("frame?after=" + seen);
        if (answer.status === 204) continue;  // nothing is new
        if (!answer.ok) throw answer;
        seen = answer.headers.get("Frame-Number");
        const next = new Image(), before = view.src;
        next.src = URL.createObjectURL(await answer.blob());
        await next.decode();  // so that the image is never blank
        view.src = next.src;
        URL.revokeObjectURL(before);
      } catch {
        await pause(0.5);
      }
    }
  };
  const tell = async () => {
    for (; ; await pause(0.5)) {
      try {
        status.textContent = await (await fetch("status")).text();
      } catch {
        status.textContent = "the view has ended or the connection is lost";
      }
    }
  };
  watch();
  tell();
</script>
</html>
)page";

}  // namespace claray::view
