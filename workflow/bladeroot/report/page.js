"use strict";
// Makes the figures of a page live: each has a still picture and a chart as JSON, which the plotting
// library draws in its place when it comes into view. The library is large, so that it is read once the
// page is shown; without it the still ones stay.
const library = document.createElement("script");
library.src = document.currentScript.dataset.library;
window.addEventListener("load", function () {
  setTimeout(function () { document.body.appendChild(library); }, 0);
});
library.addEventListener("load", function () {
  const NARROW = 620; // pixels: below it one panel stands in a row

  function element(name, parent, text) {
    const made = document.createElement(name);
    if (text) made.textContent = text;
    parent.appendChild(made);
    return made;
  }

  function sized(chart, width) {
    const columns = width < NARROW ? 1 : chart.columns;
    const rows = Math.ceil(chart.panels / columns);
    const layout = Object.assign({}, chart.layout, { height: chart.height * rows + 20, width: width });
    layout.grid = Object.assign({ rows: rows, columns: columns, ygap: 0.3, xgap: columns > 2 ? 0.27 : 0.16 }, chart.layout.grid);
    if (columns === 1) layout.margin = Object.assign({}, layout.margin, { l: 50, r: 6 });
    return layout;
  }

  // Every option of every switch is a box to tick; a trace is shown when all of its own are ticked.
  function addSwitches(chart, bar, box) {
    const off = new Set();
    function update() {
      const seen = chart.data.map(function (trace) {
        return Object.entries(trace.meta).every(function (one) { return !off.has(JSON.stringify(one)); });
      });
      window.Plotly.restyle(box, { visible: seen });
    }
    chart.switches.forEach(function (one) {
      const many = one.options.length > 24;
      const place = many ? element("details", bar) : bar;
      if (many) element("summary", place, one.name + ": " + one.options.length);
      const field = element("fieldset", place);
      if (!many) element("b", field, one.name);
      const boxes = one.options.map(function (option) {
        const label = element("label", field);
        const tick = element("input", label);
        tick.type = "checkbox";
        tick.checked = true;
        element("i", label, option[1]).style.color = option[2];
        label.appendChild(document.createTextNode(option[0]));
        tick.addEventListener("change", function () {
          off[tick.checked ? "delete" : "add"](JSON.stringify([one.name, option[0]]));
          update();
        });
        return tick;
      });
      if (boxes.length < 4) return;
      [["all", true], ["none", false]].forEach(function (choice) {
        element("button", field, choice[0]).addEventListener("click", function () {
          boxes.forEach(function (tick, k) {
            tick.checked = choice[1];
            off[choice[1] ? "delete" : "add"](JSON.stringify([one.name, one.options[k][0]]));
          });
          update();
        });
      });
    });
  }

  function addScales(chart, bar, box) {
    const field = element("fieldset", bar);
    ["x", "y"].forEach(function (axis) {
      const names = Object.keys(chart.layout).filter(function (name) {
        return name.indexOf(axis + "axis") === 0 && !chart.layout[name].tickvals;
      });
      if (!names.length) return;
      const button = element("button", field, "log " + axis);
      let log = names.every(function (name) { return chart.layout[name].type === "log"; });
      button.setAttribute("aria-pressed", String(log));
      button.addEventListener("click", function () {
        log = !log;
        const change = {};
        names.forEach(function (name) {
          change[name + ".type"] = log ? "log" : "linear";
          change[name + ".autorange"] = true;
        });
        button.setAttribute("aria-pressed", String(log));
        window.Plotly.relayout(box, change);
      });
    });
  }

  function makeLive(figure) {
    const chart = JSON.parse(figure.querySelector("script").textContent);
    const before = figure.querySelector(".still");
    const width = before.clientWidth;
    const bar = document.createElement("div");
    bar.className = "bar";
    const box = document.createElement("div");
    box.className = "live";
    figure.insertBefore(bar, before);
    figure.insertBefore(box, before);
    const settings = { displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };
    window.Plotly.newPlot(box, chart.data, sized(chart, width), settings).then(function () {
      addScales(chart, bar, box);
      addSwitches(chart, bar, box);
      figure.classList.add("made-live");
    });
    window.addEventListener("resize", function () {
      const now = bar.clientWidth;
      if (now && now !== box.clientWidth) window.Plotly.relayout(box, sized(chart, now));
    });
  }

  const waiting = new IntersectionObserver(function (entries) {
    entries.forEach(function (entry) {
      if (!entry.isIntersecting) return;
      waiting.unobserve(entry.target);
      makeLive(entry.target);
    });
  }, { rootMargin: "300px" });
  document.querySelectorAll("figure.drawn").forEach(function (figure) {
    if (figure.querySelector("script")) waiting.observe(figure);
  });
});
