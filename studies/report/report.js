/* Fills the charts of a report from its data, and makes its tables sortable. */
(function () {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#808080"];
  const spoken = document.getElementById("spoken");
  const { known, shown, said, tickText, paint } = figures;

  function choice(controls, label, options, chosen, changed) {
    const select = controls.append("label").text(label + " ").append("select").on("change", function () { changed(this.value); });
    select.selectAll("option").data(options).enter().append("option").attr("value", (o) => o.value).property("selected", (o) => o.value === chosen).text((o) => o.text);
  }
  function tick(controls, label, changed) {
    const box = controls.append("label");
    box.append("input").attr("type", "checkbox").on("change", function () { changed(this.checked); });
    box.append("span").text(" " + label);
  }

  const mapPlace = (panel, column, row) => said(panel.x.label || "x", tickText(panel.x, panel.map.x[0] + panel.map.x[1] * column)) + "\n" + said(panel.y.label || "y", tickText(panel.y, panel.map.y[0] + panel.map.y[1] * row));
  const mapValues = (figure, column, row) => figure.panels.filter((panel) => panel.map).map((panel) => said(panel.title, shown(panel.map.values[row * panel.map.columns + column]))).join("\n");

  /* A chart is one figure, or one of several by choice; on paper small maps of all stand side by side. */
  function drawChart(plot, controls, chart, title) {
    const all = chart.figures, first = all[0].figure;
    const size = (figure) => { const panel = figure.panels.find((one) => one.map); return panel ? panel.map.columns + " " + panel.map.rows : ""; };
    const label = title + "; arrow keys select the values";
    const draw = (chosen) => {
      const same = all.filter((one) => size(one.figure) === size(chosen.figure));
      figures.draw(plot, chosen.figure, label, (figure, panel, column, row) => mapPlace(figure.panels.find((one) => one.map && one.x.label) || panel, column, row) + "\n" + (same.length === 1 ? mapValues(figure, column, row)
        : same.map((one) => (one === chosen ? "> " : "") + one.name + ": " + one.figure.panels.map((p) => shown(p.map.values[row * p.map.columns + column])).join(", ")).join("\n")));
    };
    if (all.length > 1) {
      choice(controls, "show", all.map((one) => ({ value: one.name, text: one.name })), all[0].name, (name) => draw(all.find((one) => one.name === name)));
      if (size(first)) {
        const small = d3.select(plot.node().parentNode).append("div").attr("class", "maps").selectAll("div").data(all).enter().append("div");
        small.append("canvas").attr("width", (one) => one.figure.panels[0].map.columns).attr("height", (one) => one.figure.panels[0].map.rows).attr("aria-hidden", "true").each(function (one) { paint(this, one.figure.panels[0].map); });
        small.append("span").text((one) => { const map = one.figure.panels[0].map; return one.name + ", " + said(one.figure.panels[0].title, shown(map.low) + " to " + shown(map.high)); });
      }
    }
    draw(all[0]);
  }

  /* ---- studies: figures of any measure, composed from the cases ---- */
  const rows = (data.rows || []).filter((row) => row.status === "ok");
  const measure = (row, name) => row.m[data.measures.findIndex((one) => one.name === name)];
  const labelled = (name) => { const m = data.measures.find((one) => one.name === name); return m && m.unit !== "1" ? name + " [" + m.unit + "]" : name; };
  const free = (data.axes || []).filter((axis) => axis.labels.length > 1);
  const axisOf = (key) => data.axes.find((axis) => axis.key === key);
  const place = (row, axis) => row.v[data.axes.indexOf(axis)];
  const measures = () => data.measures.map((one) => ({ value: one.name, text: labelled(one.name) }));
  const keys = (list) => list.map((axis) => ({ value: axis.key, text: axis.title }));
  /* Quantiles of a measure in some cases. */
  function spread(of, name) {
    const values = of.map((row) => measure(row, name)).filter(known).sort(d3.ascending);
    return { n: values.length, y: d3.quantile(values, 0.5), low: d3.quantile(values, 0.1), high: d3.quantile(values, 0.9) };
  }
  const evenly = (ticks, most) => ticks.filter((one, i) => i % Math.ceil(ticks.length / most) === 0);
  function axisFigure(axis) {
    if (!axis.numeric) return { label: axis.title, low: -0.5, high: axis.labels.length - 0.5, ticks: evenly(axis.labels.map((label, i) => [i, label]), 12), slanted: d3.max(axis.labels, (label) => label.length) * Math.min(12, axis.labels.length) > 100 };
    const [low, high] = d3.extent(axis.numbers), margin = axis.logarithmic ? Math.pow(high / low, 0.04) : 0.04 * (high - low);
    return { label: axis.title, low: axis.logarithmic ? low / margin : low - margin, high: axis.logarithmic ? high * margin : high + margin, logarithmic: axis.logarithmic, ticks: axis.labels.length <= 12 ? axis.labels.map((label, i) => [axis.numbers[i], label]) : [] };
  }
  const page = (panel, legend) => ({ width: 920, height: 420 + 18 * legend, panels: [Object.assign({ box: { left: 84, right: 902, top: 14 + 18 * legend, bottom: 356 + 18 * legend }, legend: { place: "above", top: 0, horizontal: true }, layers: [] }, panel)] });
  const first = (list, k) => (list[k] ? list[k].key : "");
  const numeric = free.find((axis) => axis.numeric) || free[0];

  /* Medians of a measure over an axis, with a curve for each value of another. guide: a value that would be right */
  function curves(chosen, guide) {
    const axis = axisOf(chosen.x), by = chosen.by && chosen.by !== chosen.x ? axisOf(chosen.by) : null, layers = [], lines = [];
    const series = by ? by.labels.map((label, i) => ({ name: by.title + " " + label, of: rows.filter((row) => place(row, by) === i) })) : [{ name: "all cases", of: rows }];
    series.forEach((one, k) => {
      const points = axis.labels.map((label, i) => Object.assign({ label: label, x: axis.numeric ? axis.numbers[i] : i + (k - (series.length - 1) / 2) * Math.min(0.12, 0.6 / series.length) }, spread(one.of.filter((row) => place(row, axis) === i), chosen.y))).filter((p) => p.n > 0 && known(p.x));
      if (!points.length) return;
      const column = (name) => points.map((p) => p[name]), notes = points.map((p) => said(axis.title, p.label) + (by ? "\n" + one.name : "") + "\n" + said(labelled(chosen.y), shown(p.y)) + (p.n > 1 ? "\n10 to 90 %: " + shown(p.low) + " to " + shown(p.high) + ", " + p.n + " cases" : ""));
      const look = { colour: colours[k % colours.length], name: one.name, marker: 1, notes: notes };
      if (axis.numeric) layers.push({ kind: "band", columns: [column("x"), column("low"), column("high")], colour: look.colour, opacity: 0.14 });
      lines.push(Object.assign({ kind: axis.numeric ? "line" : "errors", columns: [column("x"), column("y"), column("low"), column("high")] }, look));
    });
    const x = axisFigure(axis), right = guide && chosen.y === guide.measure;
    if (right) layers.push({ kind: "line", columns: [[x.low, x.high], [guide.value, guide.value]], colour: colours[6], dash: "dashed", width: 1.5, name: guide.text, notes: [] });
    const all = layers.concat(lines), least = d3.min([].concat(...lines.map((layer) => layer.columns[2])));
    const names = all.map((layer) => layer.name).filter(Boolean), wide = 40 + 6.7 * d3.max(names.concat(""), (name) => name.length);
    return page({ x: x, y: { label: labelled(chosen.y), logarithmic: chosen.log, low: chosen.log || least < 0 ? null : 0 }, grid: "horizontal", layers: all }, Math.ceil(names.length / Math.max(1, Math.floor(818 / wide))));
  }
  function cells(chosen) {
    const x = axisOf(chosen.x), y = axisOf(chosen.y), names = (axis) => ({ label: axis.title, low: -0.5, high: axis.labels.length - 0.5, ticks: evenly(axis.labels.map((label, i) => [i, label]), 12), marks: "bare" });
    const values = [].concat(...y.labels.map((b, j) => x.labels.map((a, i) => { const v = spread(rows.filter((row) => place(row, x) === i && place(row, y) === j), chosen.m).y; return known(v) ? v : null; })));
    const [low, high] = d3.extent(values.filter(known)), end = high > low ? high : low + Math.abs(low || 1);
    const texts = values.length > 150 ? [] : values.map((v, i) => ({ text: known(v) ? d3.format(".2~g")(v) : "", x: i % x.labels.length, y: Math.floor(i / x.labels.length), size: 12, on_map: true, colour: v > (low + end) / 2 ? "#101010" : "#f4f4f4" }));
    const map = { columns: x.labels.length, rows: y.labels.length, values: values, x: [0, 1], y: [0, 1], colours: d3.range(9).map((i) => d3.interpolateViridis(i / 8)), low: low, high: end };
    return page({ box: { left: 180, right: 820, top: 14, bottom: 356 }, x: names(x), y: names(y), title: "", map: map, texts: texts }, 0);
  }
  function scatter(chosen) {
    const of = rows.filter((row) => known(measure(row, chosen.x)) && known(measure(row, chosen.y)));
    const columns = [chosen.x, chosen.y].map((name) => of.map((row) => measure(row, name)));
    const notes = of.map((row) => "case " + row.case + "\n" + data.axes.map((axis, k) => said(axis.title, axis.labels[row.v[k]])).concat([chosen.x, chosen.y].map((name) => said(labelled(name), shown(measure(row, name))))).join("\n"));
    const axis = (name) => ({ label: labelled(name), logarithmic: chosen.log });
    return page({ x: axis(chosen.x), y: axis(chosen.y), grid: "horizontal", layers: [{ kind: "points", columns: columns, colour: colours[0], marker: 1, size: 0.9, notes: notes }] }, 0);
  }
  const composed = {
    curves: { of: (chosen) => curves(chosen), chosen: { x: numeric && numeric.key, y: data.main, by: first(free.filter((axis) => axis !== numeric), 0) }, choices: [["over", "x", keys(free)], ["measure", "y"], ["a curve for each", "by", [{ value: "", text: "nothing" }].concat(keys(free))]], log: true, hint: "Points are medians, bands or bars reach from 10 to 90 % of the cases. Draw a box to zoom, double-click or press 0 to reset; + and - zoom, arrow keys select the points." },
    cells: { of: cells, chosen: { x: first(free, 0), y: first(free, 1), m: data.main }, choices: [["across", "x", keys(free)], ["upwards", "y", keys(free)], ["measure", "m"]], hint: "Medians of the cases." },
    scatter: { of: scatter, chosen: { x: data.second || data.main, y: data.main }, choices: [["across", "x"], ["upwards", "y"]], log: true, hint: "" }
  };
  composed.coverage = Object.assign({}, composed.curves, { of: (chosen) => curves(chosen, { measure: data.coverage, value: 0.6827, text: "68 %, as standard uncertainties of normal errors cover" }), chosen: Object.assign({}, composed.curves.chosen, { y: data.coverage }) });
  function drawComposed(plot, controls, kind, title) {
    const chosen = Object.assign({ log: false }, kind.chosen);
    const draw = () => {
      figures.draw(plot, kind.of(chosen), title + "; arrow keys select the values", (figure, panel, column, row) => mapPlace(panel, column, row) + "\n" + said(labelled(chosen.m), shown(panel.map.values[row * panel.map.columns + column])));
    };
    for (const [label, key, options] of kind.choices) choice(controls, label, options || measures(), chosen[key], (v) => { chosen[key] = v; draw(); });
    if (kind.log) tick(controls, "logarithmic", (on) => { chosen.log = on; draw(); });
    if (kind.hint) d3.select(plot.node().parentNode).insert("p", ".alt").attr("class", "hint").text(kind.hint);
    draw();
  }

  document.querySelectorAll("figure.chart").forEach((figure) => {
    const plot = d3.select(figure).select(".plot"), controls = d3.select(figure).select(".controls"), title = figure.querySelector("figcaption").textContent, kind = figure.dataset.chart;
    if (composed[kind]) drawComposed(plot, controls, composed[kind], title);
    else drawChart(plot, controls, data.charts[Number(figure.dataset.figures)], title);
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
