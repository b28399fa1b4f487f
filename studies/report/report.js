/* Fills the charts of a report from its data, and makes its tables sortable. */
(function () {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const spoken = document.getElementById("spoken");
  const { shown, said, tickText, paint } = figures;

  function choice(controls, label, options, chosen, changed) {
    const select = controls.append("label").text(label + " ").append("select").on("change", function () { changed(this.value); });
    select.selectAll("option").data(options).enter().append("option").attr("value", (o) => o.value).property("selected", (o) => o.value === chosen).text((o) => o.text);
  }

  const mapPlace = (panel, column, row) => said(panel.x.label || "x", tickText(panel.x, panel.map.x[0] + panel.map.x[1] * column)) + "\n" + said(panel.y.label || "y", tickText(panel.y, panel.map.y[0] + panel.map.y[1] * row));
  const mapValues = (figure, column, row) => figure.panels.filter((panel) => panel.map).map((panel) => said(panel.title, shown(panel.map.values[row * panel.map.columns + column]))).join("\n");

  /* A chart is one figure, or one of several by choice; on paper small maps of all stand side by side. */
  function drawChart(plot, controls, chart, title) {
    const all = chart.figures, first = all[0].figure;
    const nodes = (figure) => { const panel = figure.panels.find((one) => one.map); return panel ? [panel.map.columns, panel.map.rows, panel.x.label, panel.y.label].join(" ") : ""; };
    const label = title + "; arrow keys select the values";
    const draw = (chosen) => {
      const same = all.filter((one) => nodes(one.figure) === nodes(chosen.figure));
      figures.draw(plot, chosen.figure, label, (figure, panel, column, row) => mapPlace(figure.panels.find((one) => one.map && one.x.label) || panel, column, row) + "\n" + (same.length === 1 ? mapValues(figure, column, row)
        : same.map((one) => (one === chosen ? "> " : "") + one.name + ": " + one.figure.panels.map((p) => shown(p.map.values[row * p.map.columns + column])).join(", ")).join("\n")));
    };
    if (all.length > 1) {
      choice(controls, "show", all.map((one) => ({ value: one.name, text: one.name })), all[0].name, (name) => draw(all.find((one) => one.name === name)));
      if (first.kind === "map") {
        const small = d3.select(plot.node().parentNode).append("div").attr("class", "maps").selectAll("div").data(all).enter().append("div");
        small.append("canvas").attr("width", (one) => one.figure.panels[0].map.columns).attr("height", (one) => one.figure.panels[0].map.rows).attr("aria-hidden", "true").each(function (one) { paint(this, one.figure.panels[0].map); });
        small.append("span").text((one) => { const map = one.figure.panels[0].map; return one.name + ", " + said(one.figure.panels[0].title, shown(map.low) + " to " + shown(map.high)); });
      }
    }
    if (first.kind === "chart" && !nodes(first)) d3.select(plot.node().parentNode).insert("p", ".alt").attr("class", "hint").text("Draw a box to zoom, double-click or press 0 to reset; + and - zoom, arrow keys select the values.");
    draw(all[0]);
  }

  document.querySelectorAll("figure.chart").forEach((figure) => {
    drawChart(d3.select(figure).select(".plot"), d3.select(figure).select(".controls"), data.charts[Number(figure.dataset.figures)], figure.querySelector("figcaption").textContent);
  });

  /* ---- pictures that blink ---- */
  document.querySelectorAll("figure.frames").forEach((figure) => {
    const pair = figure.querySelector(".pair"), controls = document.createElement("div"), button = document.createElement("button");
    let timer = null, first = true;
    const show = () => Array.from(pair.children).forEach((child, i) => child.classList.toggle("hidden", (i === 0) !== first));
    controls.className = "controls"; button.type = "button"; button.textContent = "Blink the two frames"; button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => {
      const on = timer === null;
      button.setAttribute("aria-pressed", String(on)); button.textContent = on ? "Side by side" : "Blink the two frames";
      pair.classList.toggle("blinking", on);
      if (on) { show(); timer = setInterval(() => { first = !first; show(); }, 500); } else { clearInterval(timer); timer = null; Array.from(pair.children).forEach((child) => child.classList.remove("hidden")); }
    });
    controls.append(button); figure.insertBefore(controls, pair);
  });

  /* ---- on paper nothing is folded away ---- */
  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = Array.from(document.querySelectorAll("details:not([open])"));
    opened.forEach((one) => { one.open = true; });
  });
  window.addEventListener("afterprint", () => opened.forEach((one) => { one.open = false; }));

  /* ---- tables ---- */
  document.querySelectorAll("table").forEach((table) => {
    const body = table.tBodies[0];
    if (body.rows.length < 2) return;
    const value = (row, i) => { const cell = row.cells[i], number = cell.dataset.value; return number === undefined ? cell.textContent : Number(number); };
    Array.from(table.tHead.rows[0].cells).forEach((head, i) => {
      const button = document.createElement("button");
      button.type = "button"; button.append(...head.childNodes); head.append(button);
      button.addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") === "ascending";
        Array.from(table.tHead.rows[0].cells).forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        const sorted = Array.from(body.rows).sort((a, b) => {
          const x = value(a, i), y = value(b, i);
          if (typeof x !== typeof y) return typeof x === "number" ? -1 : 1;  // unknown values are last
          return (down ? -1 : 1) * (typeof x === "number" ? x - y : x.localeCompare(y));
        });
        body.append(...sorted);
      });
    });
    if (!table.classList.contains("filtered")) return;
    const label = document.createElement("label"), input = document.createElement("input");
    label.className = "search"; label.textContent = "Rows that contain "; input.type = "search"; label.append(input);
    input.addEventListener("input", () => {
      const wanted = input.value.toLowerCase().split(/\s+/).filter(Boolean);
      let left = 0;
      Array.from(body.rows).forEach((row) => { const text = row.textContent.toLowerCase(); row.hidden = !wanted.every((word) => text.includes(word)); left += row.hidden ? 0 : 1; });
      spoken.textContent = left + " rows";
    });
    table.parentNode.parentNode.insertBefore(label, table.parentNode);
  });
})();
