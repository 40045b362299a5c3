// Porosity of beds with a sieve curve that the user gives, as simcore.models.size_and_form.bed_prediction has it.
const Bed = (() => {
  const { InputError, general } = Numbers;
  const { one_class: range, rhine, states, model, tail, in_gap: inGap, above, more_mass: moreMass, compaction } = DATA.curve;
  const { sticky, sticky_share: stickyShare, too_wide: tooWide, too_low: TOO_LOW, wide_class: wideClass, wide_share: wideShare } = DATA.curve;
  const CLASSES = DATA.curve.classes;
  const { CLASS_NAME, boundsOf } = SieveClasses;
  const RHINE = { ...rhine, forms: [] };

  // Returns the preferred row of one sieve class of a sample's grains; without one, numbers are NaN and `refused` says why.
  function oneClassOf(sample, level) {
    if (!DATA.fitted_cases.includes(DATA.one_class.case)) {
      throw new InputError(
        `a sieve curve needs a model of one sieve class, ${DATA.one_class.case}, which this page does not have; choose ` +
          "one of the named sieve curves"
      );
    }
    const rows = Prediction.predict(sample, DATA.one_class.name, level).filter(({ by }) => by === "ours");
    const preferred = rows.find((row) => row.preferred);
    if (preferred) return preferred;
    const refused = rows.map((row) => row.refused).join("; ");
    const none = `no model was fitted to such grains in beds of ${DATA.one_class.case}`;
    return { n: NaN, lower: NaN, upper: NaN, few_grains_error: NaN, outside: "", refused: refused || none, quantities: [] };
  }

  // Returns the name of the column of sieve classes in a table of grains of one sample, or "".
  function classColumn(name, text) {
    const { header, rows } = Table.read(name, text);
    const column = header.find((title) => CLASS_NAME.test(title)) ?? "";
    const ofSample = Columns.findSample(name, header, "", []);
    if (column && new Set(rows.map(({ cells }) => cells[ofSample])).size > 1) {
      throw new InputError(
        `${name}: the page reads forms by sieve class of one sample, and the column ${header[ofSample]} has several; ` +
          "use the command `scree predict`, or paste the rows of one sample"
      );
    }
    return column;
  }

  // Returns [{low, high [mm], sample}] of samples that are named by their sieve class; column: its name.
  function readClasses(name, column, samples) {
    const unit = CLASS_NAME.exec(column)[1];
    const classes = samples.map((sample) => ({ ...boundsOf(`${name}, row ${sample.row}`, column, sample.name, unit), sample }));
    classes.sort((a, b) => a.low - b.low || a.high - b.high);
    classes.slice(1).forEach((coarser, i) => {
      const finer = classes[i];
      if (finer.low === coarser.low && finer.high === coarser.high) {
        const same = classes.filter(({ low, high }) => low === finer.low && high === finer.high);
        const names = same.map((entry) => entry.sample.name).join(" and ");
        throw new InputError(`${name}: ${names} are the same class; write it in one way in the column ${column}`);
      }
      if (!(coarser.low < finer.high * (1 - 1e-9))) return;
      const [first, second] = [finer, coarser].map(SieveClasses.written);
      throw new InputError(`${name}: the classes ${first} and ${second} overlap; correct the column ${column}`);
    });
    return classes;
  }

  // Returns notices on classes with forms in which the sieve curve has no mass.
  function describeUnusedClasses(name, curve, classes) {
    const filled = curve.mass_fractions.flatMap((share, i) => (share > 0 ? [curve.bounds.slice(i, i + 2)] : []));
    return classes
      .filter((entry) => !filled.some(([low, high]) => low < entry.high * (1 - 1e-6) && entry.low * (1 + 1e-6) < high))
      .map((entry) => `${name}: the class ${SieveClasses.written(entry)} is not used, because the sieve curve has no mass there`);
  }

  // Returns {sample, bed} of grains that have another form in each sieve class, as simcore.models.size_and_form has it.
  function predictByClass(curve, classes, level) {
    const held = curve.mass_fractions.flatMap((share, i) => (share > 0 ? [i] : []));
    const samples = held.map((i) => sampleOf(curve, i, classes));
    const rows = samples.map((sample) => oneClassOf(sample, level));
    const shares = held.map((i) => curve.mass_fractions[i]);
    const remarks = (key) =>
      [...new Set(rows.flatMap((row, i) => (row[key] ? [`${samples[i].name}: ${row[key]}`] : [])))].join("; ");
    const grains = Packing.sum([...new Set(samples)].map((sample) => sample.grains));
    const sample = {
      name: CLASSES.by_class, grains, forms: classes.flatMap(({ sample: { forms } }) => forms),
      ...moments(samples, shares),
    };
    const refused = remarks("refused");
    if (refused) return { sample, bed: refusal(remarks("outside"), refused) };
    if (rows.some((row) => row.n < range.least || row.n > range.largest)) {
      const limits = `${general(range.least)} to ${general(range.largest)}`;
      return { sample, bed: refusal(remarks("outside"), `the one-class porosity of a class is outside ${limits}`) };
    }
    const n1 = rows.map((row) => row.n);
    const few = rows.map((row, i) => Prediction.fewGrainsHalf(samples[i], row.few_grains_error, level));
    const ofModel = rows.map((row, i) => Math.sqrt(Math.max((0.5 * (row.upper - row.lower)) ** 2 - few[i] ** 2, 0)));
    const ofRhine = oneClassOf(RHINE, level).n;
    const mixture = (values) => 1 - 1 / Packing.sum(values.map((value, i) => shares[i] / (1 - value)));
    const porosity = (values) => {
      const ofAll = curve.mass_fractions.map(() => values[0]);
      held.forEach((i, k) => (ofAll[i] = values[k]));
      return Skeletons.predict(curve, ofAll.map(within), ofRhine);
    };
    const [n, ...halves] = withHalves(porosity, samples, n1, ofModel, few);
    const both = Math.hypot(...halves);
    const [mean, ...meanHalves] = withHalves(mixture, samples, n1, ofModel, few);
    const [lower, upper] = [-1, 1].map((sign) => mean + sign * Math.hypot(...meanHalves));
    const errors = rows.map((row) => row.few_grains_error);
    const few_grains_error = withHalves(mixture, samples, n1, n1.map(() => 0), errors)[2];
    const oneClass = { n: mean, lower, upper, few_grains_error, outside: remarks("outside"), quantities: [] };
    const half = halfWidth(curve, [n, n - both, n + both], mean, ofRhine, level);
    const by_class = oneClassByClass(curve, classes, level);
    return { sample, bed: { ...bedOf(curve, n, half, oneClass, ""), by_class } };
  }

  // Returns [porosity, half width by the model, half width by the few grains], as in simcore.models.size_and_form: errors
  // of the model are equal in sign, and those of the few grains are independent for different samples.
  function withHalves(porosity, samples, n1, ofModel, few) {
    const bySample = [...new Set(samples)].map((own) => few.map((half, i) => half * (samples[i] === own)));
    const [byModel, ...byFew] = [ofModel, ...bySample].map((change) => {
      const [above, below] = [1, -1].map((sign) => porosity(n1.map((value, i) => value + sign * change[i])));
      return 0.5 * (above - below);
    });
    return [porosity(n1), byModel, Math.hypot(...byFew)];
  }

  const containing = (low, high, classes) =>
    classes.find((entry) => entry.low <= low * (1 + 1e-6) && high <= entry.high * (1 + 1e-6));

  function sampleOf(curve, index, classes) {
    const [low, high] = curve.bounds.slice(index, index + 2);
    const found = containing(low, high, classes);
    if (found) return found.sample;
    const parts = classes.filter((entry) => entry.low < high * (1 - 1e-6) && low * (1 + 1e-6) < entry.high);
    const within = parts.map(SieveClasses.written).join(" and ");
    const lies = within
      ? `it is only partly within ${within} of the table of forms; let the classes of forms end at sieves of the curve`
      : "no class of the table of forms contains it; add its forms";
    throw new InputError(
      `sieve curve ${curve.name}: the class ${general(low)} to ${general(high)} mm has mass, but ${lies}, or remove the column of classes`
    );
  }

  // Returns the one-class porosity of the grains of each class of the curve; NaN for a class without forms or prediction.
  function oneClassByClass(curve, classes, level) {
    return curve.mass_fractions.map((share, i) => {
      const found = containing(...curve.bounds.slice(i, i + 2), classes);
      return found ? oneClassOf(found.sample, level).n : NaN;
    });
  }

  // Mean and standard deviation of FL and EL over the classes, by mass.
  function moments(samples, shares) {
    const values = {};
    for (const key of ["FL", "EL"]) {
      const mean = Packing.sum(samples.map((sample, i) => shares[i] * sample[`mu_${key}`]));
      const squares = samples.map(
        (sample, i) => shares[i] * (sample[`sigma_${key}`] ** 2 + (sample[`mu_${key}`] - mean) ** 2)
      );
      values[`mu_${key}`] = mean;
      values[`sigma_${key}`] = Math.sqrt(Packing.sum(squares));
    }
    return values;
  }

  const refusal = (outside, refused) => ({
    n: NaN, lower: NaN, upper: NaN, n_long_shaken: NaN, n_not_shaken: NaN, n_one_class: NaN, one_class_lower: NaN, one_class_upper: NaN,
    one_class_few_grains_error: NaN, outside, refused, oneClass: { n: NaN, quantities: [] },
  });

  // Returns the porosity of a bed, {n, lower, upper, n_long_shaken, n_not_shaken, n_one_class, ..., outside, refused, oneClass}.
  function predict(curve, sample, level) {
    const oneClass = oneClassOf(sample, level);
    const usable = oneClass.n >= range.least && oneClass.n <= range.largest;
    let [n, half] = [NaN, NaN];
    if (usable) {
      const clipped = [oneClass.n, oneClass.lower, oneClass.upper].map(within);
      const ofRhine = oneClassOf(RHINE, level).n;
      const ends = clipped.map((value) => Skeletons.predict(curve, value, ofRhine));
      n = ends[0];
      half = halfWidth(curve, ends, oneClass.n, ofRhine, level);
    }
    const limits = `its one-class porosity is outside ${general(range.least)} to ${general(range.largest)}`;
    return bedOf(curve, n, half, oneClass, usable ? "" : oneClass.refused || limits);
  }

  function bedOf(curve, n, half, oneClass, refused) {
    if (Number.isFinite(n) && !(n - half > 0 && half > 0 && n + half < 1)) {
      const first = beyondOfCurve(curve).slice(0, 1).map((text) => text.split(TOO_LOW)[0]);
      refused = ["its prediction interval reaches outside (0, 1)", ...first].join(": ");
      n = NaN;
    }
    return {
      n, lower: n - half, upper: n + half, n_long_shaken: n + states.long_shaken, n_not_shaken: n + states.not_shaken,
      n_one_class: oneClass.n, one_class_lower: oneClass.lower, one_class_upper: oneClass.upper,
      one_class_few_grains_error: oneClass.few_grains_error,
      outside: [oneClass.outside, ...beyond(curve, oneClass.n)].filter((text) => text).join("; "), refused, oneClass,
    };
  }

  const within = (value) => Math.min(Math.max(value, range.least), range.largest);

  // Adds the errors of the one-class porosity, of the step to the curve, and of how much of the form's effect is kept.
  function halfWidth(curve, [n, low, high], oneClass, ofRhine, level) {
    const decrease = 1 - Skeletons.predict(curve, ofRhine, ofRhine) / ofRhine;
    const ofForm = model.form_error * decrease * Math.abs(oneClass - ofRhine);
    const ofSizes = model.quantiles[general(level)] * model.error * wider(curve) * (oneClass - n);
    return Math.sqrt((0.5 * (high - low)) ** 2 + ofSizes ** 2 + ofForm ** 2);
  }

  // Ratio of the sizes below which 99 % and 1 % of the mass are.
  const span = (curve) => quantile(curve, 1 - tail) / quantile(curve, tail);

  // Largest ratio of the sizes between which a hundredth of the mass is, without the finest and the coarsest hundredth.
  function gap(curve) {
    const total = Packing.sum(curve.mass_fractions);
    const ends = curve.mass_fractions.map((_, i) => Packing.sum(curve.mass_fractions.slice(0, i + 1)) / total);
    const last = 1 - tail - inGap;
    const starts = [...ends, ...ends.map((end) => end - inGap + 1e-9), tail, last].filter((q) => q >= tail && q <= last);
    return Math.max(...starts.map((q) => quantile(curve, q + inGap) / quantile(curve, q)));
  }

  // The error grows beyond the widest curve, and beyond the widest gap, of known error.
  const wider = (curve) =>
    Math.max(1, Math.log(span(curve)) / Math.log(model.widest), Math.log(gap(curve)) / Math.log(model.gap));

  // Share of the mass in classes that are wider than those of known error.
  const inWideClasses = ({ bounds, mass_fractions: shares }) =>
    Packing.sum(shares.filter((_, i) => bounds[i + 1] / bounds[i] > wideClass * above));

  // Returns remarks on what lies outside the sieve curves of known error.
  function beyondOfCurve(curve) {
    const texts = [];
    const known = (limit) => `errors are known up to ${general(limit, 3)} : 1`;
    if (span(curve) > model.widest * above) {
      const low = span(curve) > tooWide * model.widest ? TOO_LOW : "";
      texts.push(`98 % of the mass spans ${general(span(curve), 3)} : 1 in size, ${known(model.widest)}${low}`);
    }
    const share = inWideClasses(curve);
    if (share > wideShare) {
      texts.push(
        `${(100 * share).toFixed(0)} % of the mass is in sieve classes wider than ${general(wideClass)} : 1, whose sizes ` +
          "are assumed to be uniform in log size; give more sieves"
      );
    }
    if (gap(curve) > model.gap * above) {
      texts.push(`the curve has a gap of ${general(gap(curve), 3)} : 1 in size, ${known(model.gap)}`);
    }
    const fine = passing(curve, sticky);
    if (fine > stickyShare) {
      texts.push(`${(100 * fine).toFixed(0)} % of the mass is finer than ${general(sticky)} mm, where grains may stick together`);
    }
    return texts;
  }

  // Returns remarks on what lies outside the beds of known error.
  function beyond(curve, oneClass) {
    const texts = beyondOfCurve(curve);
    const [least, largest] = model.one_class;
    if (oneClass < least / above || oneClass > largest * above) {
      const range = `from ${least.toFixed(3)} to ${largest.toFixed(3)}`;
      texts.push(`the one-class porosity is ${oneClass.toFixed(3)}, errors are known ${range}`);
    }
    return texts;
  }

  // Returns the change of porosity if the mass of each class grows by 1 % of the whole. oneClass: one-class porosity, or
  // one for each class of the curve; where it is NaN, the class has no mass and the change is NaN.
  function sensitivity(curve, oneClass) {
    const ofRhine = oneClassOf(RHINE, DATA.levels[0]).n;
    const given = typeof oneClass === "number" ? curve.mass_fractions.map(() => oneClass) : oneClass;
    const known = given.find((n) => !Number.isNaN(n)); // without mass it has no effect
    const ofClasses = given.map((n) => (Number.isNaN(n) ? known : n));
    const base = Skeletons.predict(curve, ofClasses, ofRhine);
    return given.map((n, index) => {
      if (Number.isNaN(n)) return NaN;
      const more = curve.mass_fractions.map((share, i) => (share + (i === index ? moreMass : 0)) / (1 + moreMass));
      return Skeletons.predict({ ...curve, mass_fractions: more }, ofClasses, ofRhine) - base;
    });
  }

  // Returns the porosity by models of others, [{model, given, n}]; oneClass: one-class porosity, NaN if there is none.
  function others(curve, oneClass) {
    const classes = Packing.classes(curve);
    const models = [
      ["linear", Packing.linear],
      ["linear mixture", Packing.linearMixture],
      [`compressible, K = ${general(compaction)}`, (y, s, n) => Packing.compressible(y, s, n, compaction)],
      ["rods", Packing.rods],
    ];
    const packing = models.map(([name, porosity]) => ({
      model: `packing model: ${name}`,
      given: "curve and one-class porosity",
      n: Number.isNaN(oneClass) ? NaN : porosity(...classes, oneClass),
    }));
    const empirical = EMPIRICAL.map((porosity, i) => ({
      model: DATA.curve.predictors[i], given: "curve", n: porosity(curve),
    }));
    return [...packing, ...empirical];
  }

  // Share of the mass finer than a size, and size below which a share is; mass is uniform in log D within a class.
  function passing({ bounds, mass_fractions: shares }, size) {
    const position = bounds.findIndex((bound) => bound >= size);
    if (position === 0) return 0;
    if (position < 0) return 1;
    const below = Packing.sum(shares.slice(0, position - 1));
    const [low, high] = [bounds[position - 1], bounds[position]];
    return below + shares[position - 1] * (Math.log(size / low) / Math.log(high / low));
  }

  function quantile({ bounds, mass_fractions: shares }, share) {
    const total = Packing.sum(shares);
    let cumulative = 0;
    for (let i = 0; ; i += 1) {
      cumulative += shares[i];
      if (shares[i] > 0 && (cumulative >= share * total - 1e-12 || i === shares.length - 1)) {
        const within = 1 - (cumulative - share * total) / shares[i];
        return bounds[i] * (bounds[i + 1] / bounds[i]) ** within;
      }
    }
  }

  // Standard deviation of log2 D by mass.
  function deviation({ bounds, mass_fractions: shares }) {
    const logs = bounds.map(Math.log2);
    const centres = shares.map((_, i) => 0.5 * (logs[i] + logs[i + 1]));
    const widths = shares.map((_, i) => logs[i + 1] - logs[i]);
    const mean = Packing.sum(shares.map((share, i) => share * centres[i]));
    return Math.sqrt(Packing.sum(shares.map((share, i) => share * ((centres[i] - mean) ** 2 + widths[i] ** 2 / 12))));
  }

  // Predictors of river engineering from the curve alone, in the order of simcore.models.packing_models.empirical.
  const median = (curve) => quantile(curve, 0.5);
  const EMPIRICAL = [
    (curve) => 0.353 - 0.068 * deviation(curve) + 0.146 * passing(curve, 0.5),
    (curve) => 0.621 * Math.exp(-0.457 * 2 ** deviation(curve)),
    (curve) => -0.0333 + 0.4665 / median(curve) ** 0.21,
    (curve) => 0.13 + 0.21 / (median(curve) + 0.002) ** 0.21,
    (curve) => 0.245 + 0.0864 / (0.1 * median(curve)) ** 0.21,
  ];

  return { RHINE, classColumn, readClasses, describeUnusedClasses, predict, predictByClass, sensitivity, others, quantile, span };
})();
