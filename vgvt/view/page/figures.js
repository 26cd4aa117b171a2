"use strict";
// Draws every figure of the page and recolours it for dark mode and print.
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const ink = () => getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  // No mode bar: it would cover small figures. Drag to zoom, double-click to come back.
  const config = { responsive: true, displayModeBar: false };
  const charts = [];

  function themed(figure) {
    const layout = structuredClone(figure.layout);
    layout.font = { ...(layout.font || {}), color: ink() };
    return layout;
  }
  function draw(element, figure) {
    element.figure = figure;
    return Plotly.react(element, figure.data, themed(figure), config);
  }
  function recolour() {
    for (const element of charts) Plotly.relayout(element, { "font.color": ink() });
  }

  // The labels of a lane, as many as this width has room for: above the marker, below, or none.
  function relabel(element) {
    const [low, high] = element.layout.xaxis.range;
    const room = (high - low) * 42 / Math.max(element.clientWidth - 120, 100);
    element.data.forEach((trace, index) => {
      if (trace.meta !== "lane") return;
      const last = { "top center": -Infinity, "bottom center": -Infinity };
      const slots = trace.customdata.map((hertz) => {
        const slot = Object.keys(last).find((name) => hertz - last[name] >= room);
        if (slot) last[slot] = hertz;
        return slot;
      });
      const text = slots.map((slot, k) => (slot ? trace.customdata[k].toFixed(2) : ""));
      Plotly.restyle(element, { text: [text], textposition: [slots.map((slot) => slot || "top center")] }, [index]);
    });
  }

  for (const element of document.querySelectorAll(".figure[data-figure]")) {
    charts.push(element);
    draw(element, read(element.dataset.figure));
    if (element.dataset.figure === "sigma-data") {
      relabel(element);
      addEventListener("resize", () => relabel(element));
    }
  }
  const frf = document.getElementById("frf-figure");
  if (frf) {
    const figures = read("frf-data");
    const select = document.getElementById("frf-select");
    charts.push(frf);
    const show = () => draw(frf, figures[Number(select.value)]);
    select.addEventListener("change", show);
    show();
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  matchMedia("print").addEventListener("change", recolour);
})();
