// The model of size and form, as simcore.models.size_and_form evaluates it: a packing model that gives the one-class
// porosity for one sieve class, with its parameters in DATA.curve.model.
const Skeletons = (() => {
  const { InputError, general } = Numbers;
  const { reference: REFERENCE, fixed_q: Q } = DATA.curve;
  const [ROUNDS, TOLERANCE] = [60, 1e-13];
  const { sum } = Packing;

  const voidRatio = (porosity) => porosity / (1 - porosity);
  const volume = (porosity) => 1 / (1 - porosity);
  const limit = (curve, oneClass) => 1 - 1 / sum(oneClass.map((n, i) => volume(n) * curve.mass_fractions[i]));

  // Returns the porosity of a bed. oneClass: porosity of beds of one class, a number, or one per class of the curve.
  // ofRhine: that of the Rhine's grains, placed and shaken like these. model: as in DATA.curve.model.
  function predict(curve, oneClass, ofRhine = REFERENCE.porosity, model = DATA.curve.model) {
    const values = typeof oneClass === "number" ? curve.mass_fractions.map(() => oneClass) : oneClass;
    const n = (model.damped ? damped : evaluate)(curve, values, ofRhine, model);
    if (!(n > 0 && n < 1)) {
      throw new InputError(
        `${curve.name}: candidate ${model.candidate} gives the porosity ${general(n, 3)}; the curve is outside its range`
      );
    }
    return n;
  }

  function damped(curve, oneClass, ofRhine, model) {
    const { c, ...parameters } = model.parameters;
    const inner = evaluate(curve, oneClass.map(() => ofRhine), ofRhine, { ...model, parameters });
    const n1 = limit(curve, oneClass);
    const X = 1 - inner / ofRhine;
    const n = inner + (n1 - ofRhine) * Math.max(1 - c * X, 0);
    return Math.min(Math.max(n, leastPorosity(curve, oneClass)), n1);
  }

  // Porosity of a bed in which fine grains fill the pores of coarse ones without a gap, as in skeletons.py.
  function leastPorosity({ bounds, mass_fractions: shares }, oneClass) {
    const logs = bounds.map(Math.log);
    const width = Math.log(REFERENCE.bounds[1] / REFERENCE.bounds[0]);
    const cumulated = (values) => {
      const sums = [0];
      values.forEach((value, i) => sums.push(sums[i] + value));
      return (log) => interpolate(log, logs, sums);
    };
    const [mass, filled] = [cumulated(shares), cumulated(shares.map((share, i) => share * volume(oneClass[i])))];
    const volumeTo = (end) => 1 - mass(end) + filled(end) - filled(end - width);
    return 1 - 1 / Math.max(...logs.map(volumeTo), ...logs.slice(0, -1).map((log) => volumeTo(log + width)));
  }

  function evaluate(curve, oneClass, ofRhine, model) {
    const { K, m0 = 1, kappa = 0, p, s } = model.parameters;
    const stretch = oneClass.map((n) => m0 * (voidRatio(n) / voidRatio(ofRhine)) ** kappa);
    if (model.skeleton === "rods") return rods(curve, oneClass, stretch, model);
    const functions = p === undefined && s === undefined ? Packing.LINEAR : powerFunctions(p ?? 2.7, s ?? 2);
    const porosity = (sizes, fractions, porosities, m) => {
      const options = { stretch: m, functions };
      if (model.skeleton === "linear") return Packing.linear(sizes, fractions, porosities, options);
      return Packing.compressible(sizes, fractions, porosities, K, options);
    };
    return calibrated(porosity, curve, oneClass, stretch, model.law);
  }

  const powerFunctions = (p, s) => ({
    filling: (r) => (1 - r) ** p * (1 + Q * r),
    occupying: (r) => (1 - r) ** s,
  });

  // The one-size porosities are set so that REFERENCE, one sieve class, has the one-class porosity.
  function calibrated(porosity, curve, oneClass, stretch, law) {
    const reference = Packing.parts(REFERENCE, law);
    const { sizes, fractions, classes } = Packing.parts(curve, law);
    const known = new Map();
    const b = oneClass.map((n, i) => {
      const key = `${n} ${stretch[i]}`;
      if (!known.has(key)) known.set(key, ofOneSize(porosity, reference, n, stretch[i]));
      return known.get(key);
    });
    const n = porosity(sizes, fractions, classes.map((i) => b[i]), classes.map((i) => stretch[i]));
    return Math.min(n, limit(curve, oneClass));
  }

  function ofOneSize(porosity, { sizes, fractions }, n, stretch) {
    let b = n;
    for (let i = 0; i < ROUNDS; i += 1) {
      const left = n - porosity(sizes, fractions, b, stretch);
      b += left;
      if (Math.abs(left) <= TOLERANCE) break;
    }
    return b;
  }

  // If one-class porosity or stretch differ between classes, their means by mass apply to all rods.
  function rods(curve, oneClass, stretch, model) {
    const byMass = (values) => sum(values.map((value, i) => value * curve.mass_fractions[i]));
    const [V, m] = [byMass(oneClass.map(volume)), byMass(stretch)];
    const factor = Math.exp(interpolate(1 - 1 / V, ...model.factors));
    const solid = ({ sizes, fractions }) =>
      Packing.solidFraction(Packing.rodLengths(sizes.map((size) => size ** m), fractions), factor);
    const [mixed, one] = [curve, REFERENCE].map((classes) => solid(Packing.parts(classes, model.law)));
    return 1 - 1 / Math.min((V * one) / mixed, V);
  }

  function interpolate(x, nodes, values) {
    const found = nodes.findIndex((node) => node >= x);
    const i = found < 0 ? nodes.length - 1 : Math.max(found, 1);
    const within = Math.min(Math.max((x - nodes[i - 1]) / (nodes[i] - nodes[i - 1]), 0), 1);
    return values[i - 1] + within * (values[i] - values[i - 1]);
  }

  return { predict };
})();
