// The connection to the view: frames and states come in, commands go out.

/** The name of this page among those that are open. */
const page = Array.from(crypto.getRandomValues(new Uint8Array(8)), byte => byte.toString(16).padStart(2, "0")).join("");

const sums = ["orbit", "turn", "pan", "fly", "drag", "move", "exposure"], products = ["zoom", "scale"];
const replaces = ["material", "lamp", "look", "fov", "aperture", "stops", "resize", "time", "spin", "show"];

/** Two commands as one, or null: what the hand does between two answers is sent at once. */
const merged = (a, b) => {
  if (a.name !== b.name || a.word !== b.word) return null;
  if (sums.includes(a.name)) return { ...a, numbers: a.numbers.map((n, i) => n + b.numbers[i]) };
  if (products.includes(a.name)) return { ...a, numbers: a.numbers.map((n, i) => n * b.numbers[i]) };
  if (replaces.includes(a.name)) return b;
  const sameAxis = a.name === "rotate" && a.numbers.slice(0, 3).every((n, i) => n === b.numbers[i]);
  return sameAxis ? { ...a, numbers: [...a.numbers.slice(0, 3), a.numbers[3] + b.numbers[3]] } : null;
};

const pause = seconds => new Promise(wait => setTimeout(wait, 1000 * seconds));

/** Events: `state`, `failed` (a line), `lost` and `found`. */
export class Link extends EventTarget {
  state = null;
  opened = "0";
  show = async () => {};  // a frame: a blob with its state
  #waiting = [];
  #sends = false;

  tell(kind, detail) { this.dispatchEvent(new CustomEvent(kind, { detail })); }

  /** A command by its parts, such as send("material", "roughness", 0.5, 0, 0). */
  send(name, ...rest) {
    const word = typeof rest[0] === "string" ? rest.shift() : "";
    const command = { name, word, numbers: rest };
    const last = this.#waiting.at(-1), one = last && merged(last, command);
    if (one) this.#waiting[this.#waiting.length - 1] = one;
    else this.#waiting.push(command);
    return this.#flush();
  }

  async line(text) {
    await this.post("command", text.trim());
  }

  async #flush() {
    if (this.#sends) return;
    this.#sends = true;
    while (this.#waiting.length) {
      const { name, word, numbers } = this.#waiting.shift();
      await this.post("command", [name, word, ...numbers.map(n => +n.toPrecision(8))].filter(part => part !== "").join(" "));
    }
    this.#sends = false;
  }

  /** Returns whether it was accepted. */
  async post(path, body = "", parameters = {}) {
    try {
      const query = new URLSearchParams({ ...parameters, page });
      const headers = { "Content-Type": body instanceof Blob ? "application/octet-stream" : "text/plain" };
      const answer = await fetch(`${path}?${query}`, { method: "POST", body, headers });
      if (!answer.ok) this.tell("failed", (await answer.text()).trim() || `${path}: ${answer.status}`);
      return answer.ok;
    } catch {
      return false;  // watch tells that the connection is lost
    }
  }

  /** Views of two scenes count from 0. */
  numbered(number) { return `${this.opened}-${number}`; }

  async json(path) { return (await fetch(path)).json(); }
  async text(path) { return (await fetch(path)).text(); }

  /**
   * One request for each frame: Firefox goes on reading the streams of pages that were left, until no connection is free. A frame is shown
   * before the next is asked for: after a change the view waits for that, so that rendering does not take the processor from the browser.
   */
  async watch() {
    for (let seen = 0, lost = false; ; ) {
      try {
        const answer = await fetch(`frame?after=${seen}&page=${page}`);
        if (answer.status === 401) throw answer;
        const header = name => answer.headers.get(name);
        this.opened = header("View-Opened");
        const state = { ...JSON.parse(header("View-State")), steers: header("View-Steers") === "1", pages: +header("View-Pages") };
        state.revision = this.numbered(state.revision), state.run = this.numbered(state.run);
        const blob = answer.status === 200 ? await answer.blob() : null;
        seen = header("Frame-Number");
        if (lost) this.tell("found");
        lost = false;
        this.state = state;
        if (blob) await this.show(blob, state).catch(() => {});  // another frame comes
        this.tell("state", state);
        if (blob && !document.hidden) await new Promise(requestAnimationFrame);
      } catch {
        if (!lost) this.tell("lost");
        lost = true;
        await pause(0.5);
      }
    }
  }
}
