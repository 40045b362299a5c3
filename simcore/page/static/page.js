// The page itself: reads the fields, predicts, and shows the results. The fields are the only state.
const Page = (() => {
  const { byId, number, marked, node, download } = Elements;
  const OWN = "own"; // the choice of a sieve curve that the user gives
  const FIELDS = {
    case: "case", level: "level", mark: "mark", sample: "column", table: "table", name: "name",
    sieves: "sieves", curve: "sieves-name", finest: "finest", coarsest: "coarsest",
  };
  const OF_CURVE = ["sieves", "curve", "finest", "coarsest"];
  const PASTED = "table";
  const EXAMPLES = {
    grains: "L [mm];I [mm];S [mm]\n42;31;18\n38;29;24\n55;30;21\n33;27;15\n47;36;29\n40;34;16\n36;22;17\n51;39;27\n",
    means: "sample,mean_FL,std_FL,mean_EL,std_EL\nRhine,0.647,0.175,0.682,0.139\nLune,0.555,0.178,0.728,0.150\n",
  };
  let results = [];
  let curve = null; // the sieve curve that the user gives
  let notesOnFile = [];

  function readFields() {
    return Object.fromEntries(Object.entries(FIELDS).map(([key, id]) => [key, byId(id).value]));
  }

  const isOwn = () => byId("case").value === OWN;

  function evaluate() {
    const state = readFields();
    byId("error").textContent = "";
    byId("copied").textContent = "";
    byId("notices").replaceChildren();
    byId("own").hidden = !isOwn();
    results = [];
    curve = isOwn() ? CurveInput.read() : null;
    try {
      if (state.table.trim()) results = evaluateTable(state);
      else if (curve) {
        byId("notices").replaceChildren(node("li", BedOutput.noForms));
        results = [{ sample: Bed.RHINE, bed: Bed.predict(curve, Bed.RHINE, Number(state.level)) }];
      }
    } catch (error) {
      if (!(error instanceof Numbers.InputError)) throw error;
      byId("error").textContent = `${error.message}.`;
    }
    keepInAddress(state);
    show();
  }

  function evaluateTable(state) {
    const [name, level] = [state.name || PASTED, Number(state.level)];
    const byClass = isOwn() && !state.sample ? Bed.classColumn(name, state.table) : "";
    const read = Grains.read(name, state.table, state.sample || byClass, notesOnFile, isOwn());
    offerColumns(read.header, state.sample);
    byId("notices").replaceChildren(...read.notices.map((notice) => node("li", notice)));
    if (isOwn()) {
      if (!curve) return [];
      if (byClass) {
        const classes = Bed.readClasses(name, byClass, read.samples);
        byId("notices").append(...Bed.describeUnusedClasses(name, curve, classes).map((notice) => node("li", notice)));
        return [Bed.predictByClass(curve, classes, level)];
      }
      return read.samples.map((sample) => ({ sample, bed: Bed.predict(curve, sample, level) }));
    }
    return read.samples.map((sample) =>
      read.kind === Columns.TWO_AXES
        ? { sample, range: Prediction.predictTwoAxes(sample, state.case, level) }
        : { sample, rows: Prediction.predict(sample, state.case, level) }
    );
  }

  function offerColumns(header, chosen) {
    const options = header.filter((text) => text).map((text) => new Option(text, text));
    byId("column").replaceChildren(new Option("automatic", ""), ...options);
    byId("column").value = header.includes(chosen) ? chosen : "";
  }

  // Returns whether the table in the field has a column of this name.
  function hasColumn(name) {
    try {
      return Table.read(PASTED, byId("table").value).header.includes(name);
    } catch (error) {
      if (!(error instanceof Numbers.InputError)) throw error;
      return false;
    }
  }

  function keepInAddress(state) {
    const kept = { ...state };
    const unused = [...(state.table.trim() ? [] : ["table", "name", "sample"]), ...(isOwn() ? [] : OF_CURVE)];
    unused.forEach((key) => delete kept[key]);
    const address = Outputs.fragment(kept);
    history.replaceState(null, "", address);
    byId("long").hidden = address.length <= Outputs.LONG_LINK;
  }

  function show() {
    byId("results").hidden = !results.length;
    byId("brief").textContent = "";
    byId("empty").hidden = Boolean(results.length) || ["error", "curve-error"].some((id) => byId(id).textContent);
    byId("empty").textContent = isOwn()
      ? "Paste or draw a sieve curve; a table of grains is optional."
      : "Paste a table, or choose an example.";
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

  function overviewRow({ sample, rows, range, bed }) {
    const best = rows && preferredOf(rows);
    const statistic = (key) =>
      sample[`mu_${key}`] === undefined ? "–" : `${number(sample[`mu_${key}`])} ± ${number(sample[`sigma_${key}`])}`;
    let cells = ["not evaluated", "–"];
    if (best) cells = [number(best.n) + (best.outside ? "*" : ""), interval(best)];
    if (range && !range.refused) cells = [`${number(range.n_low)} to ${number(range.n_high)}`, interval(range)];
    if (bed && !bed.refused) cells = [number(bed.n) + (bed.outside ? "*" : ""), interval(bed)];
    return Elements.row(sample.name, [...cells, sample.grains || "–", statistic("FL"), statistic("EL")]);
  }

  function showSample() {
    const result = results.find(({ sample }) => sample.name === byId("chosen").value) ?? results[0];
    const { sample, rows, range, bed } = result;
    byId("sizes-part").hidden = !bed || Boolean(bed.refused);
    if (bed) return showBed(sample, bed);
    const best = rows ? preferredOf(rows) : null;
    byId("answer").replaceChildren(...(range ? answerRange(range) : answer(sample, best, rows)));
    byId("predictions").replaceChildren(...drawPredictions(sample, rows ?? []));
    byId("zingg").replaceChildren(Drawings.zingg(sample, best, number));
    byId("place").replaceChildren(...(best ? placeInRange(best) : []));
    byId("place-part").hidden = !best;
    byId("formula").replaceChildren(...(rows ?? []).flatMap((row) => formulaOf(row)));
    byId("formula-part").hidden = !rows?.length;
    const stated = range && !range.refused ? `${DATA.few_grains.without}.` : best?.by === "ours" ? describeError(best) : "";
    byId("caveats").replaceChildren(...caveats(sample, stated).map((text) => node("li", text)));
    byId("specification").disabled = !Outputs.specification(sample, byId("case").value);
  }

  function showBed(sample, bed) {
    const oneForm = bed.oneClass.quantities.length > 0; // not one for each sieve class
    const lines = BedOutput.lines(bed, curve);
    const label = `Porosity by each model: ${lines.map((line) => line.label).join("; ")}`;
    const known = !Number.isNaN(bed.n_one_class);
    byId("answer").replaceChildren(...BedOutput.answer(bed, Number(byId("level").value), !oneForm && known));
    byId("predictions").replaceChildren(...(lines.length ? [Drawings.intervals(lines, number, label)] : []));
    byId("literature").hidden = !lines.length;
    byId("brief").textContent = BedOutput.brief(bed);
    byId("zingg").replaceChildren(Drawings.zingg(sample, oneForm ? bed.oneClass : null, number));
    byId("place-part").hidden = byId("formula-part").hidden = !known;
    byId("place").replaceChildren(...(known ? [...placeInRange(bed.oneClass), ...placeInRange({ quantities: [BedOutput.width(curve)] })] : []));
    byId("classes").replaceChildren(...(bed.refused ? [] : BedOutput.classRows(bed, curve)));
    byId("formula").replaceChildren(...(known ? [...(oneForm ? formulaOf(bed.oneClass, DATA.one_class.name) : []), ...formulaOfSizes()] : []));
    const stated = bed.refused ? "" : Prediction.describeFewGrains(bed.one_class_few_grains_error, "the one-class porosity", number);
    byId("caveats").replaceChildren(...caveats(sample, stated, true).map((text) => node("li", text)));
    byId("specification").disabled = sample.mu_EQ === undefined; // one form for all classes
  }

  function answer(sample, best, rows) {
    if (!best) {
      const reasons = rows.map((row) => node("p", `${modelName(row)}: ${marked(row.refused)}.`));
      const none = rows.length
        ? "The porosity of this sample cannot be predicted: no model is evaluated."
        : "No model was fitted to beds of this case with a distribution of form. Choose “your own” " +
          "and enter this sieve curve: its model is valid for one form and for distributions.";
      return [node("p", none, "refused"), ...reasons];
    }
    const value = node("p", undefined, "value");
    value.append("n = ", node("strong", number(best.n)), best.outside ? " *" : "");
    const parts = [value];
    if (!Number.isNaN(best.lower)) {
      parts.push(node("p", `${100 * byId("level").value} % prediction interval: ${interval(best)}`, "interval"));
    }
    parts.push(node("p", `Model: ${modelName(best)}. It predicts a bed with ${Prediction.kindOfBed(sample)}.`));
    if (best.by === "r22") {
      parts.push(node("p", "None of our models is used: they were not fitted to such samples of this sieve curve, or not evaluated."));
    }
    if (best.outside) {
      const wider = Number.isNaN(best.lower) ? "" : ", so the interval is wider";
      parts.push(node("p", `* Outside the fitted range${wider}: ${marked(best.outside)}.`, "outside"));
    }
    return parts;
  }

  function answerRange(range) {
    if (range.refused) return [node("p", `No model can be evaluated at any flatness: ${range.refused}.`, "refused")];
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
    const best = preferredOf(rows);
    const all = [...lines, ...(best && isWide(byId("case").value) ? [BedOutput.states(best.n)] : []), ...literature];
    const refused = rows
      .filter((row) => row.refused)
      .map((row) => node("p", `${modelName(row)} is not evaluated: ${marked(row.refused)}.`, "outside"));
    byId("literature").hidden = !literature.length || !lines.length;
    if (!lines.length) return refused;
    const label = `Porosity by each model: ${all.map((row) => row.label).join("; ")}`;
    return [Drawings.intervals(all, number, label), ...refused];
  }

  const isWide = (name) => DATA.cases.some((entry) => entry.name === name && entry.mass_fractions.length > 1);

  // Packing models with the one-class porosity of our models, and predictors that take the sieve curve alone.
  function literatureOf(name, sample) {
    const entry = DATA.cases.find((candidate) => candidate.name === name);
    const K = DATA.curve.compaction;
    const [sizes, fractions] = Packing.classes(entry);
    const oneClass = preferredOf(Prediction.predict(sample, DATA.one_class.name, Number(byId("level").value)));
    const rows = [];
    if (sizes.length > 1 && oneClass) {
      const models = [
        ["linear packing model", Packing.linear(sizes, fractions, oneClass.n)],
        [`compressible packing model, K = ${K}`, Packing.compressible(sizes, fractions, oneClass.n, K)],
      ];
      rows.push(...models.map(([title, n]) => ({ n, label: `${marked(title)}: ${number(n)}`, kind: "packing" })));
    }
    for (const { name: author, n } of entry.predictors) {
      rows.push({ n, label: `${author}, sieve curve only: ${number(n)}`, kind: "empirical" });
    }
    return rows.map((row) => ({ ...row, lower: NaN, upper: NaN }));
  }

  function describeErrors() {
    const ofCases = Object.entries(DATA.curve.rms)
      .filter(([name]) => name === "linear" || /\d|Komura/.test(name))
      .map(([name, rms]) => `${name} ${number(rms)}`);
    const texts = isOwn() ? BedOutput.errors() : ofCases;
    return `Their root mean square errors on six measured gravels are: ${texts.join(", ")}.`;
  }

  function placeInRange(row) {
    return row.quantities.map(({ name, value, low, high, distance }) => {
      const inside = distance === 0 ? "inside" : `outside by ${number(distance, 2)} of the range's width`;
      const cells = [...[value, low, high].map((v) => number(v)), inside];
      return Elements.row(DATA.symbols[name] ?? name, cells, distance > 0 ? "outside" : "");
    });
  }

  function formulaOf(row, choice = byId("case").value) {
    const { text, source } = Outputs.formula(row, choice);
    return describeFormula(choice === byId("case").value ? modelName(row) : `one sieve class: ${modelName(row)}`, text, source);
  }

  const formulaOfSizes = () => describeFormula(...BedOutput.formula());

  function describeFormula(title, text, source) {
    const mark = byId("mark").value;
    return [node("dt", title), node("dd", text.replace(/(\d)\.(\d)/g, `$1${mark}$2`), "formula"), node("dd", source)];
  }

  const describeError = (row) => Prediction.describeFewGrains(row.few_grains_error, "the porosity", number);

  // stated: the sentence on the error of few grains, or "".
  function caveats(sample, stated, ofCurve = false) {
    const texts = [];
    if (ofCurve) {
      texts.push("The grains do not stick to each other, and water has neither sorted the bed into layers nor washed out its fines.");
    }
    if (sample === Bed.RHINE) texts.push(`The grains are not measured; their form is taken as ${sample.name}.`);
    else if (!sample.grains) texts.push("If only means and deviations are given, FL and EL are assumed independent.");
    if (sample.grains === 1) texts.push(`${DATA.reading.single_grain}.`.replace(/^a/, "A"));
    for (const { grains, words } of DATA.reading.few_grains) {
      if (!Grains.isOneForm(sample) && sample.grains > 1 && sample.grains < grains) texts.push(`Fewer than ${grains} grains ${words}.`);
    }
    if (stated && sample !== Bed.RHINE && !Grains.isOneForm(sample)) texts.push(stated);
    if (sample.mu_EQ > 1 / DATA.nearly_round.least_ratio) texts.push(DATA.nearly_round.text);
    texts.push("The interval is for a new sample, poured and shaken as those of the fit.");
    return texts;
  }

  function current() {
    return results.find(({ sample }) => sample.name === byId("chosen").value) ?? results[0];
  }

  // set(text, name, notices): what is done with the text of the file. place: of the message on a fault.
  async function openFile(file, set = setTable, place = "error") {
    try {
      const { text, notices } = Table.decode(file.name, new Uint8Array(await file.arrayBuffer()));
      set(text, file.name, notices);
    } catch (error) {
      if (!(error instanceof Numbers.InputError)) throw error;
      const kept = byId(set === setCurve ? "sieves" : "table").value ? "; the former table is kept" : "";
      byId(place).textContent = `${error.message}${kept}.`;
    }
  }

  // Returns { text, notices }.
  function specification(sample) {
    if (!isOwn()) return { text: Outputs.specification(sample, byId("case").value), notices: [] };
    const source = byId("sieves-name").value || "sieve curve";
    return BedSpecification.write(curve, source, sample === Bed.RHINE ? null : sample);
  }

  function setCurve(text, name, notices = []) {
    byId("case").value = OWN;
    CurveInput.set(text, name, notices);
    evaluate();
  }

  const openCurve = (file) => openFile(file, setCurve, "curve-error");

  function setTable(text, name, notices = []) {
    notesOnFile = notices;
    byId("name").value = name;
    byId("table").value = text;
    byId("column").value = "";
    evaluate();
  }

  function fromAddress() {
    const state = Outputs.fromFragment(location.hash);
    const language = (1.5).toLocaleString().includes(",") ? "," : ".";
    byId("mark").value = language;
    for (const key of ["case", "level", "mark"]) {
      if ([...byId(key).options].some((option) => option.value === state[key])) byId(key).value = state[key];
    }
    for (const key of ["table", "name", "finest", "coarsest"]) byId(FIELDS[key]).value = state[key] ?? "";
    CurveInput.set(state.sieves ?? "", state.curve ?? "");
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
    const own = new Option("your own: paste or draw it", OWN);
    byId("case").replaceChildren(new Option("any single sieve class", DATA.one_class.name), own, ...cases);
    byId("level").replaceChildren(...DATA.levels.map((level) => new Option(`${100 * level} %`, String(level))));
    byId("level").value = "0.95";
  }

  function listen() {
    byId("table").addEventListener("input", () => {
      notesOnFile = [];
      byId("name").value = "";
      if (!hasColumn(byId("column").value)) byId("column").value = "";
      evaluate();
    });
    for (const id of ["case", "level", "mark", "column"]) byId(id).addEventListener("change", evaluate);
    CurveInput.listen(evaluate);
    byId("curve-file").addEventListener("change", ({ target }) => target.files[0] && openCurve(target.files[0]));
    byId("chosen").addEventListener("change", showSample);
    byId("file").addEventListener("change", ({ target }) => target.files[0] && openFile(target.files[0]));
    for (const id of ["file", "curve-file"]) byId(id).addEventListener("click", ({ target }) => (target.value = ""));
    for (const key of Object.keys(EXAMPLES)) byId(`example-${key}`).addEventListener("click", () => setTable(EXAMPLES[key], ""));
    byId("clear").addEventListener("click", () => setTable("", ""));
    byId("csv").addEventListener("click", () => {
      const mark = byId("mark").value;
      const text = (isOwn() ? BedOutput : Outputs).csv(results, mark, byId("case").value);
      // Excel recognises UTF-8 by the byte order mark only.
      download("porosity.csv", (mark === "," ? "\ufeff" : "") + text, "text/csv");
    });
    byId("specification").addEventListener("click", () => {
      byId("copied").textContent = "";
      try {
        const { text, notices } = specification(current().sample);
        download("packing.yaml", text, "text/yaml");
        byId("copied").textContent = notices.map((notice) => `${notice[0].toUpperCase()}${notice.slice(1)}.`).join(" ");
      } catch (error) {
        if (!(error instanceof Numbers.InputError)) throw error;
        byId("copied").textContent = `No specification is written: ${error.message}.`;
      }
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
    const part = (event) => byId(byId("own").contains(event.target) ? "own" : "input");
    const endDrop = () => ["own", "input"].forEach((id) => byId(id).classList.remove("dropping"));
    document.addEventListener("dragover", (event) => {
      event.preventDefault();
      endDrop();
      part(event).classList.add("dropping");
    });
    document.addEventListener("dragleave", endDrop);
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      endDrop();
      const ofCurve = part(event) === byId("own");
      const [file] = event.dataTransfer.files;
      if (file) ofCurve ? openCurve(file) : openFile(file);
      else (ofCurve ? setCurve : setTable)(event.dataTransfer.getData("text/plain"), "");
    });
    window.addEventListener("hashchange", fromAddress);
  }

  fillChoices();
  listen();
  fromAddress();

  return { evaluate };
})();
