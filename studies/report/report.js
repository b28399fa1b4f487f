/* Draws the charts of a report from the data that stand in it, and makes its tables sortable. */
(function () {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#808080"];
  const spoken = document.getElementById("spoken");
  const width = 920, height = 420, margin = { left: 84, right: 18, top: 14, bottom: 64 };
  const known = (x) => x !== null && x !== undefined && isFinite(x);
  // the default tick format has as many digits as the step requires, but one too few if the step is a rounded sum
  const plain = d3.format("~g");
  const ticked = (scale, count, format) => (format || scale.base ? scale.tickFormat(count, format || plain) : plain);
  const shown = (x) => (known(x) ? d3.format(".4~g")(x) : "unknown");
  const unit = (name) => { const m = data.measures && data.measures.find((one) => one.name === name); return m && m.unit !== "1" ? " [" + m.unit + "]" : ""; };

  /* ---- what all charts share ---- */
  const tip = d3.select("body").append("div").attr("class", "tip").style("display", "none");
  function tell(text, at) {
    spoken.textContent = text;
    const box = at.getBoundingClientRect();
    tip.style("display", null).text(text).style("left", Math.min(box.left + window.scrollX + 12, window.innerWidth - 240) + "px").style("top", box.bottom + window.scrollY + 6 + "px");
  }
  const hush = () => tip.style("display", "none");
  function choice(controls, label, options, chosen, changed) {
    const select = controls.append("label").text(label + " ").append("select").on("change", function () { changed(this.value); });
    select.selectAll("option").data(options).enter().append("option").attr("value", (o) => o.value).property("selected", (o) => o.value === chosen).text((o) => o.text);
    return select;
  }
  function tick(controls, label, on, changed) {
    const box = controls.append("label");
    box.append("input").attr("type", "checkbox").property("checked", on).on("change", function () { changed(this.checked); });
    box.append("span").text(" " + label);
  }
  function stage(plot, label) {
    plot.selectAll("*").remove();
    return plot.append("svg").attr("viewBox", "0 0 " + width + " " + height).attr("role", "img").attr("aria-label", label).attr("tabindex", 0);
  }
  function legend(plot, entries) {
    const keys = plot.append("div").attr("class", "legend").selectAll("span").data(entries).enter().append("span");
    keys.append("i").style("background", (e) => e.colour);
    keys.append("span").text((e) => e.text);
  }
  function axes(svg, x, y, xTitle, yTitle, xTicks, yTicks, xValues) {
    svg.selectAll(".axis, .grid, .title").remove();
    const bottom = d3.axisBottom(x), left = d3.axisLeft(y);
    if (xValues) bottom.tickValues(xValues).tickFormat(xTicks); else if (x.ticks) bottom.ticks(8).tickFormat(ticked(x, 8, xTicks)); else bottom.tickFormat(xTicks || null);
    if (y.ticks) left.ticks(6).tickFormat(ticked(y, 6, yTicks)); else left.tickFormat(yTicks || null);
    if (y.ticks) svg.append("g").attr("class", "grid").attr("transform", "translate(" + margin.left + ",0)").call(d3.axisLeft(y).ticks(6).tickSize(-(width - margin.left - margin.right)).tickFormat(""));
    svg.append("g").attr("class", "axis").attr("transform", "translate(0," + (height - margin.bottom) + ")").call(bottom).selectAll("text").attr("font-size", 12)
      .each(function () { const text = d3.select(this), full = text.text(); if (full.length > 22) text.text(full.slice(0, 21) + "…").append("title").text(full); });
    svg.append("g").attr("class", "axis").attr("transform", "translate(" + margin.left + ",0)").call(left).selectAll("text").attr("font-size", 12);
    svg.append("text").attr("class", "title").attr("x", (margin.left + width - margin.right) / 2).attr("y", height - 14).attr("text-anchor", "middle").text(xTitle);
    svg.append("text").attr("class", "title").attr("transform", "translate(16," + (height - margin.bottom) / 2 + ") rotate(-90)").attr("text-anchor", "middle").text(yTitle);
  }
  /* Marks are told one after the other with the arrow keys, and where the pointer is. */
  function walkable(svg, marks, text) {
    let at = -1;
    const show = (i) => { const nodes = marks.nodes(); if (!nodes.length) return; at = (i + nodes.length) % nodes.length; marks.classed("chosen", (d, k) => k === at); tell(text(marks.data()[at]), nodes[at]); };
    marks.on("mouseenter", function (d) { tell(text(d), this); }).on("mouseleave", hush);
    svg.on("keydown.walk", function () {
      const key = d3.event.key;
      if (key === "ArrowRight" || key === "ArrowDown") show(at + 1);
      else if (key === "ArrowLeft" || key === "ArrowUp") show(at < 0 ? -1 : at - 1);
      else if (key === "Escape") { marks.classed("chosen", false); hush(); }
      else return;
      d3.event.preventDefault();
    }).on("blur", () => { marks.classed("chosen", false); hush(); });
  }
  const range = (values, logarithmic) => {
    let [low, high] = d3.extent(values.filter((v) => known(v) && (!logarithmic || v > 0)));
    if (low === undefined) return logarithmic ? [1, 10] : [0, 1];
    if (low === high) { low = logarithmic ? low / 2 : low - Math.abs(low || 1) / 2; high = logarithmic ? high * 2 : high + Math.abs(high || 1) / 2; }
    return [low, high];
  };

  /* ---- studies ---- */
  const rows = (data.rows || []).filter((row) => row.status === "ok");
  const measure = (row, name) => row.m[data.measures.findIndex((one) => one.name === name)];
  /* A term of the budget: after the passes that deform the frames, where there are such. */
  const termRms = (row, term) => {
    const after = measure(row, "budget.after_passes.terms." + term + ".rms_px");
    return known(after) ? after : measure(row, "budget.terms." + term + ".rms_px");
  };
  const free = (data.axes || []).filter((axis) => axis.labels.length > 1);
  const axisOf = (key) => data.axes.find((axis) => axis.key === key);
  const place = (row, axis) => row.v[data.axes.indexOf(axis)];
  const measures = () => data.measures.map((one) => ({ value: one.name, text: one.name + unit(one.name) }));
  const keys = (list) => list.map((axis) => ({ value: axis.key, text: axis.title }));
  const quantile = (values, q) => d3.quantile(values.slice().sort(d3.ascending), q);
  /* Median and the band from 10 to 90 % of a measure at every place of an axis. */
  function gathered(of, axis, name) {
    return axis.labels.map((label, i) => {
      const values = of.filter((row) => place(row, axis) === i).map((row) => measure(row, name)).filter(known);
      return { place: i, label: label, x: axis.numeric ? axis.numbers[i] : label, n: values.length, y: quantile(values, 0.5), low: quantile(values, 0.1), high: quantile(values, 0.9) };
    }).filter((point) => point.n > 0 && (!axis.numeric || known(point.x)));
  }
  function scaleOf(axis) {
    const across = [margin.left + 12, width - margin.right - 12];
    if (!axis.numeric) return d3.scalePoint().domain(axis.labels).range(across).padding(0.5);
    const numbers = axis.numbers.filter(known);
    return (axis.logarithmic ? d3.scaleLog() : d3.scaleLinear()).domain(range(numbers, axis.logarithmic)).range(across);
  }

  /* A measure over an axis. guide: a value that would be right, drawn across where that measure is shown */
  function curvesOf(plot, controls, first, guide) {
    const across = free.find((axis) => axis.numeric) || free[0], other = free.find((axis) => axis !== across);
    const chosen = { x: across.key, y: first, by: other ? other.key : "", log: false };
    let zoomed = null;
    const draw = () => {
      const axis = axisOf(chosen.x), by = chosen.by && chosen.by !== chosen.x ? axisOf(chosen.by) : null;
      const series = (by ? by.labels.map((label, i) => ({ label: label, rows: rows.filter((row) => place(row, by) === i) })) : [{ label: "all cases", rows: rows }])
        .map((one, i) => ({ label: one.label, colour: colours[i % colours.length], points: gathered(one.rows, axis, chosen.y) })).filter((one) => one.points.length);
      const all = [].concat(...series.map((one) => one.points));
      const svg = stage(plot, chosen.y + unit(chosen.y) + " over " + axis.title + "; arrow keys select the points");
      const x = scaleOf(axis);
      const y = (chosen.log ? d3.scaleLog() : d3.scaleLinear()).range([height - margin.bottom, margin.top]);
      const right = guide && chosen.y === first ? [guide.value] : [];
      const span = range([].concat(right, ...all.map((p) => [p.low, p.high])), chosen.log);
      y.domain(chosen.log || span[0] < 0 ? span : [0, span[1]]).nice();
      if (zoomed && x.invert) { x.domain(zoomed.x); y.domain(zoomed.y); }
      const few = !zoomed && axis.numeric && axis.labels.length <= 12;  // then the ticks are the values of the study
      axes(svg, x, y, axis.title, chosen.y + unit(chosen.y), few ? (v) => axis.labels[axis.numbers.indexOf(v)] : null, null, few ? axis.numbers.filter(known) : null);
      const clip = "clip" + Math.random().toString(36).slice(2);
      svg.append("clipPath").attr("id", clip).append("rect").attr("x", margin.left).attr("y", margin.top - 6).attr("width", width - margin.left - margin.right).attr("height", height - margin.top - margin.bottom + 12);
      if (x.invert) {
        svg.append("g").attr("class", "brush").call(d3.brush().extent([[margin.left, margin.top], [width - margin.right, height - margin.bottom]]).on("end", function () {
          const box = d3.event.selection;
          if (!box) return;
          zoomed = { x: [x.invert(box[0][0]), x.invert(box[1][0])], y: [y.invert(box[1][1]), y.invert(box[0][1])] };
          draw();
        }));
      }
      const room = svg.append("g").attr("clip-path", "url(#" + clip + ")");
      const positive = (v) => (chosen.log ? Math.max(v, y.domain()[0]) : v);
      right.forEach((value) => {
        room.append("line").attr("class", "guide").attr("x1", margin.left).attr("x2", width - margin.right).attr("y1", y(value)).attr("y2", y(value)).attr("stroke", colours[6]).attr("stroke-dasharray", "5 4").attr("pointer-events", "none");
      });
      // categories have no order: series are drawn side by side, each with its range as a bar
      const aside = axis.numeric ? 0 : Math.min(14, (x.step() * 0.6) / series.length);
      series.forEach((one, k) => one.points.forEach((p) => { p.at = x(p.x) + (k - (series.length - 1) / 2) * aside; }));
      for (const one of series) {
        if (axis.numeric) {
          room.append("path").datum(one.points).attr("fill", one.colour).attr("fill-opacity", 0.14).attr("pointer-events", "none").attr("d", d3.area().x((p) => p.at).y0((p) => y(positive(p.low))).y1((p) => y(positive(p.high))));
          room.append("path").datum(one.points).attr("fill", "none").attr("stroke", one.colour).attr("stroke-width", 2).attr("pointer-events", "none").attr("d", d3.line().x((p) => p.at).y((p) => y(positive(p.y))));
        } else {
          room.append("g").selectAll("line").data(one.points).enter().append("line").attr("stroke", one.colour).attr("stroke-width", 3).attr("stroke-opacity", 0.4).attr("pointer-events", "none").attr("x1", (p) => p.at).attr("x2", (p) => p.at).attr("y1", (p) => y(positive(p.low))).attr("y2", (p) => y(positive(p.high)));
        }
      }
      const points = [].concat(...series.map((one) => one.points.map((p) => Object.assign({ series: one.label, colour: one.colour }, p))));
      const marks = room.selectAll("circle").data(points).enter().append("circle").attr("r", 4.5).attr("cx", (p) => p.at).attr("cy", (p) => y(positive(p.y))).attr("fill", (p) => p.colour);
      walkable(svg, marks, (p) => axis.title + " " + p.label + (by ? ", " + by.title + " " + p.series : "") + "\n" + chosen.y + " " + shown(p.y) + unit(chosen.y) + (p.n > 1 ? "\n10 to 90 %: " + shown(p.low) + " to " + shown(p.high) + ", " + p.n + " cases" : ""));
      svg.on("dblclick", () => { zoomed = null; draw(); }).on("keydown.zoom", () => {
        const key = d3.event.key;
        if (key === "0") zoomed = null;
        else if ((key === "+" || key === "-") && x.invert) {
          const closer = (s) => { const [a, b] = s.range(), c = (a + b) / 2, h = ((b - a) / 2) * (key === "+" ? 0.6 : 1 / 0.6); return [s.invert(c - h), s.invert(c + h)]; };
          zoomed = { x: closer(x), y: closer(y) };
        } else return;
        d3.event.preventDefault(); draw(); plot.select("svg").node().focus();
      });
      legend(plot, series.map((one) => ({ colour: one.colour, text: by ? by.title + " " + one.label : one.label })));
      plot.append("p").attr("class", "hint").text((axis.numeric ? "Lines" : "Points") + " are medians, " + (axis.numeric ? "bands" : "bars") + " reach from 10 to 90 % of the cases" + (right.length ? "; dashed: " + guide.text : "") + ". Draw a box to zoom, double-click or press 0 to reset; + and - zoom, arrow keys select the points.");
    };
    choice(controls, "over", keys(free), chosen.x, (v) => { chosen.x = v; zoomed = null; draw(); });
    choice(controls, "measure", measures(), chosen.y, (v) => { chosen.y = v; zoomed = null; draw(); });
    choice(controls, "a curve for each", [{ value: "", text: "nothing" }].concat(keys(free)), chosen.by, (v) => { chosen.by = v; draw(); });
    tick(controls, "logarithmic", false, (on) => { chosen.log = on; zoomed = null; draw(); });
    draw();
  }

  const charts = {
    curves(plot, controls) { curvesOf(plot, controls, data.main, null); },

    coverage(plot, controls) { curvesOf(plot, controls, data.coverage, { value: 0.6827, text: "68 %, as standard uncertainties of normal errors cover" }); },

    cells(plot, controls) {
      const chosen = { x: free[0].key, y: free[1].key, m: data.main };
      const draw = () => {
        const xAxis = axisOf(chosen.x), yAxis = axisOf(chosen.y);
        const cells = [];
        xAxis.labels.forEach((xLabel, i) => yAxis.labels.forEach((yLabel, j) => {
          const values = rows.filter((row) => place(row, xAxis) === i && place(row, yAxis) === j).map((row) => measure(row, chosen.m)).filter(known);
          if (values.length) cells.push({ x: xLabel, y: yLabel, value: quantile(values, 0.5), n: values.length });
        }));
        const svg = stage(plot, chosen.m + unit(chosen.m) + " over " + xAxis.title + " and " + yAxis.title + "; arrow keys select the cells");
        const x = d3.scaleBand().domain(xAxis.labels).range([margin.left + 60, width - margin.right]).padding(0.03);
        const y = d3.scaleBand().domain(yAxis.labels.slice().reverse()).range([margin.top, height - margin.bottom]).padding(0.03);
        const [low, high] = range(cells.map((c) => c.value), false);
        const colour = d3.scaleSequential(d3.interpolateViridis).domain([low, high]);
        const few = (labels) => (label) => (labels.length <= 12 || labels.indexOf(label) % Math.ceil(labels.length / 12) === 0 ? label : "");
        svg.append("g").attr("class", "axis").attr("transform", "translate(0," + (height - margin.bottom) + ")").call(d3.axisBottom(x).tickFormat(few(xAxis.labels))).selectAll("text").attr("font-size", 12);
        svg.append("g").attr("class", "axis").attr("transform", "translate(" + (margin.left + 60) + ",0)").call(d3.axisLeft(y).tickFormat(few(yAxis.labels))).selectAll("text").attr("font-size", 12)
          .each(function () { const text = d3.select(this), full = text.text(); if (full.length > 18) text.text(full.slice(0, 17) + "…").append("title").text(full); });
        svg.append("text").attr("x", (margin.left + 60 + width - margin.right) / 2).attr("y", height - 14).attr("text-anchor", "middle").text(xAxis.title);
        svg.append("text").attr("transform", "translate(14," + (height - margin.bottom) / 2 + ") rotate(-90)").attr("text-anchor", "middle").text(yAxis.title);
        const marks = svg.selectAll("rect.cell").data(cells).enter().append("rect").attr("class", "cell").attr("x", (c) => x(c.x)).attr("y", (c) => y(c.y)).attr("width", x.bandwidth()).attr("height", y.bandwidth()).attr("fill", (c) => colour(c.value));
        if (cells.length <= 150) svg.selectAll("text.value").data(cells).enter().append("text").attr("class", "value").attr("pointer-events", "none").attr("text-anchor", "middle").attr("x", (c) => x(c.x) + x.bandwidth() / 2).attr("y", (c) => y(c.y) + y.bandwidth() / 2 + 4).style("fill", (c) => (c.value > (low + high) / 2 ? "#000" : "#fff")).text((c) => d3.format(".2~g")(c.value));
        walkable(svg, marks, (c) => xAxis.title + " " + c.x + "\n" + yAxis.title + " " + c.y + "\n" + chosen.m + " " + shown(c.value) + unit(chosen.m) + (c.n > 1 ? ", median of " + c.n : ""));
      };
      choice(controls, "across", keys(free), chosen.x, (v) => { chosen.x = v; draw(); });
      choice(controls, "upwards", keys(free), chosen.y, (v) => { chosen.y = v; draw(); });
      choice(controls, "measure", measures(), chosen.m, (v) => { chosen.m = v; draw(); });
      draw();
    },

    causes(plot, controls) {
      const chosen = { x: free.length ? free[0].key : "" };
      const draw = () => {
        const axis = chosen.x ? axisOf(chosen.x) : { title: "", labels: ["all cases"], numeric: false };
        const groups = axis.labels.map((label, i) => ({
          label: label,
          bars: data.terms.map((term, k) => {
            const values = (chosen.x ? rows.filter((row) => place(row, axis) === i) : rows).map((row) => termRms(row, term)).filter(known);
            return { label: label, term: term, colour: colours[k % colours.length], value: quantile(values, 0.5), n: values.length };
          }).filter((bar) => bar.n > 0)
        }));
        const svg = stage(plot, "rms of every cause of error over " + axis.title + "; arrow keys select the bars");
        const x = d3.scaleBand().domain(axis.labels).range([margin.left, width - margin.right]).paddingInner(0.2).paddingOuter(0.1);
        const inner = d3.scaleBand().domain(data.terms).range([0, x.bandwidth()]);
        const bars = [].concat(...groups.map((g) => g.bars));
        const y = d3.scaleLinear().domain([0, d3.max(bars, (b) => b.value) || 1]).nice().range([height - margin.bottom, margin.top]);
        const many = axis.labels.length > 14;
        axes(svg, x, y, axis.title, "rms [px]", (label) => (many && axis.labels.indexOf(label) % Math.ceil(axis.labels.length / 12) ? "" : label));
        const marks = svg.selectAll("rect.bar").data(bars).enter().append("rect").attr("class", "bar").attr("x", (b) => x(b.label) + inner(b.term)).attr("y", (b) => y(b.value)).attr("width", Math.max(1, inner.bandwidth() - 1)).attr("height", (b) => y(0) - y(b.value)).attr("fill", (b) => b.colour);
        walkable(svg, marks, (b) => (axis.title ? axis.title + " " + b.label + "\n" : "") + b.term + " " + shown(b.value) + " px");
        legend(plot, data.terms.map((term, k) => ({ colour: colours[k % colours.length], text: term })));
      };
      if (free.length) choice(controls, "over", keys(free), chosen.x, (v) => { chosen.x = v; draw(); });
      draw();
    },

    scatter(plot, controls) {
      const chosen = { x: data.second || data.main, y: data.main, log: false };
      const draw = () => {
        const points = rows.map((row) => ({ row: row, x: measure(row, chosen.x), y: measure(row, chosen.y) })).filter((p) => known(p.x) && known(p.y) && (!chosen.log || (p.x > 0 && p.y > 0)));
        const svg = stage(plot, chosen.y + " against " + chosen.x + ", one point per case; arrow keys select the points");
        const scale = chosen.log ? d3.scaleLog : d3.scaleLinear;
        const x = scale().domain(range(points.map((p) => p.x), chosen.log)).nice().range([margin.left, width - margin.right]);
        const y = scale().domain(range(points.map((p) => p.y), chosen.log)).nice().range([height - margin.bottom, margin.top]);
        axes(svg, x, y, chosen.x + unit(chosen.x), chosen.y + unit(chosen.y));
        const marks = svg.selectAll("circle").data(points).enter().append("circle").attr("r", 4).attr("cx", (p) => x(p.x)).attr("cy", (p) => y(p.y)).attr("fill", colours[0]).attr("fill-opacity", 0.65);
        walkable(svg, marks, (p) => "case " + p.row.case + "\n" + data.axes.map((axis, k) => axis.title + " " + axis.labels[p.row.v[k]]).join("\n") + "\n" + chosen.x + " " + shown(p.x) + "\n" + chosen.y + " " + shown(p.y));
      };
      choice(controls, "across", measures(), chosen.x, (v) => { chosen.x = v; draw(); });
      choice(controls, "upwards", measures(), chosen.y, (v) => { chosen.y = v; draw(); });
      tick(controls, "logarithmic", false, (on) => { chosen.log = on; draw(); });
      draw();
    },

    /* ---- one case ---- */
    field(plot, controls) {
      const grid = data.grid, of = data.fields, chosen = { name: of[0].name, part: "magnitude" };
      const value = (f, i) => { const u = f.u[i], v = f.v[i]; return !known(u) || !known(v) ? null : chosen.part === "u" ? u : chosen.part === "v" ? v : Math.hypot(u, v); };
      const paint = (canvas, values, colour, low, top) => {
        const pen = canvas.getContext("2d"), picture = pen.createImageData(grid.columns, grid.rows);
        values.forEach((v, i) => { const c = known(v) ? d3.rgb(colour(Math.max(low, Math.min(top, v)))) : { r: 128, g: 128, b: 128 }; picture.data.set([c.r, c.g, c.b, known(v) ? 255 : 60], 4 * i); });
        pen.putImageData(picture, 0, 0);
      };
      /* All maps at once, small, each with its own colours: on paper they are printed side by side. */
      const overview = () => {
        const all = d3.select(plot.node().parentNode).append("div").attr("class", "maps").selectAll("div").data(of).enter().append("div");
        all.append("canvas").attr("width", grid.columns).attr("height", grid.rows).attr("aria-hidden", "true");
        all.append("span").text(function (f) {
          const values = d3.range(grid.columns * grid.rows).map((i) => (known(f.u[i]) && known(f.v[i]) ? Math.hypot(f.u[i], f.v[i]) : null));
          const top = d3.quantile(values.filter(known).sort(d3.ascending), 0.995) || 1;
          paint(this.parentNode.firstChild, values, d3.scaleSequential(d3.interpolateViridis).domain([0, top]), 0, top);
          return f.title + ", 0 to " + d3.format(".3~g")(top) + " " + (f.unit || "px");
        });
      };
      const draw = () => {
        plot.selectAll("*").remove();
        const f = of.find((one) => one.name === chosen.name), signed = chosen.part !== "magnitude";
        const values = d3.range(grid.columns * grid.rows).map((i) => value(f, i)), finite = values.filter(known).sort(d3.ascending);
        const high = d3.quantile(finite, 0.995) || 1, low = signed ? -Math.max(Math.abs(d3.quantile(finite, 0.005) || 0), Math.abs(high)) : 0, top = signed ? -low : high;
        const colour = signed ? d3.scaleSequential(d3.interpolateRdBu).domain([top, low]) : d3.scaleSequential(d3.interpolateViridis).domain([low, top]);
        const canvas = plot.append("canvas").attr("width", grid.columns).attr("height", grid.rows).attr("tabindex", 0).attr("role", "img")
          .attr("aria-label", f.title + ", " + chosen.part + ", one colour per vector; arrow keys select the vectors").style("width", "min(100%, " + 36 * grid.columns + "px, 44rem)");
        paint(canvas.node(), values, colour, low, top);
        let at = 0;
        const words = (i) => "x " + shown(grid.x[i]) + ", y " + shown(grid.y[i]) + " px\n" + of.map((one) => (one.name === f.name ? "> " : "") + one.title + ": " + shown(one.u[i]) + ", " + shown(one.v[i]) + " " + (one.unit || "px")).join("\n");
        canvas.on("mousemove", function () {
          const [px, py] = d3.mouse(this), box = this.getBoundingClientRect();
          const c = Math.min(grid.columns - 1, Math.max(0, Math.floor((px / box.width) * grid.columns))), r = Math.min(grid.rows - 1, Math.max(0, Math.floor((py / box.height) * grid.rows)));
          at = r * grid.columns + c; tell(words(at), this);
        }).on("mouseleave", hush).on("blur", hush).on("keydown", function () {
          const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: grid.columns, ArrowUp: -grid.columns }[d3.event.key];
          if (!step) return;
          d3.event.preventDefault(); at = (at + step + values.length) % values.length; tell(words(at), this);
        });
        const bar = plot.append("svg").attr("viewBox", "0 0 460 44").style("max-width", "32rem").attr("aria-hidden", "true");
        d3.range(100).forEach((i) => bar.append("rect").attr("x", 20 + 4.2 * i).attr("y", 2).attr("width", 4.4).attr("height", 14).attr("shape-rendering", "crispEdges").attr("fill", colour(low + ((top - low) * i) / 99)));
        bar.append("g").attr("transform", "translate(0,16)").call(d3.axisBottom(d3.scaleLinear().domain([low, top]).range([20, 440])).ticks(6).tickFormat(plain));
        plot.append("p").attr("class", "hint").text(f.title + " [" + (f.unit || "px") + "], " + chosen.part + ", at x from " + shown(d3.min(grid.x)) + " to " + shown(d3.max(grid.x)) + " px, y from " + shown(d3.min(grid.y)) + " px (above) to " + shown(d3.max(grid.y)) + " px. Grey: unknown. The pointer or the arrow keys show all values of a vector; up to 0.5 % of the values are outside the colour range.");
      };
      overview();
      choice(controls, "show", of.map((f) => ({ value: f.name, text: f.title })), chosen.name, (v) => { chosen.name = v; draw(); });
      choice(controls, "component", ["magnitude", "u", "v"].map((p) => ({ value: p, text: p })), chosen.part, (v) => { chosen.part = v; draw(); });
      draw();
    },

    histogram(plot, controls) {
      const chosen = { name: data.errors[0].name };
      const draw = () => {
        const one = data.errors.find((e) => e.name === chosen.name), sets = [["u", one.u], ["v", one.v]].map(([name, values]) => ({ name: name, values: values.filter(known) }));
        const sorted = [].concat(...sets.map((s) => s.values)).map(Math.abs).sort(d3.ascending), reach = d3.quantile(sorted, 0.99) || 1;
        const svg = stage(plot, "Histogram of the error " + one.title + "; arrow keys select the bins");
        const x = d3.scaleLinear().domain([-reach, reach]).nice().range([margin.left, width - margin.right]);
        const bins = [].concat(...sets.map((s, k) => d3.histogram().domain(x.domain()).thresholds(x.ticks(40))(s.values).filter((b) => b.x1 > b.x0).map((b) => ({ x0: b.x0, x1: b.x1, n: b.length, share: b.length / (s.values.length || 1), name: s.name, colour: colours[k] }))));
        const y = d3.scaleLinear().domain([0, d3.max(bins, (b) => b.share) || 1]).nice().range([height - margin.bottom, margin.top]);
        axes(svg, x, y, "error " + one.title + " [px]", "fraction of the vectors", null, "%");
        const marks = svg.selectAll("rect.bar").data(bins).enter().append("rect").attr("class", "bar").attr("x", (b) => x(b.x0) + (b.name === "v" ? (x(b.x1) - x(b.x0)) / 2 : 0)).attr("width", Math.max(1, (x(b1(bins)) - x(b0(bins))) / 2 - 0.5)).attr("y", (b) => y(b.share)).attr("height", (b) => y(0) - y(b.share)).attr("fill", (b) => b.colour);
        walkable(svg, marks, (b) => b.name + " from " + shown(b.x0) + " to " + shown(b.x1) + " px\n" + b.n + " vectors, " + d3.format(".1%")(b.share));
        legend(plot, sets.map((s, k) => ({ colour: colours[k], text: s.name })));
      };
      const b0 = (bins) => bins[1 % bins.length].x0, b1 = (bins) => bins[1 % bins.length].x1;
      choice(controls, "error", data.errors.map((e) => ({ value: e.name, text: e.title })), chosen.name, (v) => { chosen.name = v; draw(); });
      draw();
    },

    budget(plot) {
      const terms = data.budget;
      const svg = stage(plot, "rms of every cause of error; arrow keys select the bars");
      const x = d3.scaleBand().domain(terms.map((t) => t.name)).range([margin.left, width - margin.right]).padding(0.25);
      const y = d3.scaleLinear().domain([0, d3.max(terms, (t) => t.rms) || 1]).nice().range([height - margin.bottom, margin.top]);
      axes(svg, x, y, "cause", "rms [px]");
      const marks = svg.selectAll("rect.bar").data(terms.filter((t) => known(t.rms))).enter().append("rect").attr("class", "bar").attr("x", (t) => x(t.name)).attr("y", (t) => y(t.rms)).attr("width", x.bandwidth()).attr("height", (t) => y(0) - y(t.rms)).attr("fill", (t) => (t.name === "total" ? colours[6] : colours[0]));
      walkable(svg, marks, (t) => t.name + " rms " + shown(t.rms) + " px\nbias " + shown(t.bias_u) + ", " + shown(t.bias_v) + " px\nscatter over the field " + shown(t.random_u) + ", " + shown(t.random_v) + " px");
    },

    reliability(plot) {
      const bins = data.reliability;
      const svg = stage(plot, "rms error against estimated uncertainty; arrow keys select the bins");
      const span = range([].concat(...bins.map((b) => [b.sigma, b.error])), false), top = span[1] * 1.05;
      const x = d3.scaleLinear().domain([0, top]).range([margin.left, width - margin.right]), y = d3.scaleLinear().domain([0, top]).range([height - margin.bottom, margin.top]);
      axes(svg, x, y, "estimated uncertainty, rms of the bin [px]", "error, rms of the bin [px]");
      svg.append("line").attr("x1", x(0)).attr("y1", y(0)).attr("x2", x(top)).attr("y2", y(top)).attr("stroke", colours[6]).attr("stroke-dasharray", "5 4");
      const marks = svg.selectAll("circle").data(bins).enter().append("circle").attr("r", 5).attr("cx", (b) => x(b.sigma)).attr("cy", (b) => y(b.error)).attr("fill", colours[0]);
      walkable(svg, marks, (b) => "uncertainty " + shown(b.sigma) + " px, error " + shown(b.error) + " px\n" + b.n + " components");
    }
  };

  document.querySelectorAll("figure.chart").forEach((figure) => {
    charts[figure.dataset.chart](d3.select(figure).select(".plot"), d3.select(figure).select(".controls"));
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
