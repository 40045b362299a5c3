// The sieve curve that the user pastes, opens or draws. The fields are the only state.
const CurveInput = (() => {
  const { byId, number, node } = Elements;
  const { InputError, general } = Numbers;
  const PASTED = "sieve curve";
  const EXAMPLE = [[16, 0], [11.2, 410], [8, 930], [5.6, 760], [4, 300], [2.8, 90], ["pan", 10]];
  const EVEN = [[31.5, 100], [22.4, 88], [16, 70], [11.2, 50], [8, 32], [5.6, 18], [4, 8], [2.8, 0]];
  const SHOWN = [16, 50, 84]; // percentiles
  let notes = [];
  let chart = null;
  let isDragged = false; // whether the chart itself changes the curve

  const written = (value, digits = 6) => general(value, digits).replace(".", byId("mark").value);
  const asText = (header, rows) =>
    `${header.join(";")}\n${rows.map((row) => row.map((v) => (typeof v === "number" ? written(v) : v)).join(";")).join("\n")}\n`;

  // Returns the curve in the fields, or null if there is none; shows the chart, the notices and the error.
  function read() {
    const text = byId("sieves").value;
    byId("curve-error").textContent = "";
    byId("curve-notices").replaceChildren();
    byId("percentiles").textContent = "";
    let isShown = false;
    try {
      if (!text.trim()) {
        chart.hide();
        return null;
      }
      const name = byId("sieves-name").value || PASTED;
      const [finest, coarsest] = ["finest", "coarsest"].map(sizeIn);
      const table = SieveTable.read(name, text, coarsest, notes);
      const points = table.openings.map((size, i) => ({ size, passing: table.passing[i] }));
      chart.show(points);
      isShown = true;
      const curve = SieveTable.curve(name, table, finest, coarsest);
      byId("curve-notices").replaceChildren(...[...table.notices, ...curve.notices].map((text) => node("li", text)));
      byId("percentiles").textContent = describe(curve);
      return curve;
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      byId("curve-error").textContent = `${error.message}.`;
      if (!isShown && !isDragged) chart.hide();
      return null;
    }
  }

  // Returns the size [mm] in a field, or null if it is empty.
  function sizeIn(id) {
    const text = byId(id).value.trim().replace(/\s*mm$/i, "");
    if (!text) return null;
    const title = byId(id).labels[0].textContent;
    if (/^\d+,\d{3}$/.test(text) && !text.startsWith("0,")) {
      const [plain, decimal] = [text.replace(",", ""), text.replace(",", ".")];
      throw new InputError(`${title} is '${byId(id).value}'; write ${plain} or ${general(Number(decimal))}, in mm`);
    }
    const value = Numbers.NUMBER.test(text) ? Number(text.replace(",", ".")) : NaN;
    if (!(value > 0 && Number.isFinite(value))) {
      throw new InputError(`${title} is '${byId(id).value}'; give a size above 0, in mm`);
    }
    return value;
  }

  function describe(curve) {
    const sizes = SHOWN.map((share) => {
      const size = Bed.quantile(curve, share / 100);
      return `D${share} = ${written(size, 3)} mm`;
    });
    const ratio = curve.bounds.at(-1) / curve.bounds[0];
    return `${sizes.join(", ")}. The largest grains are ${number(ratio, 1)} times as large as the smallest.`;
  }

  function set(text, name = "", decoding = []) {
    notes = decoding;
    byId("sieves").value = text;
    byId("sieves-name").value = name;
  }

  // changed: called after each edit.
  function listen(changed) {
    chart = CurveChart.create(byId("curve-chart"), {
      write: written,
      isOpen: () => byId("coarsest").value.trim() !== "",
      change: (points) => {
        const rows = points.map(({ size, passing }) => [size, 100 * passing]).reverse();
        set(asText(["opening [mm]", "passing [%]"], rows), byId("sieves-name").value);
        isDragged = true;
        changed();
        isDragged = false;
      },
    });
    byId("sieves").addEventListener("input", () => {
      set(byId("sieves").value);
      changed();
    });
    for (const id of ["finest", "coarsest"]) byId(id).addEventListener("input", changed);
    const buttons = {
      "example-curve": () => asText(["opening [mm]", "mass [g]"], EXAMPLE),
      "draw-curve": () => asText(["opening [mm]", "passing [%]"], EVEN),
      "clear-curve": () => "",
    };
    Object.entries(buttons).forEach(([id, text]) => {
      byId(id).addEventListener("click", () => {
        set(text());
        changed();
        if (id === "draw-curve") byId("curve-chart").querySelector(".handle")?.focus();
      });
    });
  }

  return { read, set, listen };
})();
