// What one can take away: a CSV table, a specification, a link, and formulas as text.
const Outputs = (() => {
  const { general } = Numbers;
  const { kindOfBed } = Prediction;
  const STATISTICS = ["mu_FL", "sigma_FL", "mu_EL", "sigma_EL", "mu_EQ", "sigma_EQ"];
  const PREDICTION = ["by", "model", "preferred", "n", "lower", "upper", "few_grains_error", "outside", "distance", "refused"];
  const RANGE = ["n_low", "n_high", "lower", "upper", "flatness_low", "flatness_high", "refused"];
  const LONG_LINK = 8000; // characters; some programs cut longer links

  // Returns the table that the command prints with --csv, with all digits. results: [{sample, rows} or {sample, range}];
  // mark: of decimals; choice: of the case.
  function csv(results, mark, choice) {
    const separator = mark === "," ? ";" : ",";
    const cell = (value) => {
      if (typeof value === "number") return Number.isNaN(value) ? "" : String(value).replace(".", mark);
      if (typeof value === "boolean") return value ? "True" : "False";
      return /[";,\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value;
    };
    const twoAxes = results.some(({ range }) => range);
    const lines = twoAxes
      ? [["sample", "grains", "mu_EL", "sigma_EL", ...RANGE]]
      : [["kind_of_bed", "sample", "grains", ...STATISTICS, ...PREDICTION]];
    for (const { sample, rows, range } of results) {
      if (range) {
        lines.push([sample.name, sample.grains, sample.mu_EL, sample.sigma_EL, ...RANGE.map((key) => range[key])]);
      }
      const common = [kindOfBed(sample), sample.name, sample.grains, ...STATISTICS.map((key) => sample[key])];
      const given = rows?.length === 0 ? [withoutModel(sample, choice)] : rows ?? [];
      for (const row of given) lines.push([...common, ...PREDICTION.map((key) => row[key])]);
    }
    return lines.map((line) => line.map(cell).join(separator)).join("\n") + "\n";
  }

  // Returns the row of a sample for which the case has no model.
  function withoutModel(sample, choice) {
    const refused = Prediction.describeWithoutModel(sample, choice);
    const numbers = { n: NaN, lower: NaN, upper: NaN, few_grains_error: NaN, distance: NaN };
    return { by: "", model: "", preferred: false, outside: "", ...numbers, refused };
  }

  // Returns the YAML that packs a sample's distribution of form with the sieve curve of the case, or "".
  function specification(sample, choice) {
    const { specification: text } = DATA.cases.find(({ name }) => name === Prediction.modelCase(choice));
    if (!text || sample.mu_FL === undefined) return "";
    const normal = (key) => `{mean: ${general(sample[`mu_${key}`], 6)}, std: ${general(sample[`sigma_${key}`], 6)}}`;
    const shapes = [
      "# Flatness S/I and elongation I/L: mean and standard deviation of the sample. The grains are synthetic pebbles.",
      "grains: {source: synthetic}",
      "shapes:",
      "  kind: polyhedron",
      "  choice: form_distribution",
      `  flatness: ${normal("FL")}`,
      `  elongation: ${normal("EL")}`,
    ];
    return text.replace(DATA.shapes, () => shapes.join("\n"));
  }

  // Returns the formula of a row's model as text, with where it comes from.
  function formula(row, choice) {
    const name = Prediction.modelCase(choice);
    const terms = (intercept, features, slopes, digits) =>
      `n = ${general(intercept, digits)}` +
      features
        .map((key, i) => ` ${slopes[i] < 0 ? "−" : "+"} ${general(Math.abs(slopes[i]), digits)} ${DATA.symbols[key]}`)
        .join("");
    if (row.by === "r22") {
      const model = DATA.r22[name].find((candidate) => candidate.model === row.model);
      const text = terms(model.intercept, model.features, model.slopes, 6);
      return { text, source: `Rettinger et al. (2022), Eq. ${model.equation}` };
    }
    const model = DATA.models.find((candidate) => candidate.model === row.model && candidate.case === name);
    const [intercept, ...slopes] = model.coefficients;
    return {
      text: terms(intercept, model.features, slopes, 5),
      source: `${model.behind}; mean cross-validated error ${general(model.error, 2)}`,
    };
  }

  // The part of the address that keeps the input, and back.
  function fragment(state) {
    const kept = Object.entries(state).filter(([, value]) => value !== "" && value !== undefined);
    return `#${new URLSearchParams(kept)}`;
  }

  const fromFragment = (hash) => Object.fromEntries(new URLSearchParams(hash.replace(/^#/, "")));

  return { LONG_LINK, csv, specification, formula, fragment, fromFragment };
})();
