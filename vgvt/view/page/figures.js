"use strict";
// Draws every figure of the page and recolours it for dark mode and print.
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const ink = () => getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  const config = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d"] };
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

  for (const element of document.querySelectorAll(".figure[data-figure]")) {
    charts.push(element);
    draw(element, read(element.dataset.figure));
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
