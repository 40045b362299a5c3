// What is shown and taken away of the porosity of beds with a sieve curve.
const BedOutput = (() => {
  const { byId, number, marked, node, row } = Elements;
  const { general } = Numbers;
  const { model, rhine, columns } = DATA.curve;

  const interval = ({ lower, upper }) => `${number(lower)} to ${number(upper)}`;

  // Returns the paragraphs with the answer; byClass: whether each sieve class has its own form.
  function answer(bed, level, byClass) {
    if (bed.refused) {
      return [
        node("p", "The porosity of this sample cannot be predicted.", "refused"), node("p", `The reason: ${bed.refused}.`),
      ];
    }
    const value = node("p", undefined, "value");
    value.append("n = ", node("strong", number(bed.n)), bed.outside ? " *" : "");
    const oneClass = `${number(bed.n_one_class)} (${number(bed.one_class_lower)} to ${number(bed.one_class_upper)})`;
    const texts = [
      node("p", `${100 * level} % prediction interval: ${interval(bed)}`, "interval"),
      node(
        "p",
        `${DATA.curve.state} By its state of packing it is between ${number(bed.n_long_shaken)}, shaken for eight seconds, ` +
          `and ${number(bed.n_not_shaken)}, placed and not shaken. ${DATA.curve.other_beds}${bed.outside ? ` ${DATA.curve.more_outside}` : ""}`
      ),
      node(
        "p",
        `${byClass ? "If its classes did not interact, the bed would have" : "One sieve class of these grains has"} ${oneClass}; ` +
          `the range of sizes lowers it by ${number(bed.n_one_class - bed.n)}.`
      ),
    ];
    if (byClass) texts.push(node("p", DATA.curve.classes.check));
    if (bed.outside) texts.push(node("p", `* Outside the fitted range: ${bed.outside}.`, "outside"));
    return [value, ...texts];
  }

  // Returns the lines of the drawing of all predictions.
  function lines(bed, curve) {
    if (bed.refused) return [];
    const ours = { ...bed, label: `ours, sieve curve and form: ${number(bed.n)} (${interval(bed)})`, kind: "preferred" };
    const others = Bed.others(curve, bed.n_one_class).map(({ model: name, given, n }) => {
      const packing = given !== "curve";
      const [title, ...constants] = name.replace("packing model: ", "").split(", ");
      const text = packing ? [`${title} packing model`, ...constants].join(", ") : `${title}, sieve curve only`;
      const label = `${marked(text)}: ${number(n)}`;
      return { n, lower: NaN, upper: NaN, label, kind: packing ? "packing" : "empirical" };
    });
    return [ours, states(bed.n), ...others];
  }

  // Returns the line of the range from a bed that is shaken for long to one that is only placed.
  function states(n) {
    const [lower, upper] = [n + DATA.curve.states.long_shaken, n + DATA.curve.states.not_shaken];
    return { n: NaN, lower, upper, kind: "state", label: `long shaken to not shaken: ${number(lower)} to ${number(upper)}` };
  }

  // Returns the rows of the table of classes: bounds, mass, and what 1 % more of it changes.
  function classRows(bed, curve) {
    const changes = Bed.sensitivity(curve, bed.by_class ?? bed.n_one_class);
    const written = (value) => general(value, 4).replace(".", byId("mark").value);
    return curve.mass_fractions
      .map((share, i) => {
        const signed = Number.isNaN(changes[i]) ? "–" : `${changes[i] < 0 ? "−" : "+"}${number(Math.abs(changes[i]), 4)}`;
        return row(`${written(curve.bounds[i])} to ${written(curve.bounds[i + 1])} mm`, [number(100 * share, 1), signed]);
      })
      .reverse();
  }

  // The width of the sieve curve among the quantities of the fitted range.
  function width(curve) {
    const value = Bed.span(curve);
    const distance = Math.max(0, (value / model.widest - 1 - 1e-9) / (1 - 1 / model.widest));
    return { name: "size below which 99 % of the mass is, to that of 1 %", value, low: 1, high: model.widest, distance };
  }

  // Returns [title, formula, source] of the step from one class to the curve.
  function formula() {
    const rods = model.skeleton === "rods";
    const values = Object.entries(model.parameters).map(
      ([key, value]) => `${key === "kappa" ? "κ" : key} = ${number(value, 3)}`
    );
    const functions =
      "p" in model.parameters || "s" in model.parameters
        ? `f = (1 − r)^p (1 + ${general(DATA.curve.fixed_q)} r), g = (1 − r)^s`
        : "f = (1 − r)^3.3 + 2.8 r (1 − r)^2.7, g = (1 − r)^2 + 0.4 r (1 − r)^3.7";
    const T = "Tᵢ = Σ yⱼVⱼ − Σ(j coarser) yⱼ(Vⱼ − 1) g(r) − Σ(j finer) yⱼVⱼ f(r)";
    const N = model.damped ? "N" : "n";
    const skeleton = {
      compressible: `${N} = 1 − 1/P, K = Σ yᵢVᵢ/(P − Tᵢ), ${T}, V = K/((1 + K)(1 − b)), ${functions}`,
      linear: `${N} = 1 − 1/max Tᵢ, ${T}, V = 1/(1 − b), ${functions}`,
      rods: `${N} = share of gaps between rods that a random line cuts from spheres of the diameters D^m (Farr and Groot 2009)`,
    }[model.skeleton];
    const damped = "n = N + (n₁ − n₀)(1 − c X), with X = 1 − N/n₀ and 1 − c X ≥ 0; ";
    const exponent = model.damped ? "m = m0" : "m = m0 (e/e₀)^κ with the void ratio e, which is e₀ for the Rhine's grains";
    const sizes = rods ? "" : "y is the share of a size class, r the ratio of the smaller to the larger size to the power m; ";
    const one = model.damped
      ? "N of one sieve class is n₀, the porosity of such a bed of the Rhine's grains; n₁ is that of these grains"
      : "n of one sieve class is n₁, the porosity of such a bed of these grains";
    const symbols = `${sizes}${rods ? "the gaps are" : "b is"} such that ${one}; ${exponent}; ${values.join(", ")}; ${model.behind}`;
    return [`candidate ${model.candidate}, ${model.title}`, (model.damped ? damped : "") + skeleton, symbols];
  }

  // Returns the table that the command prints with --sieve --csv.
  function csv(results, mark) {
    const separator = mark === "," ? ";" : ",";
    const cell = (value) => {
      if (typeof value === "number") return Number.isNaN(value) ? "" : String(value).replace(".", mark);
      return /[";,\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value;
    };
    const rows = results.map(({ sample, bed }) => {
      const values = { ...bed, ...sample, sample: sample.name };
      return columns.map((name) => cell(values[name]));
    });
    return [columns, ...rows].map((line) => line.join(separator)).join("\n") + "\n";
  }

  const errors = () => Object.entries(DATA.curve.rms).map(([name, rms]) => `${marked(name)} ${number(rms)}`);

  // The line below the chart, which is far from the results on a phone.
  function brief(bed) {
    return bed.refused ? "No porosity is predicted." : `Porosity ${number(bed.n)}, interval ${interval(bed)}.`;
  }

  const noForms = `No table of grains is given: the form is that of ${rhine.name}.`;

  return { answer, brief, errors, lines, states, classRows, width, formula, csv, noForms };
})();
