// Drawings as SVG: the Zingg diagram, and the predictions with their intervals.
const Drawings = (() => {
  const NAMESPACE = "http://www.w3.org/2000/svg";
  const MOST_POINTS = 1500; // of grains in the Zingg diagram
  const CLASSES = [
    ["disc-shaped", 0.3, 0.965],
    ["equant", 0.93, 0.965],
    ["bladed", 0.3, 0.04],
    ["rod-shaped", 0.9, 0.04],
  ];

  function element(name, attributes = {}, ...children) {
    const node = document.createElementNS(NAMESPACE, name);
    Object.entries(attributes).forEach(([key, value]) => node.setAttribute(key, value));
    node.append(...children);
    return node;
  }

  function svg(width, height, label) {
    const drawing = element("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label });
    drawing.append(element("title", {}, label));
    return drawing;
  }

  // Draws the samples over flatness S/I and elongation I/L, and the fitted range of mean forms of `row`'s model.
  function zingg(sample, row, number) {
    const [left, top, side] = [52, 12, 330];
    const x = (FL) => left + side * FL;
    const y = (EL) => top + side * (1 - EL);
    const place = sample.mu_FL === undefined ? "unknown flatness" : `flatness ${number(sample.mu_FL, 2)}`;
    const label = `Zingg diagram: ${sample.name} at ${place}, elongation ${number(sample.mu_EL, 2)}`;
    const drawing = svg(left + side + 14, top + side + 48, label);
    if (row) {
      for (const [reach, kind] of [[DATA.rule.far, "reach"], [0, "range"]]) {
        const corners = rangeOutline(row.quantities, reach);
        if (corners.length) {
          drawing.append(
            element("polygon", { class: kind, points: corners.map(([FL, EL]) => `${x(FL)},${y(EL)}`).join(" ") })
          );
        }
      }
    }
    const line = (x1, y1, x2, y2, kind) => drawing.append(element("line", { x1, y1, x2, y2, class: kind }));
    line(x(2 / 3), y(0), x(2 / 3), y(1), "division");
    line(x(0), y(2 / 3), x(1), y(2 / 3), "division");
    drawing.append(element("rect", { x: x(0), y: y(1), width: side, height: side, class: "frame" }));
    for (const tick of [0, 0.2, 0.4, 0.6, 0.8, 1]) {
      line(x(tick), y(0), x(tick), y(0) + 5, "frame");
      line(x(0), y(tick), x(0) - 5, y(tick), "frame");
      drawing.append(element("text", { x: x(tick), y: y(0) + 18, class: "middle" }, number(tick, 1)));
      drawing.append(element("text", { x: x(0) - 9, y: y(tick) + 4, class: "end" }, number(tick, 1)));
    }
    drawing.append(element("text", { x: x(0.5), y: y(0) + 38, class: "middle" }, "flatness S/I (1: not flat)"));
    const upright = { transform: `translate(14 ${y(0.5)}) rotate(-90)`, class: "middle" };
    drawing.append(element("text", upright, "elongation I/L (1: not elongated)"));
    for (const [text, FL, EL] of CLASSES) {
      drawing.append(element("text", { x: x(FL), y: y(EL) + 4, class: FL > 0.5 ? "class end" : "class middle" }, text));
    }
    const step = Math.ceil(sample.forms.length / MOST_POINTS);
    for (const [FL, EL] of sample.forms.filter((form, i) => form[0] !== null && i % step === 0)) {
      drawing.append(element("circle", { cx: x(FL), cy: y(EL), r: 2.5, class: "grain" }));
    }
    if (sample.mu_FL === undefined) {
      line(x(0), y(sample.mu_EL), x(1), y(sample.mu_EL), "spread");
      return drawing;
    }
    const within = (value) => Math.min(Math.max(value, 0), 1);
    const bar = (key) => [-1, 1].map((sign) => within(sample[`mu_${key}`] + sign * sample[`sigma_${key}`]));
    const [[FL1, FL2], [EL1, EL2]] = [bar("FL"), bar("EL")];
    line(x(FL1), y(sample.mu_EL), x(FL2), y(sample.mu_EL), "spread");
    line(x(sample.mu_FL), y(EL1), x(sample.mu_FL), y(EL2), "spread");
    drawing.append(element("circle", { cx: x(sample.mu_FL), cy: y(sample.mu_EL), r: 6, class: "mean" }));
    return drawing;
  }

  // Returns the corners (FL, EL) of the mean forms inside the ranges of 1/EQ and 1/EL, widened by `reach` of their width.
  function rangeOutline(quantities, reach) {
    const bounds = (names) => {
      const found = quantities.find(({ name }) => names.includes(name));
      if (!found) return [1, Infinity];
      const more = reach * (found.high - found.low);
      return [Math.max(found.low - more, 1), found.high + more];
    };
    const [EQ1, EQ2] = bounds(["EQ_inv", "mu_EQ_inv"]);
    const [EL1, EL2] = bounds(["EL_inv", "mu_EL_inv"]);
    const steps = [...Array(41).keys()].map((i) => 1 / EL2 + (i / 40) * (1 / EL1 - 1 / EL2));
    const flattest = steps.map((EL) => [Math.min(1 / (EQ2 * EL), 1), EL]);
    const roundest = steps.map((EL) => [Math.min(1 / (EQ1 * EL), 1), EL]);
    return [...flattest, ...roundest.reverse()];
  }

  // Draws the porosity of each row, with its interval; rows: [{label, n, lower, upper, kind}].
  function intervals(rows, number, label) {
    const [left, width, lineHeight, top] = [8, 404, 44, 6];
    const values = rows.flatMap((row) => [row.n, row.lower, row.upper]).filter((value) => Number.isFinite(value));
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const step = [0.005, 0.01, 0.02, 0.05, 0.1].find((size) => (high - low) / size <= 6) ?? 0.2;
    const [first, last] = [Math.floor(low / step - 0.3) * step, Math.ceil(high / step + 0.3) * step];
    const x = (n) => left + 14 + ((n - first) / (last - first)) * (width - 28);
    const bottom = top + lineHeight * rows.length;
    const drawing = svg(left + width + 8, bottom + 42, label);
    for (let tick = first; tick < last + step / 2; tick += step) {
      drawing.append(element("line", { x1: x(tick), y1: top, x2: x(tick), y2: bottom, class: "grid" }));
      const digits = step < 0.01 ? 3 : 2;
      drawing.append(element("text", { x: x(tick), y: bottom + 16, class: "middle" }, number(tick, digits)));
    }
    drawing.append(element("text", { x: left + width / 2, y: bottom + 36, class: "middle" }, "porosity"));
    rows.forEach((row, i) => {
      const y = top + lineHeight * (i + 0.68);
      drawing.append(element("text", { x: left, y: y - 14, class: "row" }, row.label));
      const ends = [row.lower, row.upper];
      if (ends.every(Number.isFinite)) {
        const [x1, x2] = ends.map(x);
        drawing.append(element("line", { x1, x2, y1: y, y2: y, class: `interval ${row.kind}` }));
      }
      if (Number.isFinite(row.n)) {
        drawing.append(element("circle", { cx: x(row.n), cy: y, r: 5, class: `point ${row.kind}` }));
      }
    });
    return drawing;
  }

  return { element, zingg, intervals };
})();
