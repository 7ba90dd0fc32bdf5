// Crops, table, charts: what surrounds the viewer.
(() => {
  const { items, pictures, crops } = viewer;

  function cropGrid() {
    // Only the first reference is shown here.
    const columns = items.map((v, i) => [v, i]).filter(
      ([v, i]) => (v.result || v.error) && (v.kind === "sampler" || i === 0));
    if (!crops.length || !columns.length) return;
    const grid = document.createElement("div");
    grid.className = "cropgrid";
    grid.style.gridTemplateColumns = `max-content repeat(${columns.length}, minmax(104px, 170px))`;
    const cell = (name, text) => {
      const e = document.createElement("div");
      e.className = name;
      e.textContent = text;
      grid.append(e);
      return e;
    };
    cell("", "");
    for (const [v] of columns) {
      const head = cell("colname", "");
      if (v.colour) {
        const mark = document.createElement("span");
        mark.className = "swatch" + (v.biased ? " hollow" : "");
        mark.style.setProperty("--c", v.colour);
        head.append(mark);
      }
      const small = document.createElement("small");
      small.textContent = (v.biased ? "biased, " : "") + (v.note || "\u00a0");
      const name = v.label.split(/(?<=[:,=])/).flatMap((part) => [part, document.createElement("wbr")]);
      head.append(...name, small);
    }
    const images = {};
    const load = (file) => (images[file] ??= new Promise((done) => {
      const image = new Image();
      image.onload = () => done(image);
      image.onerror = () => done(null);
      image.src = pictures[file];
    }));
    crops.forEach((crop, k) => {
      for (const kind of ["result", "error"]) {
        const above = kind === "result" && k > 0 ? " above" : "";
        cell("rowname" + above, kind === "result" ? `crop ${crop.name ?? k + 1}` : "error");
        for (const [v, i] of columns) {
          if (!v[kind]) {
            cell(above, "");
            continue;
          }
          const button = document.createElement("button");
          button.type = "button";
          button.className = above.trim();
          button.title = `${v.label}: show in the viewer`;
          button.setAttribute("aria-label", `crop ${crop.name ?? k + 1}, ${v.label}, ${kind}: show in the viewer`);
          const canvas = document.createElement("canvas");
          canvas.width = crop.x1 - crop.x0;
          canvas.height = crop.y1 - crop.y0;
          button.append(canvas);
          button.addEventListener("click", () => viewer.showCrop(crop, i, kind));
          grid.append(button);
          if (exposure.isRange(v[kind])) exposure.show(canvas, v[kind], crop.x0, crop.y0);
          else load(v[kind]).then((image) => image && canvas.getContext("2d").drawImage(image, -crop.x0, -crop.y0));
        }
      }
    });
    document.getElementById("crops").append(grid);
  }

  function inspectionViews() {
    for (const button of document.querySelectorAll("#inside button")) {
      const image = button.querySelector("img");
      image.src = pictures[image.dataset.file];
      button.addEventListener("click", () => viewer.showView(Number(button.dataset.item), button.dataset.view));
    }
  }

  function sortable() {
    const table = document.getElementById("summary"), body = table.tBodies[0];
    const heads = [...table.querySelectorAll(".heads th")];
    const sortBy = (k) => {
      const head = heads[k], up = head.getAttribute("aria-sort") !== "ascending";
      const numbers = head.dataset.kind === "number";
      const rows = [...body.rows].map((row) => ({ row, value: row.cells[k].dataset.value }));
      rows.sort((a, b) => {
        if (a.value === undefined || b.value === undefined) return (a.value === undefined) - (b.value === undefined);
        const order = numbers ? a.value - b.value : a.value.localeCompare(b.value, "en", { numeric: true });
        return up ? order : -order;
      });
      for (const h of heads) h.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      body.append(...rows.map((r) => r.row));
    };
    heads.forEach((head, k) => head.querySelector("button").addEventListener("click", () => sortBy(k)));
    const few = document.getElementById("few");
    few.addEventListener("change", () => {
      table.classList.toggle("few", few.checked);
      for (const h of table.querySelectorAll(".groups th")) {
        const n = Number(few.checked ? h.dataset.few : h.dataset.all);
        h.hidden = n === 0;
        h.colSpan = Math.max(n, 1);
      }
    });
  }

  // Pointing at a sampler in the table or in a chart lights it in all charts.
  function linkCharts() {
    const charts = [...document.querySelectorAll(".chart svg")], parts = [];
    for (const part of document.querySelectorAll(".chart svg [id]")) {
      const match = /^c\d+-(band|line|marks|tie|name|point|prepass|build|render)-(\d+)$/.exec(part.id);
      if (!match) continue;
      part.dataset.s = match[2];
      parts.push(part);
      part.addEventListener("pointerenter", () => light(match[2]));
      part.addEventListener("pointerleave", () => light(null));
    }
    function light(index) {
      for (const c of charts) c.classList.toggle("dim", index !== null);
      for (const p of parts) p.classList.toggle("lit", p.dataset.s === index);
    }
    for (const row of document.querySelectorAll("#summary tbody tr")) {
      row.addEventListener("pointerenter", () => light(row.dataset.index));
      row.addEventListener("pointerleave", () => light(null));
    }
  }

  cropGrid();
  inspectionViews();
  sortable();
  linkCharts();
  addEventListener("beforeprint", () => { for (const d of document.querySelectorAll("details")) d.open = true; });
})();
