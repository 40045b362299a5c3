// Predicts the porosity of samples, as simcore.models.prediction does; further models are added to PREDICTORS.
const Prediction = (() => {
  const { general } = Numbers;
  const { near, far, widening } = DATA.rule;
  const { statistics: STATISTICS, relative_step: RELATIVE_STEP, quantiles, fewest, enough, without, rhine } = DATA.few_grains;

  // Each takes (sample, features, case, level) and returns the rows of the models that suit the sample.
  const PREDICTORS = [predictOurs, predictR22];

  // Returns the case whose models are used for the chosen one.
  const modelCase = (choice) => (choice === DATA.one_class.name ? DATA.one_class.case : choice);

  // Returns the rows of one sample: {by, model, preferred, n, lower, upper, few_grains_error, outside, distance, refused, quantities};
  // numbers are NaN where a model is not evaluated. quantities: [{name, value, low, high}] of the model's range.
  function predict(sample, choice, level) {
    const features = featuresOf(sample);
    return PREDICTORS.flatMap((predictor) => predictor(sample, features, modelCase(choice), level));
  }

  // Returns which kind of bed the grains of a sample make, in the words of the command.
  const kindOfBed = (sample) => DATA.kinds_of_bed[Grains.isOneForm(sample) ? 0 : 1];

  // Returns why a sample is not predicted for whose kind of bed the case has no model.
  function describeWithoutModel(sample, choice) {
    const kind = kindOfBed(sample);
    const other = DATA.kinds_of_bed.find((name) => name !== kind);
    return `${DATA.no_model} to beds of ${modelCase(choice)} with ${kind}, only to beds with ${other}`;
  }

  // Returns the range of the porosity over the flatness of published samples, for a sample with two axes only. If no
  // model is evaluated at any flatness, its numbers are NaN, and `refused` has the reason; otherwise it is empty.
  function predictTwoAxes(sample, choice, level) {
    const best = [];
    let refused = "";
    for (const [mu, sigma] of DATA.flatness) {
      const assumed = { ...sample, ...Grains.withEquancy(mu, sigma, sample.mu_EL, sample.sigma_EL) };
      const rows = predict(assumed, choice, level);
      if (!rows.length) refused ||= describeWithoutModel(assumed, choice);
      rows.forEach((row) => (refused ||= row.refused));
      const evaluated = rows.filter((row) => !Number.isNaN(row.n));
      const chosen = evaluated.find((row) => row.preferred) ?? evaluated[0];
      if (chosen) best.push({ ...chosen, flatness: mu });
    }
    if (!best.length) {
      return { n_low: NaN, n_high: NaN, lower: NaN, upper: NaN, flatness_low: NaN, flatness_high: NaN, refused };
    }
    const pick = (key) => best.map((row) => row[key]);
    return {
      refused: "",
      n_low: Math.min(...pick("n")),
      n_high: Math.max(...pick("n")),
      lower: Math.min(...pick("lower")),
      upper: Math.max(...pick("upper")),
      flatness_low: Math.min(...pick("flatness")),
      flatness_high: Math.max(...pick("flatness")),
    };
  }

  function featuresOf(sample) {
    const features = {};
    for (const key of ["EQ", "EL"]) {
      const [mu, sigma] = [sample[`mu_${key}`], sample[`sigma_${key}`]];
      features[`mu_${key}_inv`] = features[`${key}_inv`] = 1 / mu;
      features[`sigma_${key}_inv`] = 1 / sigma;
      features[`relative_variance_${key}`] = (sigma / mu) ** 2;
    }
    return features;
  }

  function predictOurs(sample, features, name, level) {
    const suited = [Grains.isOneForm(sample) ? "single_form" : "form_mixture", "unified"];
    const models = suited.flatMap((kind) => DATA.models.filter((m) => m.model === kind && m.case === name));
    const rows = models.map((model) => {
      const error = fewGrainsError(model, sample);
      const [n, half] = evaluate(model, features, level);
      const quantities = model.features.map((feature, i) =>
        ranged(feature, features[feature], model.minimum[i], model.maximum[i])
      );
      const distance = Math.max(0, ...quantities.map((quantity) => quantity.distance));
      const ofModel = half * (1 + widening * Math.max(Math.min(distance, 1e300) - near, 0));
      const widened = Math.hypot(ofModel, fewGrainsHalf(sample, error, level));
      const numbers = [n, n - widened, n + widened, error];
      return { ...row("ours", model.model, numbers, quantities, 4), error: model.error_of_mixtures };
    });
    return prefer(sample, rows);
  }

  // Returns the porosity and the half-width of the prediction interval by least squares.
  function evaluate(model, features, level) {
    const design = [1, ...model.features.map((feature) => features[feature])];
    const n = dot(design, model.coefficients);
    const scatter = Math.max(dot(design.slice(0, 2), model.scatter_line), model.least_scatter);
    const variance = scatter ** 2 + dot(design, model.covariance.map((line) => dot(line, design)));
    return [n, model.quantiles[general(level)] * Math.sqrt(variance)];
  }

  // Returns the standard error of the porosity that follows from the limited number of grains, as
  // simcore.models.few_grains does: NaN if it is unknown, 0 for one form, unless this is the form of a single grain.
  function fewGrainsError(model, sample) {
    if (Grains.isOneForm(sample)) return sample.grains === 1 ? NaN : 0;
    if (hasFew(sample)) return propagate(model, sample, covarianceOfFew(sample));
    if (!sample.covariance) return NaN;
    const own = propagate(model, sample, sample.covariance);
    if (sample.grains >= enough) return own;
    const all = quantiles["0.95"];
    return Math.max(own, propagate(model, sample, covarianceOfFew(sample)) * all.at(-1) / all[sample.grains - 2]);
  }

  // Returns the error that follows from a covariance.
  function propagate(model, sample, covariance) {
    const slopes = STATISTICS.map((key) => {
      const [high, low] = [1, -1].map((sign) => {
        const features = featuresOf({ ...sample, [key]: sample[key] * (1 + sign * RELATIVE_STEP) });
        return dot([1, ...model.features.map((feature) => features[feature])], model.coefficients);
      });
      return sample[key] > 0 ? (high - low) / (2 * RELATIVE_STEP * sample[key]) : 0;
    });
    return Math.sqrt(dot(slopes, covariance.map((line) => dot(line, slopes))));
  }

  // Whether the grains are too few to determine their deviations, but more than one.
  const hasFew = (sample) => sample.grains > 1 && sample.grains < fewest && !Grains.isOneForm(sample);

  // The covariance of the errors of the statistics, by the deviations of the Rhine's gravel.
  function covarianceOfFew({ mu_FL, mu_EL, grains }) {
    return Grains.meansCovariance({ ...Grains.withEquancy(mu_FL, rhine.sigma_FL, mu_EL, rhine.sigma_EL), grains });
  }

  function fewGrainsHalf(sample, error, level) {
    if (!(error > 0)) return 0;
    const all = quantiles[general(level)];
    return error * (hasFew(sample) ? all.at(-1) : all[Math.min(Math.max(sample.grains - 1, 1), all.length) - 1]);
  }

  // Returns the sentence on the error of few grains; error: NaN if it is unknown. what: that has the error. number: writes
  // a porosity.
  function describeFewGrains(error, what, number) {
    const known = "it is known if each grain has a row, or if a column `grains` has their number";
    if (Number.isNaN(error)) return `${without}; ${known}.`;
    const size = error < 5e-4 ? `less than ${number(1e-3)}` : number(error);
    return `Because only some grains were measured, ${what} has a standard error of ${size}, which the interval contains.`;
  }

  function prefer(sample, rows) {
    const evaluated = rows.filter((candidate) => !Number.isNaN(candidate.n));
    if (!evaluated.length) return rows;
    let chosen = evaluated[0];
    if (!Grains.isOneForm(sample)) {
      const within = evaluated.filter((candidate) => !candidate.outside);
      const inside = within.length ? within : evaluated.slice(-1);
      chosen = inside.reduce((best, candidate) => (candidate.error < best.error ? candidate : best));
    }
    chosen.preferred = true;
    return rows;
  }

  function predictR22(sample, features, name) {
    const least = DATA.nearly_one_form;
    const oneForm = Grains.isOneForm(sample);
    const nearly = !oneForm && Math.max(sample.sigma_FL, sample.sigma_EL) < least;
    const kind = oneForm || nearly ? "single_form" : "form_mixture";
    const model = (DATA.r22[name] ?? []).find((candidate) => candidate.model === kind);
    if (!model) return [];
    const n = model.intercept + dot(model.features.map((feature) => features[feature]), model.slopes);
    const quantities = model.ranges.map(([key, low, high]) => ranged(key, features[key] ?? sample[key], low, high));
    const remark = `sigma_FL and sigma_EL are below ${general(least)}: taken for one form`;
    return [row("r22", kind, [n, NaN, NaN, NaN], quantities, 3, nearly ? [remark] : [])];
  }

  function ranged(name, value, low, high) {
    return { name, value, low, high, distance: distanceOutside(value, low, high) };
  }

  // Distance of a value from a range, in widths of the range; 0 inside.
  function distanceOutside(value, low, high) {
    if (Number.isNaN(value)) return Infinity;
    const slack = 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    const beyond = Math.max(low - value, value - high);
    return beyond > slack ? beyond / (high - low) : 0;
  }

  const inWords = (name) => DATA.words[name] ?? name;

  // numbers: porosity, lower and upper end of its interval, and its error of few grains.
  function row(by, model, numbers, quantities, digits, remarks = []) {
    let [n, lower, upper, few_grains_error] = numbers;
    const outside = quantities.filter((quantity) => quantity.distance > 0);
    const distance = Math.max(0, ...outside.map((quantity) => quantity.distance));
    const texts = outside.map(
      ({ name, value, low, high }) =>
        `${inWords(name)} = ${general(value, 4)}, fitted from ${general(low, digits)} to ${general(high, digits)}`
    );
    let refused = "";
    if (distance > far) refused = describeFarthest(outside, digits);
    else if (!isPorosity(n)) refused = "its formula gives a porosity outside (0, 1)";
    else if (![lower, upper].every((value) => Number.isNaN(value) || isPorosity(value))) {
      refused = "its prediction interval reaches outside (0, 1)";
    }
    if (refused) n = lower = upper = few_grains_error = NaN;
    return {
      by, model, preferred: false, n, lower, upper, few_grains_error, outside: [...remarks, ...texts].join("; "), distance, refused,
      quantities,
    };
  }

  function describeFarthest(outside, digits) {
    const farthest = outside.reduce((worst, quantity) => (quantity.distance > worst.distance ? quantity : worst));
    const { name, value, low, high } = farthest;
    const reach = far * (high - low);
    const limit = value > high ? `above ${general(high + reach, digits)}` : `below ${general(low - reach, digits)}`;
    return (
      `${inWords(name)} = ${general(value, 4)} is ${limit}, fitted from ${general(low, digits)} to ${general(high, digits)}`
    );
  }

  const isPorosity = (value) => value >= DATA.smallest_porosity && value <= 1 - DATA.smallest_porosity;
  const dot = (a, b) => a.reduce((total, value, i) => total + value * b[i], 0);

  return {
    PREDICTORS, modelCase, kindOfBed, describeWithoutModel, predict, predictTwoAxes, fewGrainsHalf, describeFewGrains,
  };
})();
