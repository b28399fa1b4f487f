/* Draws a figure that figure_json.h describes, as SVG with values at the pointer and for the arrow keys. Requires d3. */
const figures = (function () {
  "use strict";
  const known = (x) => x !== null && x !== undefined && isFinite(x);
  const shown = (x) => (known(x) ? d3.format(".4~g")(x) : "unknown");
  /* "rms [px]" and 0.1 become "rms 0.1 px". */
  const said = (label, text) => { const m = /^(.*?) ?\[(.*)\]$/.exec(label); return m ? (m[1] + " " + text + " " + m[2]).trim() : (label + " " + text).trim(); };
  /* Dark greys are those of the page, which may be dark itself. */
  const ink = (colour) => { const c = d3.rgb(colour || "#202020"); return c.r === c.g && c.g === c.b && c.r < 160 ? (c.r < 80 ? "var(--text)" : "var(--quiet)") : colour; };

  /* ---- values at the pointer and for the arrow keys ---- */
  const spoken = document.getElementById("spoken");
  const tip = d3.select("body").append("div").attr("class", "tip").style("display", "none");
  function tell(text, at) {
    spoken.textContent = text;
    const box = at.getBoundingClientRect();
    tip.style("display", null).text(text).style("left", Math.min(box.left + window.scrollX + 12, window.innerWidth - 240) + "px").style("top", box.bottom + window.scrollY + 6 + "px");
  }
  const hush = () => tip.style("display", "none");
  function walk(svg, count, show, steps) {
    let at = -1;
    svg.on("keydown.walk", () => {
      const step = steps[d3.event.key];
      if (d3.event.key === "Escape") hush();
      if (!step || !count) return;
      at = at < 0 ? (step > 0 ? 0 : count - 1) : (at + step + count) % count;
      show(at); d3.event.preventDefault();
    }).on("blur", hush);
  }
  /* ---- figures ---- */
  const symbols = [d3.symbolCircle, d3.symbolSquare, d3.symbolTriangle, d3.symbolTriangle, d3.symbolDiamond];
  const dashes = { dashed: "6 5", dotted: "2 4" };
  const areas = ["band", "bars", "boxes"];
  function text(parent, one, x, y, anchor) {
    const lines = String(one.text).split("\n");
    const node = parent.append("text").attr("x", x).attr("y", y).attr("text-anchor", anchor || { left: "start", right: "end" }[one.align] || "middle").attr("dy", "0.35em")
      .style("font-size", (one.size || 13) + "px").style("font-weight", one.bold ? "bold" : null).style("fill", one.on_map ? one.colour : one.colour ? ink(one.colour) : null).classed("boxed", !!one.boxed);
    node.text(lines[0]);
    lines.slice(1).forEach((line) => node.append("tspan").attr("x", x).attr("dy", "1.15em").text(line));
    return node;
  }
  /* Columns of the coordinates of a layer along x and y, for ranges that are automatic. */
  const extents = { line: [[0], [1]], points: [[0], [1]], errors: [[0], [1, 2, 3]], band: [[0], [1, 2]], bars: [[0], [1]], levels: [[0], [1]], boxes: [[0, 1], [2, 3]], arrows: [[0], [1]], spans: [[0], [1]], guides: [[0], []] };
  function scaleOf(axis, layers, direction, range) {
    const log = !!axis.logarithmic, ok = (v) => known(v) && (!log || v > 0);
    let low = axis.low, high = axis.high;
    if (!known(low) || !known(high)) {
      const values = [].concat(...layers.map((layer) => [].concat(...extents[layer.kind][direction].map((k) => layer.columns[k])))).filter(ok);
      if (direction === 1 && layers.some((layer) => layer.kind === "bars")) values.push(...(log ? [] : [0]));
      let [least, most] = d3.extent(values);
      if (least === undefined) [least, most] = log ? [1, 10] : [0, 1];
      if (least === most) [least, most] = log ? [least / 2, most * 2] : [least - Math.abs(least || 1) / 2, most + Math.abs(most || 1) / 2];
      const nice = (log ? d3.scaleLog() : d3.scaleLinear()).domain([known(low) ? low : least, known(high) ? high : most]).nice().domain();
      low = known(low) ? low : nice[0]; high = known(high) ? high : nice[1];
    }
    return (log ? d3.scaleLog() : d3.scaleLinear()).domain([low, high]).range(range);
  }
  /* Ticks as [at, text] within the range of a scale. */
  function ticksOf(axis, scale, count, zoomed) {
    const [a, b] = d3.extent(scale.domain()), slack = 1e-9 * Math.abs(b - a);
    const own = (axis.ticks || []).filter((one) => one[0] >= a - slack && one[0] <= b + slack);
    if (own.length > (zoomed ? 1 : 0)) return own;
    const format = scale.base ? scale.tickFormat(count, "~g") : d3.format("~g");
    return scale.ticks(count).map((v) => [v, format(v)]);
  }
  function drawAxis(svg, panel, axis, scale, box, along, zoomed) {
    const marks = axis.marks || "texts", horizontal = along === "x", ticks = marks === "none" ? [] : ticksOf(axis, scale, horizontal ? 8 : 6, zoomed);
    const group = svg.append("g").attr("class", "axis axis-" + along);
    const grid = panel.grid === "both" || (panel.grid === "horizontal" && !horizontal);
    let room = 8;
    for (const [at, words] of ticks) {
      const p = scale(at), one = group.append("g").attr("class", "tick");
      if (grid) one.append("line").attr("class", "gridline").attr(horizontal ? "x1" : "y1", p).attr(horizontal ? "x2" : "y2", p).attr(horizontal ? "y1" : "x1", horizontal ? box.top : box.left).attr(horizontal ? "y2" : "x2", horizontal ? box.bottom : box.right);
      if (marks !== "bare") one.append("line").attr(horizontal ? "x1" : "y1", p).attr(horizontal ? "x2" : "y2", p).attr(horizontal ? "y1" : "x1", horizontal ? box.bottom : box.left).attr(horizontal ? "y2" : "x2", horizontal ? box.bottom + 5 : box.left - 5);
      if (marks === "ticks" || !words) continue;
      const short = !horizontal && words.length > 24 ? words.slice(0, 23) + "…" : words, lines = short.split("\n");
      const node = text(one, { text: short, size: 12 }, horizontal ? p : box.left - 9, horizontal ? box.bottom + 15 : p, horizontal ? (axis.slanted ? "end" : "middle") : "end");
      if (short !== words) node.append("title").text(words);
      if (horizontal && axis.slanted) node.attr("transform", "rotate(-28 " + p + " " + (box.bottom + 12) + ")");
      room = Math.max(room, horizontal ? (axis.slanted ? 16 + 3.3 * words.length : 10 + 14 * lines.length) : 14 + 7 * short.length);
    }
    if (panel.border !== "none" && (horizontal || panel.border !== "bottom")) group.append("path").attr("class", "domain").attr("d", horizontal ? "M" + box.left + "," + box.bottom + "H" + box.right : "M" + box.left + "," + box.bottom + "V" + box.top);
    if (!axis.label) return;
    if (horizontal) text(svg, { text: axis.label, size: 13.5 }, (box.left + box.right) / 2, box.bottom + room + 14);
    else text(svg, { text: axis.label, size: 13.5 }, 0, 0).attr("transform", "translate(" + Math.max(12, box.left - room - 10) + "," + (box.top + box.bottom) / 2 + ") rotate(-90)");
  }
  /* Fills a canvas with the cells of a map; grey: unknown. */
  function paint(canvas, map) {
    const pen = canvas.getContext("2d"), picture = pen.createImageData(map.columns, map.rows), scale = map.logarithmic ? d3.scaleLog() : d3.scaleLinear();
    const share = scale.domain([map.low, map.high]).clamp(true), colour = d3.scaleLinear().domain(map.colours.map((c, i) => i / (map.colours.length - 1))).range(map.colours);
    const table = d3.range(256).map((i) => d3.rgb(colour(i / 255)));
    map.values.forEach((v, i) => { const c = known(v) ? table[Math.round(255 * (share(v) || 0))] : d3.rgb("#b8b8b8"); picture.data.set([c.r, c.g, c.b, 255], 4 * i); });
    pen.putImageData(picture, 0, 0);
    return table;
  }
  function drawMap(svg, map, box, x, y) {
    const canvas = document.createElement("canvas"), wide = x(map.x[0] + map.x[1] * (map.columns - 0.5)) - x(map.x[0] - map.x[1] / 2), tall = y(map.y[0] + map.y[1] * (map.rows - 0.5)) - y(map.y[0] - map.y[1] / 2);
    canvas.width = map.columns; canvas.height = map.rows;
    const table = paint(canvas, map);
    svg.append("image").attr("href", canvas.toDataURL()).attr("preserveAspectRatio", "none").attr("width", Math.abs(wide)).attr("height", Math.abs(tall))
      .attr("transform", "translate(" + x(map.x[0] - map.x[1] / 2) + "," + y(map.y[0] - map.y[1] / 2) + ") scale(" + Math.sign(wide) + "," + Math.sign(tall) + ")");
    if (map.bar === false) return;
    const scale = (map.logarithmic ? d3.scaleLog() : d3.scaleLinear()).domain([map.low, map.high]).range([box.bottom, box.top]), left = box.right + 10, step = (box.bottom - box.top) / 64;
    d3.range(64).forEach((i) => svg.append("rect").attr("x", left).attr("y", box.bottom - step * (i + 1)).attr("width", 13).attr("height", step + 0.5).attr("fill", table[4 * i + 2]));
    for (const [at, words] of ticksOf(map, scale, 5)) text(svg, { text: words, size: 11, align: "left" }, left + 18, scale(at));
  }
  function drawLayer(room, layer, x, y, floor) {
    const colour = ink(layer.colour), c = layer.columns, ok = (scale, v) => known(v) && (!scale.base || v > 0), width = layer.width || 2;
    const group = room.append("g").attr("fill", "none").attr("stroke", colour).attr("stroke-width", width).attr("stroke-dasharray", dashes[layer.dash] || null).attr("data-name", layer.name || null);
    const at = d3.range(c[0].length).filter((i) => ok(x, c[0][i]) && (layer.kind === "guides" || ok(y, c[1][i])));
    const clip = (v) => (ok(y, v) ? y(v) : floor);
    const rects = (left, right, low, high) => group.attr("stroke", "none").attr("fill", colour).attr("fill-opacity", known(layer.opacity) ? layer.opacity : 1).selectAll("rect").data(at).enter().append("rect")
      .attr("x", (i) => Math.min(left(i), right(i))).attr("width", (i) => Math.max(0.5, Math.abs(right(i) - left(i)))).attr("y", (i) => Math.min(low(i), high(i))).attr("height", (i) => Math.abs(high(i) - low(i)));
    const lines = (x1, x2, y1, y2) => group.selectAll("line").data(at).enter().append("line").attr("x1", x1).attr("x2", x2).attr("y1", y1).attr("y2", y2);
    if (layer.kind === "line") group.append("path").attr("d", d3.line().defined((v, i) => ok(x, c[0][i]) && ok(y, c[1][i])).x((v, i) => x(c[0][i])).y((v, i) => y(c[1][i]))(c[0]));
    if (layer.kind === "band") group.attr("stroke", "none").attr("fill", colour).attr("fill-opacity", known(layer.opacity) ? layer.opacity : 1).append("path").attr("d", d3.area().defined((v, i) => ok(x, v) && known(c[1][i]) && known(c[2][i])).x((v) => x(v)).y0((v, i) => clip(c[1][i])).y1((v, i) => clip(c[2][i]))(c[0]));
    if (layer.kind === "errors") lines((i) => x(c[0][i]), (i) => x(c[0][i]), (i) => clip(c[2][i]), (i) => clip(c[3][i]));
    if (layer.kind === "levels") lines((i) => x(c[0][i] - c[2][i]), (i) => x(c[0][i] + c[2][i]), (i) => y(c[1][i]), (i) => y(c[1][i]));
    if (layer.kind === "guides") lines((i) => x(c[0][i]), (i) => x(c[0][i]), y.range()[0], y.range()[1]);
    if (layer.kind === "arrows" || layer.kind === "spans") lines((i) => x(c[0][i]), (i) => x(c[0][i] + c[2][i]), (i) => y(c[1][i]), (i) => y(c[1][i] + c[3][i])).attr("marker-end", "url(#head)").attr("marker-start", layer.kind === "spans" ? "url(#head)" : null);
    if (layer.kind === "bars") rects((i) => x(c[0][i] - c[2][i] / 2), (i) => x(c[0][i] + c[2][i] / 2), () => (y.base ? floor : y(0)), (i) => y(c[1][i]));
    if (layer.kind === "boxes") rects((i) => x(c[0][i]), (i) => x(c[1][i]), (i) => clip(c[2][i]), (i) => clip(c[3][i]));
    if (layer.marker && ["line", "points", "errors"].includes(layer.kind)) {
      const kind = Math.max(0, layer.marker - 1), hollow = kind >= symbols.length, area = layer.marker < 0 ? 3 : 52 * (layer.size || 1);
      room.append("g").attr("data-name", layer.name || null).attr("fill", hollow ? "none" : colour).attr("stroke", hollow ? colour : "none").attr("stroke-width", 1.4).selectAll("path").data(at).enter().append("path")
        .attr("transform", (i) => "translate(" + x(c[0][i]) + "," + y(c[1][i]) + ")" + (kind % 5 === 3 ? "rotate(180)" : "")).attr("d", d3.symbol().type(symbols[kind % 5]).size(area));
    }
    return at;
  }
  function drawLegend(svg, figure, panel, box, hidden, redraw) {
    const place = (panel.legend || {}).place || "none", layers = panel.layers.filter((layer) => layer.name);
    if (place === "none" || !layers.length) return;
    const long = (layer) => 40 + 6.7 * layer.name.length, column = d3.max(layers, long), step = 18, side = panel.legend.horizontal;
    const columns = side ? Math.max(1, Math.min(layers.length, Math.floor((box.right - box.left) / column))) : 1, rows = Math.ceil(layers.length / columns), wide = columns * column;
    const left = place.endsWith("right") && place !== "right" ? box.right - wide - 6 : place === "right" ? box.right + 14 : place === "below" ? (box.left + box.right - wide) / 2 : place === "above" ? box.left : box.left + 12;
    const top = place.startsWith("above") ? (panel.equal ? box.top - rows * step : panel.legend.top) + 8 : place === "below" ? figure.height - 8 - rows * step + 9 : place.startsWith("bottom") ? box.bottom - 10 - rows * step + 9 : box.top + 14;
    layers.forEach((layer, i) => {
      const x = left + (i % columns) * column, y = top + Math.floor(i / columns) * step, off = hidden.has(layer.name);
      const one = svg.append("g").attr("class", "entry").attr("opacity", off ? 0.35 : 1).on("click", () => { if (!hidden.delete(layer.name)) hidden.add(layer.name); redraw(); });
      one.append("title").text(off ? "show" : "hide");
      if (areas.includes(layer.kind)) one.append("rect").attr("x", x).attr("y", y - 5).attr("width", 24).attr("height", 10).attr("fill", ink(layer.colour)).attr("fill-opacity", known(layer.opacity) ? layer.opacity : 1);
      else drawLayer(one, Object.assign({}, layer, { kind: layer.kind === "points" ? "points" : "line", columns: [[0, 24].map((v) => (layer.kind === "points" ? 12 : v)), [0, 0]] }), d3.scaleLinear().domain([0, 24]).range([x, x + 24]), d3.scaleLinear().range([y, y]), y);
      text(one, { text: layer.name, size: 12.5, align: "left" }, x + 30, y);
    });
  }
  const tickText = (axis, v) => { const found = (axis.ticks || []).find((one) => Math.abs(one[0] - v) <= 1e-9 * Math.abs(v)); return found ? found[1].replace(/\n/g, " ") : shown(v); };
  function pointText(figure, panel, layer, i) {
    if (layer.notes && layer.notes[i]) return layer.notes[i];
    const label = (along) => panel[along].label || (figure.panels.map((one) => one[along].label).find((one) => one) || along), c = layer.columns;
    const near = layer.kind === "bars" && panel.x.ticks && panel.x.ticks.length ? Math.round(c[0][i]) : c[0][i];
    const words = label("x") === "x" && panel.x.ticks ? tickText(panel.x, near) : said(label("x"), tickText(panel.x, near));
    const span = layer.kind === "errors" && c[3][i] > c[2][i] ? "\n" + shown(c[2][i]) + " to " + shown(c[3][i]) : "";
    return (layer.name ? layer.name + "\n" : "") + words + "\n" + said(label("y"), shown(c[1][i])) + span;
  }

  /* True for a line between points that the next layer shows with their errors. */
  const connects = (layers, layer) => { const next = layers[layers.indexOf(layer) + 1]; return layer.kind === "line" && !layer.name && !!next && next.kind === "errors" && next.colour === layer.colour; };

  /* Draws a figure; everything it needs is in its data. State: ranges of the panels and layers that are hidden, as chosen. */
  function drawFigure(plot, figure, label, mapText, state) {
    state = state || { ranges: {}, hidden: new Set() };
    const redraw = () => { drawFigure(plot, figure, label, mapText, state); plot.select("svg").node().focus({ preventScroll: true }); };
    plot.selectAll("*").remove();
    const svg = plot.append("svg").attr("viewBox", "0 0 " + figure.width + " " + figure.height).style("max-width", 1.25 * figure.width + "px").attr("role", "img").attr("aria-label", label).attr("tabindex", 0);
    svg.append("defs").append("marker").attr("id", "head").attr("viewBox", "0 0 8 8").attr("refX", 8).attr("refY", 4).attr("markerUnits", "userSpaceOnUse").attr("markerWidth", 9).attr("markerHeight", 9).attr("orient", "auto-start-reverse").append("path").attr("d", "M0,1L8,4L0,7z").attr("fill", "context-stroke");
    const marks = [], maps = [], zooms = [];
    figure.panels.forEach((panel, k) => {
      const box = Object.assign({}, panel.box), layers = panel.layers.filter((layer) => !state.hidden.has(layer.name || (panel.layers.find((one) => one.name && one.colour === layer.colour) || {}).name));
      const zoomed = state.ranges[k];
      let x = scaleOf(zoomed ? Object.assign({}, panel.x, zoomed.x) : panel.x, layers, 0, [box.left, box.right]), y = scaleOf(zoomed ? Object.assign({}, panel.y, zoomed.y) : panel.y, layers, 1, [box.bottom, box.top]);
      if (panel.equal) {
        const [a, b] = x.domain(), [c, d] = y.domain(), scale = Math.min((box.right - box.left) / Math.abs(b - a), (box.bottom - box.top) / Math.abs(d - c));
        const middle = (box.left + box.right) / 2, centre = (box.top + box.bottom) / 2;
        Object.assign(box, { left: middle - (scale * Math.abs(b - a)) / 2, right: middle + (scale * Math.abs(b - a)) / 2, top: centre - (scale * Math.abs(d - c)) / 2, bottom: centre + (scale * Math.abs(d - c)) / 2 });
        x.range([box.left, box.right]); y.range([box.bottom, box.top]);
      }
      drawAxis(svg, panel, panel.x, x, box, "x", zoomed); drawAxis(svg, panel, panel.y, y, box, "y", zoomed);
      if (panel.title) text(svg, { text: panel.title, size: panel.map ? 13 : 14, bold: !panel.map }, (box.left + box.right) / 2, panel.box.top - 16);
      const clip = "clip" + Math.random().toString(36).slice(2);
      svg.append("clipPath").attr("id", clip).append("rect").attr("x", box.left - 6).attr("y", box.top - 6).attr("width", box.right - box.left + 12).attr("height", box.bottom - box.top + 12);
      if (!panel.map && !panel.equal) {
        zooms.push({ k: k, x: x, y: y });
        svg.append("g").attr("class", "brush").call(d3.brush().extent([[box.left, box.top], [box.right, box.bottom]]).on("end", () => {
          const area = d3.event.selection;
          if (!area) return;
          state.ranges[k] = { x: { low: x.invert(area[0][0]), high: x.invert(area[1][0]) }, y: { low: y.invert(area[1][1]), high: y.invert(area[0][1]) } };
          redraw();
        }));
      }
      const room = svg.append("g").attr("pointer-events", "none").attr("clip-path", panel.border === "none" ? null : "url(#" + clip + ")");
      if (panel.map) drawMap(svg, panel.map, box, x, y);
      for (const layer of layers) {
        const drawn = drawLayer(room, layer, x, y, box.bottom);
        if (connects(layers, layer) || figure.kind === "drawing" || !["line", "points", "errors", "bars", "levels"].includes(layer.kind) || drawn.length > 3000 || (layer.notes && !layer.notes.length)) continue;
        for (const i of drawn) {
          const wide = layer.kind === "bars" ? Math.abs(x(layer.columns[0][i] + layer.columns[2][i]) - x(layer.columns[0][i])) : 11, px = x(layer.columns[0][i]), py = y(layer.columns[1][i]);
          const zero = layer.kind === "bars" ? (y.base ? box.bottom : y(0)) : py;
          if (px < box.left - 1 || px > box.right + 1 || py < box.top - 1 || py > box.bottom + 1) continue;
          marks.push({ x: px - wide / 2, wide: wide, y: layer.kind === "bars" ? Math.min(py, zero) : py - 5.5, tall: layer.kind === "bars" ? Math.max(1, Math.abs(zero - py)) : 11, text: pointText(figure, panel, layer, i) });
        }
      }
      for (const one of panel.texts || []) text(svg, one, x(one.x) + (one.right || 0), y(one.y) + (one.down || 0)).attr("pointer-events", "none");
      if (panel.map) maps.push({ panel: panel, x: x, y: y, box: box });
      drawLegend(svg, figure, panel, box, state.hidden, redraw);
    });
    for (const one of figure.texts || []) text(svg, one, one.x, one.y);
    const targets = svg.append("g").selectAll("rect").data(marks).enter().append("rect").attr("class", "mark").attr("x", (m) => m.x).attr("y", (m) => m.y).attr("width", (m) => m.wide).attr("height", (m) => m.tall);
    targets.on("mouseenter", function (m) { tell(m.text, this); }).on("mouseleave", hush);
    if (!maps.length) walk(svg, marks.length, (i) => { targets.classed("chosen", (m, k) => k === i); tell(marks[i].text, targets.nodes()[i]); }, { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 });
    for (const one of maps) {
      const map = one.panel.map, frame = svg.append("rect").attr("class", "chosen").attr("fill", "none").attr("pointer-events", "none").style("display", "none");
      const show = (i) => {
        const column = i % map.columns, row = Math.floor(i / map.columns), px = one.x(map.x[0] + map.x[1] * column), py = one.y(map.y[0] + map.y[1] * row);
        const wide = Math.abs(one.x(map.x[1]) - one.x(0)), tall = Math.abs(one.y(map.y[1]) - one.y(0));
        frame.attr("x", px - wide / 2).attr("y", py - tall / 2).attr("width", wide).attr("height", tall).style("display", null);
        tell(mapText(figure, one.panel, column, row), frame.node());
      };
      svg.append("rect").attr("class", "cells").attr("x", one.box.left).attr("y", one.box.top).attr("width", one.box.right - one.box.left).attr("height", one.box.bottom - one.box.top).attr("fill", "transparent").on("mousemove", function () {
        const [px, py] = d3.mouse(this), column = Math.round((one.x.invert(px) - map.x[0]) / map.x[1]), row = Math.round((one.y.invert(py) - map.y[0]) / map.y[1]);
        if (column >= 0 && row >= 0 && column < map.columns && row < map.rows) show(row * map.columns + column);
      }).on("mouseleave", () => { frame.style("display", "none"); hush(); });
      if (one === maps[0]) walk(svg, map.values.length, show, { ArrowRight: 1, ArrowLeft: -1, ArrowDown: one.y(map.y[1]) > one.y(0) ? map.columns : -map.columns, ArrowUp: one.y(map.y[1]) > one.y(0) ? -map.columns : map.columns });
    }
    svg.on("dblclick", () => { state.ranges = {}; redraw(); }).on("keydown.zoom", () => {
      const key = d3.event.key, closer = (s) => { const [a, b] = s.range(), c = (a + b) / 2, h = ((b - a) / 2) * (key === "+" ? 0.6 : 1 / 0.6); return { low: s.invert(c - h), high: s.invert(c + h) }; };
      if (key === "0") state.ranges = {};
      else if (key === "+" || key === "-") zooms.forEach((one) => { state.ranges[one.k] = { x: closer(one.x), y: closer(one.y) }; });
      else return;
      d3.event.preventDefault(); redraw();
    });
  }

  return { draw: drawFigure, paint: paint, known: known, shown: shown, said: said, tickText: tickText };
})();
