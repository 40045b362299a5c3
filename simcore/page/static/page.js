// The page itself: reads the fields, predicts, and shows the results. The fields are the only state.
const Page = (() => {
  const byId = (id) => document.getElementById(id);
  const FIELDS = { case: "case", level: "level", mark: "mark", sample: "column", table: "table", name: "name" };
  const PASTED = "table";
  const EXAMPLES = {
    grains: "L [mm];I [mm];S [mm]\n42;31;18\n38;29;24\n55;30;21\n33;27;15\n47;36;29\n40;34;16\n36;22;17\n51;39;27\n",
    means: "sample,mean_FL,std_FL,mean_EL,std_EL\nRhine,0.647,0.175,0.682,0.139\nLune,0.555,0.178,0.728,0.150\n",
  };
  let results = [];
  let notesOnFile = [];

  const number = (value, digits = 3) => value.toFixed(digits).replace(".", byId("mark").value);

  function node(name, text, kind) {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (kind) made.className = kind;
    return made;
  }

  function readFields() {
    return Object.fromEntries(Object.entries(FIELDS).map(([key, id]) => [key, byId(id).value]));
  }

  function evaluate() {
    const state = readFields();
    const text = state.table;
    byId("error").textContent = "";
    byId("notices").replaceChildren();
    results = [];
    if (text.trim()) {
      try {
        const read = Grains.read(state.name || PASTED, text, state.sample, notesOnFile);
        offerColumns(read.header, state.sample);
        byId("notices").replaceChildren(...read.notices.map((notice) => node("li", notice)));
        const twoAxes = read.kind === Columns.TWO_AXES;
        results = read.samples.map((sample) =>
          twoAxes
            ? { sample, range: Prediction.predictTwoAxes(sample, state.case, Number(state.level)) }
            : { sample, rows: Prediction.predict(sample, state.case, Number(state.level)) }
        );
      } catch (error) {
        if (!(error instanceof Numbers.InputError)) throw error;
        byId("error").textContent = `${error.message}.`;
      }
    }
    keepInAddress(state);
    show();
  }

  function offerColumns(header, chosen) {
    const options = header.filter((text) => text).map((text) => new Option(text, text));
    byId("column").replaceChildren(new Option("automatic", ""), ...options);
    byId("column").value = header.includes(chosen) ? chosen : "";
  }

  function keepInAddress(state) {
    const address = Outputs.fragment(state.table.trim() ? state : { ...state, table: "", name: "", sample: "" });
    history.replaceState(null, "", address);
    byId("long").hidden = address.length <= Outputs.LONG_LINK;
  }

  function show() {
    byId("results").hidden = !results.length;
    byId("empty").hidden = Boolean(results.length) || Boolean(byId("error").textContent);
    if (!results.length) return;
    const chosen = byId("chosen").value;
    byId("chosen").replaceChildren(...results.map(({ sample }) => new Option(sample.name, sample.name)));
    if (results.some(({ sample }) => sample.name === chosen)) byId("chosen").value = chosen;
    byId("choose").hidden = results.length < 2;
    byId("all").hidden = results.length < 2;
    byId("rows").replaceChildren(...results.map(overviewRow));
    byId("errors").textContent = describeErrors();
    showSample();
  }

  const preferredOf = (rows) => rows.find((row) => row.preferred) ?? rows.find((row) => !Number.isNaN(row.n));
  const modelName = (row) => (row.by === "r22" ? "Rettinger et al. (2022)" : `ours, ${row.model.replace("_", " ")}`);
  const interval = (row) =>
    Number.isNaN(row.lower) ? "no interval published" : `${number(row.lower)} to ${number(row.upper)}`;

  function overviewRow({ sample, rows, range }) {
    const line = node("tr");
    const best = rows && preferredOf(rows);
    const statistic = (key) =>
      sample[`mu_${key}`] === undefined ? "–" : `${number(sample[`mu_${key}`])} ± ${number(sample[`sigma_${key}`])}`;
    const name = node("th", sample.name);
    name.scope = "row";
    let cells = ["not evaluated", "–"];
    if (best) cells = [number(best.n) + (best.outside ? "*" : ""), interval(best)];
    if (range) cells = [`${number(range.n_low)} to ${number(range.n_high)}`, interval(range)];
    line.append(name, ...[...cells, sample.grains || "–", statistic("FL"), statistic("EL")].map((t) => node("td", t)));
    return line;
  }

  function showSample() {
    const result = results.find(({ sample }) => sample.name === byId("chosen").value) ?? results[0];
    const { sample, rows, range } = result;
    const best = rows ? preferredOf(rows) : null;
    byId("answer").replaceChildren(...(range === undefined ? answer(sample, best, rows) : answerRange(range)));
    byId("predictions").replaceChildren(...drawPredictions(sample, rows ?? []));
    byId("zingg").replaceChildren(Drawings.zingg(sample, best, number));
    byId("place").replaceChildren(...(best ? placeInRange(best) : []));
    byId("place-part").hidden = !best;
    byId("formula").replaceChildren(...(rows ?? []).flatMap(formulaOf));
    byId("formula-part").hidden = !rows?.length;
    byId("caveats").replaceChildren(...caveats(sample).map((text) => node("li", text)));
    byId("specification").disabled = !Outputs.specification(sample, byId("case").value);
  }

  function answer(sample, best, rows) {
    if (!best) {
      const reasons = rows.map((row) => node("p", `${modelName(row)}: ${row.refused}.`));
      const none = rows.length
        ? "The porosity of this sample cannot be predicted: no model is evaluated."
        : "No model was fitted to beds of this case with a distribution of form. Choose another case.";
      return [node("p", none, "refused"), ...reasons];
    }
    const value = node("p", undefined, "value");
    value.append("n = ", node("strong", number(best.n)), best.outside ? " *" : "");
    const parts = [value];
    if (!Number.isNaN(best.lower)) {
      parts.push(node("p", `${100 * byId("level").value} % prediction interval: ${interval(best)}`, "interval"));
    }
    parts.push(node("p", `Model: ${modelName(best)}. The sample is taken as ${Outputs.takenAs(sample)}.`));
    if (best.by === "r22") {
      parts.push(node("p", "None of our models is used: they were not fitted to such samples of this sieve curve, or not evaluated."));
    }
    if (best.outside) {
      const wider = Number.isNaN(best.lower) ? "" : ", so the interval is wider";
      parts.push(node("p", `* Outside the fitted range${wider}: ${best.outside}.`, "outside"));
    }
    return parts;
  }

  function answerRange(range) {
    if (!range) return [node("p", "No model can be evaluated at any flatness.", "refused")];
    const value = node("p", undefined, "value");
    value.append("n = ", node("strong", `${number(range.n_low)} to ${number(range.n_high)}`));
    const text =
      "Only two axes are measured, so that flatness is unknown. The range is that over the flatness of published " +
      `samples, with means from ${number(range.flatness_low, 2)} to ${number(range.flatness_high, 2)}. Measure the ` +
      "third axis of some grains to get a single porosity.";
    const outer = Number.isNaN(range.lower) ? [] : [node("p", `With prediction intervals: ${interval(range)}`, "interval")];
    return [value, ...outer, node("p", text)];
  }

  function drawPredictions(sample, rows) {
    const shown = rows.filter((row) => !Number.isNaN(row.n));
    const lines = shown.map((row) => {
      const kind = row.by === "r22" ? "published" : row.preferred ? "preferred" : "other";
      const values = `${number(row.n)}${row.outside ? "*" : ""} (${interval(row)})`;
      return { ...row, kind, label: `${modelName(row)}: ${values}` };
    });
    const literature = byId("case").value === DATA.one_class.name ? [] : literatureOf(byId("case").value, sample);
    const all = [...lines, ...literature];
    const refused = rows
      .filter((row) => row.refused)
      .map((row) => node("p", `${modelName(row)} is not evaluated: ${row.refused}.`, "outside"));
    byId("literature").hidden = !literature.length || !lines.length;
    if (!lines.length) return refused;
    const label = `Porosity by each model: ${all.map((row) => row.label).join("; ")}`;
    return [Drawings.intervals(all, number, label), ...refused];
  }

  // Packing models with the one-class porosity of our models, and predictors that take the sieve curve alone.
  function literatureOf(name, sample) {
    const entry = DATA.cases.find((candidate) => candidate.name === name);
    const { K } = DATA.literature;
    const [sizes, fractions] = Packing.classes(entry);
    const oneClass = preferredOf(Prediction.predict(sample, DATA.one_class.name, Number(byId("level").value)));
    const rows = [];
    if (sizes.length > 1 && oneClass) {
      const models = [
        ["linear packing model", Packing.linear(sizes, fractions, oneClass.n)],
        [`compressible packing model, K = ${number(K, 1)}`, Packing.compressible(sizes, fractions, oneClass.n, K)],
      ];
      rows.push(...models.map(([title, n]) => ({ n, label: `${title}: ${number(n)}`, kind: "packing" })));
    }
    for (const { name: author, n } of entry.predictors) {
      rows.push({ n, label: `${author}, sieve curve only: ${number(n)}`, kind: "empirical" });
    }
    return rows.map((row) => ({ ...row, lower: NaN, upper: NaN }));
  }

  function describeErrors() {
    const texts = Object.entries(DATA.literature.rms)
      .filter(([name]) => name === "linear" || name === "compressible" || /\d|Komura/.test(name))
      .map(([name, rms]) => `${name} ${number(rms)}`);
    return `Their root mean square errors on six measured gravels are: ${texts.join(", ")}.`;
  }

  function placeInRange(row) {
    return row.quantities.map(({ name, value, low, high, distance }) => {
      const line = node("tr");
      const title = node("th", DATA.symbols[name] ?? name);
      title.scope = "row";
      const inside = distance === 0 ? "inside" : `outside by ${number(distance, 2)} of the range's width`;
      line.append(title, ...[value, low, high].map((v) => node("td", number(v))), node("td", inside));
      if (distance > 0) line.className = "outside";
      return line;
    });
  }

  function formulaOf(row) {
    const { text, source } = Outputs.formula(row, byId("case").value);
    const mark = byId("mark").value;
    return [node("dt", modelName(row)), node("dd", text.replace(/(\d)\.(\d)/g, `$1${mark}$2`), "formula"), node("dd", source)];
  }

  function caveats(sample) {
    const few = DATA.reading.few_grains;
    const texts = [];
    if (!sample.grains) texts.push("Only means and deviations are given, so FL and EL are assumed to be independent.");
    if (sample.grains > 1 && sample.grains < few) {
      texts.push(`Fewer than ${few} grains do not determine the spread of form well.`);
    }
    if (sample.grains && !Grains.isOneForm(sample)) {
      texts.push("The interval does not include the sampling error of the sample's own statistics.");
    }
    texts.push("The interval is for a new sample, poured and shaken as those of the fit.");
    return texts;
  }

  function download(name, text, type) {
    const link = node("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function current() {
    return results.find(({ sample }) => sample.name === byId("chosen").value) ?? results[0];
  }

  async function openFile(file) {
    try {
      const { text, notices } = Table.decode(file.name, new Uint8Array(await file.arrayBuffer()));
      notesOnFile = notices;
      byId("table").value = text;
      byId("name").value = file.name;
      byId("column").value = "";
      evaluate();
    } catch (error) {
      if (!(error instanceof Numbers.InputError)) throw error;
      byId("error").textContent = `${error.message}.`;
    }
  }

  function setTable(text, name) {
    notesOnFile = [];
    byId("name").value = name;
    byId("table").value = text;
    byId("column").value = "";
    evaluate();
  }

  function fromAddress() {
    const state = Outputs.fromFragment(location.hash);
    const language = (1.5).toLocaleString().includes(",") ? "," : ".";
    byId("mark").value = state.mark ?? language;
    for (const key of ["case", "level"]) {
      if ([...byId(key).options].some((option) => option.value === state[key])) byId(key).value = state[key];
    }
    byId("table").value = state.table ?? "";
    byId("name").value = state.name ?? "";
    byId("column").replaceChildren(new Option("automatic", ""));
    if (state.sample) {
      byId("column").append(new Option(state.sample, state.sample));
      byId("column").value = state.sample;
    }
    evaluate();
  }

  function fillChoices() {
    const sizes = ({ bounds, mass_fractions: shares }) => {
      const kept = shares.flatMap((share, i) => (share > 0 ? [i] : []));
      return kept.length ? `${Numbers.general(bounds[kept[0]])} to ${Numbers.general(bounds[kept.at(-1) + 1])} mm` : "";
    };
    const cases = DATA.cases.map((entry) => new Option(`${entry.name}, ${sizes(entry)}`, entry.name));
    byId("case").replaceChildren(new Option("any single sieve class", DATA.one_class.name), ...cases);
    byId("level").replaceChildren(...DATA.levels.map((level) => new Option(`${100 * level} %`, String(level))));
    byId("level").value = "0.95";
  }

  function listen() {
    byId("table").addEventListener("input", () => {
      notesOnFile = [];
      byId("name").value = "";
      evaluate();
    });
    for (const id of ["case", "level", "mark", "column"]) byId(id).addEventListener("change", evaluate);
    byId("chosen").addEventListener("change", showSample);
    byId("file").addEventListener("change", ({ target }) => target.files[0] && openFile(target.files[0]));
    for (const key of Object.keys(EXAMPLES)) byId(`example-${key}`).addEventListener("click", () => setTable(EXAMPLES[key], ""));
    byId("clear").addEventListener("click", () => setTable("", ""));
    byId("csv").addEventListener("click", () => {
      const mark = byId("mark").value;
      // Excel recognises UTF-8 by the byte order mark only.
      download("porosity.csv", (mark === "," ? "\ufeff" : "") + Outputs.csv(results, mark), "text/csv");
    });
    byId("specification").addEventListener("click", () => {
      download("packing.yaml", Outputs.specification(current().sample, byId("case").value), "text/yaml");
    });
    byId("link").addEventListener("click", async () => {
      let text = "The link is copied.";
      try {
        await navigator.clipboard.writeText(location.href);
      } catch {
        text = "Copy the link from the address line; the browser does not allow the page to copy it.";
      }
      byId("copied").textContent = text;
    });
    document.addEventListener("dragover", (event) => {
      event.preventDefault();
      byId("input").classList.add("dropping");
    });
    document.addEventListener("dragleave", () => byId("input").classList.remove("dropping"));
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      byId("input").classList.remove("dropping");
      const [file] = event.dataTransfer.files;
      if (file) openFile(file);
      else setTable(event.dataTransfer.getData("text/plain"), "");
    });
    window.addEventListener("hashchange", fromAddress);
  }

  fillChoices();
  listen();
  fromAddress();

  return { evaluate };
})();
