"use strict";
// Two pictures under one transform, a wipe between them. Sides: {item, kind, previous}; kind: "result", "error" or the
// name of a inspection view. What an item does not have is shown as its result.
const viewer = (() => {
  const $ = (id) => document.getElementById(id);
  const stage = $("stage"), wipeBar = $("wipe");
  const { items, pictures, crops } = data;
  const [width, height] = [data.size[0] || 1, data.size[1] || 1];
  const samplers = items.map((v, i) => i).filter((i) => items[i].kind === "sampler");
  const views = [...new Set(items.flatMap((v) => v.views.map((view) => view.name)))];
  const sides = {};
  const view = { scale: 1, x: 0, y: 0, fitted: true };
  let wipe = 0.5;

  for (const name of ["left", "right"]) {
    const layer = $("layer-" + name), plane = layer.querySelector(".plane"), images = {};
    const none = document.createElement("div");
    none.className = "none";
    none.textContent = "no picture";
    none.hidden = true;
    layer.append(none);
    const pick = $("pick-" + name);
    items.forEach((v, i) => {
      const place = samplers.indexOf(i);
      pick.add(new Option((v.kind === "reference" ? "r  " : place < 9 ? `${place + 1}  ` : "") + v.label, i));
    });
    pick.addEventListener("change", () => show(name, Number(pick.value)));
    sides[name] = { item: data[name], previous: data[name], kind: "result", layer, plane, images, refresh: {}, none,
      pick };
    // Decoded in advance: switching does not flicker. Inspection views load when shown.
    for (const v of items) for (const file of [v.result, v.error]) imageOf(sides[name], file);
  }

  function imageOf(side, file) {
    if (!file || side.images[file]) return;
    const hasRange = exposure.isRange(file), image = hasRange ? document.createElement("canvas") : new Image();
    if (hasRange) {
      [image.width, image.height] = [width, height];
    } else {
      image.src = pictures[file];
      image.alt = "";
      image.draggable = false;
      image.decode().catch(() => {});
    }
    image.style.width = width + "px";
    image.style.height = height + "px";
    image.dataset.file = file;
    side.plane.append(image);
    side.images[file] = image;
    if (hasRange) side.refresh[file] = exposure.show(image, file);
  }

  const viewOf = (v, kind) => v.views.find((view) => view.name === kind);

  function show(name, item, kind) {
    const side = sides[name];
    if (items[side.item].kind === "sampler") side.previous = side.item;
    side.item = item;
    if (kind !== undefined) side.kind = kind;
    draw(name);
  }

  function draw(name) {
    const side = sides[name], v = items[side.item];
    const isError = side.kind === "error" && v.kind === "sampler";
    const view = viewOf(v, side.kind);
    const file = view ? view.file : isError ? v.error : v.result;
    imageOf(side, file);
    for (const key of Object.keys(side.images)) side.images[key].classList.toggle("shown", key === file);
    side.refresh[file]?.();
    side.none.hidden = Boolean(file);
    side.layer.dataset.shown = v.label + "/" + (view ? view.name : isError ? "error" : "result");
    side.pick.value = String(side.item);
    const line = $("name-" + name);
    line.replaceChildren();
    if (v.colour) {
      const mark = document.createElement("span");
      mark.className = "swatch";
      mark.style.setProperty("--c", v.colour === "var(--ink)" ? "#fff" : v.colour);
      line.append(mark);
    }
    const label = document.createElement("b");
    label.textContent = v.label;
    const range = view && view.min !== null ? ` (${view.min} to ${view.max.toPrecision(3)})` : "";
    const what = view ? "  " + view.title + range : (isError ? " error" : "") + (v.note ? "  " + v.note : "");
    line.append(label, what);
    if (v.biased) {
      const warn = document.createElement("span");
      warn.className = "warn";
      warn.textContent = "  biased";
      line.append(warn);
    }
    $("show-error").setAttribute("aria-pressed", String(sides.right.kind === "error"));
    $("show-view").setAttribute("aria-pressed", String(views.includes(sides.right.kind)));
  }

  function place() {
    for (const side of Object.values(sides)) {
      side.plane.style.transform = `translate(${view.x}px, ${view.y}px) scale(${view.scale})`;
      side.plane.classList.toggle("sharp", view.scale * devicePixelRatio >= 1.5);
    }
    $("zoom").textContent = `${Math.round(view.scale * 100)} %`;
  }

  function placeWipe(value) {
    wipe = Math.min(1, Math.max(0, value));
    const percent = 100 * wipe;
    sides.left.layer.style.clipPath = `inset(0 ${100 - percent}% 0 0)`;
    sides.right.layer.style.clipPath = `inset(0 0 0 ${percent}%)`;
    wipeBar.style.left = `${percent}%`;
    wipeBar.setAttribute("aria-valuenow", String(Math.round(percent)));
    wipeBar.setAttribute("aria-valuetext", `${Math.round(percent)} % left picture`);
  }

  function fit() {
    view.scale = Math.min(stage.clientWidth / width, stage.clientHeight / height);
    view.x = (stage.clientWidth - view.scale * width) / 2;
    view.y = (stage.clientHeight - view.scale * height) / 2;
    view.fitted = true;
    place();
  }

  // The image point under (px, py) of the stage stays there.
  function zoom(factor, px = stage.clientWidth / 2, py = stage.clientHeight / 2) {
    const smallest = 0.5 * Math.min(stage.clientWidth / width, stage.clientHeight / height);
    const scale = Math.min(64, Math.max(smallest, view.scale * factor));
    view.x = px - ((px - view.x) * scale) / view.scale;
    view.y = py - ((py - view.y) * scale) / view.scale;
    view.scale = scale;
    view.fitted = false;
    hold();
    place();
  }

  // A part of the picture always stays in sight.
  function hold() {
    const edge = 40;
    view.x = Math.min(stage.clientWidth - edge, Math.max(edge - view.scale * width, view.x));
    view.y = Math.min(stage.clientHeight - edge, Math.max(edge - view.scale * height, view.y));
  }

  function showCrop(crop, item, kind) {
    const w = crop.x1 - crop.x0, h = crop.y1 - crop.y0;
    view.scale = Math.min(64, 0.92 * Math.min(stage.clientWidth / w, stage.clientHeight / h));
    view.x = stage.clientWidth / 2 - view.scale * (crop.x0 + w / 2);
    view.y = stage.clientHeight / 2 - view.scale * (crop.y0 + h / 2);
    view.fitted = false;
    place();
    show("right", item, kind);
    show("left", sides.left.item, kind);
    seek();
  }

  function seek() {
    stage.scrollIntoView({ block: "nearest" });
    stage.focus({ preventScroll: true });
  }

  // Shows the view on the right, and the result of the same item on the left.
  function showView(item, name) {
    show("right", item, name);
    show("left", item, "result");
    seek();
  }

  function reference(name) {
    const side = sides[name];
    if (items[side.item].kind === "reference") return show(name, side.previous);
    const found = items.findIndex((v) => v.kind === "reference" && v.reference === items[side.item].reference);
    if (found >= 0) show(name, found);
  }

  function swap() {
    const { left, right } = sides, item = left.item, kind = left.kind;
    show("left", right.item, right.kind);
    show("right", item, kind);
  }

  function toggleError(onlyLeft) {
    const kind = (onlyLeft ? sides.left : sides.right).kind === "error" ? "result" : "error";
    for (const name of onlyLeft ? ["left"] : ["left", "right"]) show(name, sides[name].item, kind);
  }

  // Shows the next view that a shown item has; after the last one, the result.
  function nextView(onlyLeft) {
    const names = onlyLeft ? ["left"] : ["left", "right"];
    const has = (kind) => names.some((name) => viewOf(items[sides[name].item], kind));
    const order = ["result", ...views.filter(has)];
    const at = order.indexOf((onlyLeft ? sides.left : sides.right).kind);
    const kind = order[(Math.max(at, 0) + 1) % order.length];
    for (const name of names) show(name, sides[name].item, kind);
  }

  function step(name, by) {
    show(name, (sides[name].item + by + items.length) % items.length);
  }

  function key(e) {
    const typing = "select, input:not([type=range]), textarea, details, .scroll";
    if (e.ctrlKey || e.metaKey || e.altKey || e.target.closest(typing)) return;
    // Arrows on the slider move it, not the choice of pictures.
    if (e.target.closest("input") && /^(Arrow|Page|Home|End)/.test(e.key)) return;
    const name = e.shiftKey ? "left" : "right";
    const digit = /^(Digit|Numpad)([1-9])$/.exec(e.code);
    if (digit) {
      if (Number(digit[2]) > samplers.length) return;
      show(name, samplers[Number(digit[2]) - 1]);
    } else if (e.key === "ArrowRight") step(name, 1);
    else if (e.key === "ArrowLeft") step(name, -1);
    else if (e.key === "e" || e.key === "E") toggleError(e.shiftKey);
    else if (e.key === "v" || e.key === "V") nextView(e.shiftKey);
    else if (e.key === "r" || e.key === "R") reference(name);
    else if (e.key === "x") swap();
    else if (e.key === "b") exposure.change(0.5);
    else if (e.key === "d") exposure.change(-0.5);
    else if (e.key === "n") exposure.reset();
    else if (e.key === "+" || e.key === "=") zoom(1.25);
    else if (e.key === "-") zoom(0.8);
    else if (e.key === "0") fit();
    else return;
    e.preventDefault();
  }

  function wipeKey(e) {
    const by = e.shiftKey ? 0.1 : 0.01;
    const [less, more] = [wipe - by, wipe + by];
    const to = { ArrowLeft: less, ArrowRight: more, ArrowDown: less, ArrowUp: more, Home: 0, End: 1 }[e.key];
    if (to === undefined) return;
    placeWipe(to);
    e.preventDefault();
    e.stopPropagation();  // arrows on the handle move the wipe, not the choice of pictures
  }

  function drag(element, move, cursor) {
    element.addEventListener("pointerdown", (e) => {
      if (e.button !== 0) return;
      e.stopPropagation();
      element.setPointerCapture(e.pointerId);
      let [x, y] = [e.clientX, e.clientY];
      if (cursor) stage.classList.add(cursor);
      const onMove = (m) => {
        move(m, m.clientX - x, m.clientY - y);
        [x, y] = [m.clientX, m.clientY];
      };
      const end = () => {
        element.removeEventListener("pointermove", onMove);
        if (cursor) stage.classList.remove(cursor);
      };
      element.addEventListener("pointermove", onMove);
      element.addEventListener("lostpointercapture", end, { once: true });
    });
  }

  drag(wipeBar, (e) => {
    const box = stage.getBoundingClientRect();
    placeWipe((e.clientX - box.left) / box.width);
  });
  drag(stage, (e, dx, dy) => {
    view.x += dx;
    view.y += dy;
    view.fitted = false;
    hold();
    place();
  }, "panning");
  stage.addEventListener("wheel", (e) => {
    e.preventDefault();
    const box = stage.getBoundingClientRect();
    const lines = e.deltaMode === 1 ? 30 : e.deltaMode === 2 ? 400 : 1;
    const turn = Math.max(-300, Math.min(300, e.deltaY * lines));
    zoom(Math.exp(-0.0018 * turn), e.clientX - box.left, e.clientY - box.top);
  }, { passive: false });
  stage.addEventListener("pointermove", (e) => {
    const box = stage.getBoundingClientRect();
    const x = Math.floor((e.clientX - box.left - view.x) / view.scale);
    const y = Math.floor((e.clientY - box.top - view.y) / view.scale);
    $("where").textContent = x >= 0 && y >= 0 && x < width && y < height ? `x ${x}  y ${y}` : "";
  });
  stage.addEventListener("pointerleave", () => { $("where").textContent = ""; });
  wipeBar.addEventListener("keydown", wipeKey);
  document.addEventListener("keydown", key);
  $("show-error").addEventListener("click", () => toggleError(false));
  $("show-view").addEventListener("click", () => nextView(false));
  $("show-view").hidden = $("key-view").hidden = views.length === 0;
  $("swap").addEventListener("click", swap);
  $("fit").addEventListener("click", fit);
  $("zoom-in").addEventListener("click", () => zoom(1.25));
  $("zoom-out").addEventListener("click", () => zoom(0.8));

  stage.style.aspectRatio = `${width} / ${height}`;
  placeWipe(0.5);
  draw("left");
  draw("right");
  new ResizeObserver(() => (view.fitted ? fit() : place())).observe(stage);
  fit();
  return { showCrop, showView, pictures, items, crops };
})();
