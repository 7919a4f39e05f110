// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the pointer is in a chart, the legends of all charts have the values of the step next to it, and a viewer shows
// that moment; where the viewer goes, the charts follow. A picture that is clicked takes the whole width, and gives it
// back.
"use strict";
for (const figure of document.querySelectorAll(".pictures figure"))
  figure.addEventListener("click", () => figure.classList.toggle("large"));

// A moment of the run; time: null: none any more. from: who says so
const tellTime = (time, from) =>
  document.dispatchEvent(new CustomEvent("hexaplast:time", {detail: {time, from}}));

// Where the nearest of ascending times is.
function nearestIn(times, time) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] > time) high = middle;
    else low = middle;
  }
  return time - times[low] <= times[high] - time ? low : high;
}

for (const figure of document.querySelectorAll("figure.chart")) {
  const chart = JSON.parse(figure.querySelector("script").textContent);
  const svg = figure.querySelector("svg");
  const values = figure.querySelectorAll(".curve b");
  const at = figure.querySelector(".at");
  const [left, top, width, height] = chart.frame;
  const [first, last, min, max] = chart.axes;
  const x = time => left + width * (time - first) / (last - first);
  const y = value => top + height * (1 - (Math.min(Math.max(value, min), max) - min) / (max - min));

  const make = (name, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.setAttribute("visibility", "hidden");
    return svg.appendChild(element);
  };
  const line = make("line", {y1: top, y2: top + height, stroke: "var(--frame)"});
  const dots = chart.series.flatMap(series => series.curves.map(curve => make("circle", {r: 4, fill: curve.colour})));

  const show = time => {
    let number = 0;
    for (const series of chart.series) {
      const k = nearestIn(series.times, time);
      if (number === 0) {
        line.setAttribute("x1", x(series.times[k]));
        line.setAttribute("x2", x(series.times[k]));
        at.textContent = `step ${series.steps[k]}, ${+series.times[k].toPrecision(6)} s`;
      }
      for (const curve of series.curves) {
        dots[number].setAttribute("cx", x(series.times[k]));
        dots[number].setAttribute("cy", y(curve.values[k]));
        values[number].textContent = `${+curve.values[k].toPrecision(5)} ${chart.unit}`;
        ++number;
      }
    }
    for (const mark of [line, ...dots]) mark.setAttribute("visibility", "visible");
  };
  const hide = () => {
    for (const mark of [line, ...dots]) mark.setAttribute("visibility", "hidden");
    for (const value of values) value.textContent = "";
    at.textContent = "";
  };
  const point = event => {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    tellTime(first + (last - first) * Math.min(Math.max((place.x - left) / width, 0), 1), figure);
  };
  document.addEventListener("hexaplast:time", event => {
    if (event.detail.time === null) hide();
    else show(event.detail.time);
  });
  svg.addEventListener("pointermove", point);
  svg.addEventListener("pointerdown", point);
  svg.addEventListener("pointerleave", () => tellTime(null, figure));
}
