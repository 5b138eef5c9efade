// The mouse and fingers on the image.

/** Where the image lies in its element, in pixels of the window: `object-fit: contain`. */
export const boxOf = image => {
  const outer = image.getBoundingClientRect(), wide = image.width, high = image.height;
  const scale = Math.min(outer.width / wide, outer.height / high), width = scale * wide, height = scale * high;
  return { x: outer.x + (outer.width - width) / 2, y: outer.y + (outer.height - height) / 2, width, height };
};

const pixelOf = (e, image) => {
  const box = boxOf(image), x = (e.clientX - box.x) / box.width, y = (e.clientY - box.y) / box.height;
  return x < 0 || y < 0 || x >= 1 || y >= 1 ? null : [Math.floor(x * image.width), Math.floor(y * image.height)];
};

/** `mouse`: degrees per pixel, zoom per step of the wheel, and the farthest way of a click, in pixels. */
export const listen = (image, link, mouse) => {
  const fingers = new Map();
  let far = 0, pinched = false;

  const middle = () => {
    const [a, b = a] = [...fingers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  };

  image.addEventListener("pointerdown", e => {
    if (e.button > 2) return;
    image.setPointerCapture(e.pointerId);
    image.classList.add("dragged");
    if (fingers.size === 0) far = 0, pinched = false;
    fingers.set(e.pointerId, { x: e.clientX, y: e.clientY, button: e.button });
    if (fingers.size > 1) pinched = true;
  });

  image.addEventListener("pointermove", e => {
    const finger = fingers.get(e.pointerId);
    if (!finger) return;
    const before = middle();
    const x = e.clientX - finger.x, y = e.clientY - finger.y;
    finger.x = e.clientX, finger.y = e.clientY;
    far += Math.abs(x) + Math.abs(y);
    if (far < mouse.click) return;
    const height = boxOf(image).height;
    if (fingers.size > 1) {
      const after = middle();
      link.send("pan", -(after.x - before.x) / height, (after.y - before.y) / height);
      if (before.apart > 0 && after.apart > 0) link.send("zoom", after.apart / before.apart);
    } else if (e.ctrlKey) {
      link.send("drag", x / height, -y / height);
    } else if (e.shiftKey || finger.button > 0) {
      link.send("pan", -x / height, y / height);
    } else {
      link.send("orbit", -x * mouse.degrees, y * mouse.degrees);
    }
  });

  const end = e => {
    const finger = fingers.get(e.pointerId);
    fingers.delete(e.pointerId);
    if (fingers.size === 0) image.classList.remove("dragged");
    if (!finger || e.type !== "pointerup" || pinched || far >= mouse.click || finger.button !== 0) return;
    const pixel = pixelOf(e, image);
    if (pixel) link.send("pick", ...pixel);
    else link.send("deselect");
  };
  image.addEventListener("pointerup", end);
  image.addEventListener("pointercancel", end);
  image.addEventListener("contextmenu", e => e.preventDefault());
  image.addEventListener("dblclick", e => {
    const pixel = pixelOf(e, image);
    if (pixel) link.send("focus", ...pixel);
  });
  image.addEventListener("wheel", e => {
    e.preventDefault();
    const steps = e.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? e.deltaY / 100 : e.deltaY / 3;
    link.send("zoom", mouse.zoom ** -Math.max(-5, Math.min(5, steps)));
  }, { passive: false });
};
