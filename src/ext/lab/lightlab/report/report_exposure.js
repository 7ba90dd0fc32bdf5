"use strict";
// Pictures with range (Radiance files, packed), shown at one exposure that all of them share. Loaded before the viewer.
const data = JSON.parse(document.getElementById("data").textContent);
const exposure = (() => {
  const { pictures } = data;
  const loaded = {}, canvases = new Set();
  const shades = new Uint8Array(65536);  // of a pixel's exponent and mantissa, 8 bits each
  let stops = 0;

  function makeShades() {
    const scale = (data.exposure || 1) * 2 ** stops;
    for (let exponent = 1; exponent < 256; exponent++)
      for (let mantissa = 0; mantissa < 256; mantissa++) {
        const v = Math.min(1, scale * (mantissa + 0.5) * 2 ** (exponent - 136));
        const encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
        shades[256 * exponent + mantissa] = Math.round(255 * encoded);
      }
  }

  const isRange = (file) => Boolean(file) && file.endsWith(".hdr");

  // {width, height, pixels: four bytes each: red, green, blue, exponent}.
  async function unpack(text) {
    const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    let at = 0;
    const line = () => {
      const end = bytes.indexOf(10, at), text = String.fromCharCode(...bytes.subarray(at, end));
      at = end + 1;
      return text;
    };
    while (line() !== "");
    const [, height, width] = /^-Y (\d+) \+X (\d+)$/.exec(line()).map(Number);
    return { width, height, pixels: bytes.subarray(at) };
  }
  const load = (file) => (loaded[file] ??= unpack(pictures[file]));

  function paint(entry) {
    const { canvas, picture, x0, y0 } = entry;
    const context = canvas.getContext("2d"), shown = context.createImageData(canvas.width, canvas.height);
    for (let y = 0, to = 0; y < canvas.height; y++) {
      let from = 4 * ((y + y0) * picture.width + x0);
      for (let x = 0; x < canvas.width; x++, from += 4, to += 4) {
        const exponent = 256 * picture.pixels[from + 3];
        for (let c = 0; c < 3; c++) shown.data[to + c] = shades[exponent + picture.pixels[from + c]];
        shown.data[to + 3] = 255;
      }
    }
    context.putImageData(shown, 0, 0);
    entry.painted = stops;
    canvas.dataset.painted = String(stops);
  }

  // Keeps a canvas painted with a part of the picture. The returned function paints a canvas that was hidden before.
  function show(canvas, file, x0 = 0, y0 = 0) {
    const entry = { canvas, file, x0, y0, picture: null, painted: null };
    canvases.add(entry);
    const refresh = () => {
      if (entry.picture && entry.painted !== stops && getComputedStyle(canvas).visibility !== "hidden") paint(entry);
    };
    entry.refresh = refresh;
    load(file).then((picture) => {
      entry.picture = picture;
      refresh();
    });
    return refresh;
  }

  const slider = document.getElementById("exposure"), output = document.getElementById("stops");
  function set(value) {
    stops = Math.min(Number(slider.max), Math.max(Number(slider.min), value));
    slider.value = String(stops);
    output.textContent = `${stops > 0 ? "+" : stops < 0 ? "\u2212" : ""}${Math.abs(stops)} stops`;
    makeShades();
    for (const entry of canvases) entry.refresh();
  }
  slider.addEventListener("input", () => set(Number(slider.value)));
  slider.addEventListener("dblclick", () => set(0));
  set(0);
  return { show, isRange, change: (by) => set(stops + by), reset: () => set(0) };
})();
