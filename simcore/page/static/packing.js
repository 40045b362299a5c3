// Packing models of the literature, as simcore.models.packing_models has them: porosity of a mixture of size classes.
// sizes and fractions: of the classes with mass, by volume. porosity: of beds of one class, a number or one per class.
// stretch: exponent of the size ratios by class, of the coarser class of a pair; 1 is the published model.
const Packing = (() => {
  const { InputError, general } = Numbers;
  const ITERATIONS = 60;
  const { parts: WIDEST, rods: RODS } = DATA.curve;
  // Shares of the efficiency of filling and of occupying, by the ratio r of the smaller to the larger size.
  const LINEAR = {
    filling: (r) => (1 - r) ** 3.3 + 2.8 * r * (1 - r) ** 2.7,
    occupying: (r) => (1 - r) ** 2 + 0.4 * r * (1 - r) ** 3.7,
  };
  const COMPRESSIBLE = {
    filling: (r) => 1 - Math.sqrt(1 - (1 - r) ** 1.02),
    occupying: (r) => (1 - r) ** 1.5,
  };
  const [MIXING, STRONG, SLACK] = [0.154, 0.741, 1e-12]; // of the linear-mixture model: ratios of sizes

  const sum = (values) => values.reduce((total, value) => total + value, 0);
  const largest = (values) => values.reduce((most, value) => Math.max(most, value), -Infinity);
  const byClass = (values, sizes) => (typeof values === "number" ? sizes.map(() => values) : values);
  const volume = (porosity) => 1 / (1 - porosity);

  function linear(sizes, fractions, porosity, { stretch = 1, functions = LINEAR } = {}) {
    const volumes = byClass(porosity, sizes).map(volume);
    return 1 - 1 / largest(controlled(sizes, fractions, volumes, byClass(stretch, sizes), functions));
  }

  // K: compaction index. The harmonic mean is concave in P, so Newton's method from below is monotonic.
  function compressible(sizes, fractions, porosity, K, { stretch = 1, functions = COMPRESSIBLE } = {}) {
    const volumes = byClass(porosity, sizes).map((n) => volume(n) * (K / (1 + K)));
    if (!volumes.every((W) => W > 1)) {
      const least = Math.min(...byClass(porosity, sizes));
      throw new InputError(
        `compressible packing model: with K = ${general(K)} a class of the porosity ${general(least, 3)} has a virtual ` +
          "density above 1; give a larger K"
      );
    }
    const T = controlled(sizes, fractions, volumes, byClass(stretch, sizes), functions);
    const weights = fractions.map((fraction, j) => fraction * volumes[j]);
    const top = T.indexOf(largest(T));
    let P = T[top] + weights[top] / K;
    for (let i = 0; i < ITERATIONS; i += 1) {
      const shares = weights.map((weight, j) => weight / (P - T[j]));
      const total = sum(shares);
      const slope = sum(shares.map((share, j) => share / (P - T[j]))) / total ** 2;
      const step = (1 / K - 1 / total) / slope;
      P += step;
      if (Math.abs(step) <= 1e-14 * P) break;
    }
    return 1 - 1 / P;
  }

  // Specific volume of the mixture if each class controlled it; V: those of beds of one class.
  function controlled(sizes, fractions, V, m, { filling, occupying }) {
    const logs = sizes.map(Math.log);
    return sizes.map((_, i) =>
      sum(
        sizes.map((_, j) => {
          const difference = logs[j] - logs[i];
          const r = Math.exp(-Math.abs(difference) * (difference > 0 ? m[j] : m[i]));
          return fractions[j] * (V[j] - (difference > 0 ? (V[j] - 1) * occupying(r) : V[j] * filling(r)));
        })
      )
    );
  }

  // Linear-mixture model: classes of similar size mix, others fill or occupy as in the linear packing model.
  function linearMixture(sizes, fractions, porosity) {
    const V = byClass(porosity, sizes).map(volume);
    const logs = sizes.map(Math.log);
    const ratio = (i, j) => Math.exp(-Math.abs(logs[i] - logs[j]));
    const strength = {
      symmetric: (density) => 10.288 * 10 ** (-1.4566 * density),
      skewed: (d) => -1.3092 + 15.039 * d - 37.453 * d ** 2 + 40.869 * d ** 3 - 17.11 * d ** 4,
    };
    const symmetric = (r) => -1.0002 + 0.1126 * r + 5.8455 * r ** 2 - 7.9488 * r ** 3 + 3.1222 * r ** 4;
    const skewed = (r) => -1.0029 + 0.3589 * r + 10.97 * r ** 2 - 22.197 * r ** 3 + 12.434 * r ** 4;
    const T = sizes.map((_, i) => {
      const mixes = sizes.map((_, j) => ratio(i, j) >= MIXING - SLACK);
      const share = sum(fractions.filter((_, j) => mixes[j]));
      const x = fractions.map((fraction, j) => (mixes[j] ? fraction / share : 0));
      const mean = sum(x.map((value, j) => value * V[j]));
      let [product, skew] = [0, 0];
      x.forEach((fine, l) =>
        x.forEach((coarse, h) => {
          if (!(logs[h] > logs[l]) || ratio(h, l) > STRONG + SLACK) return;
          product += fine * coarse * symmetric(ratio(h, l));
          skew += (fine * coarse ** 2 - fine ** 2 * coarse) * skewed(ratio(h, l));
        })
      );
      const mixed = mean + strength.symmetric(1 / mean) * product + strength.skewed(1 / mean) * skew;
      const others = fractions.map((fraction, j) => {
        if (mixes[j]) return 0;
        const r = ratio(i, j);
        const kept = logs[j] > logs[i] ? mixed - (mixed - 1) * LINEAR.occupying(r) : mixed * (1 - LINEAR.filling(r));
        return fraction * kept;
      });
      return share * mixed + sum(others);
    });
    return 1 - 1 / largest(T);
  }

  // Rods on a line: lengths at equal quantiles of their law, longest first.
  function rodLengths(sizes, fractions) {
    const order = [...sizes.keys()].sort((a, b) => sizes[a] - sizes[b]);
    const squares = order.map((i) => sizes[i] ** 2);
    const met = order.map((i, k) => fractions[i] / Math.sqrt(squares[k]));
    const total = sum(met);
    const knots = [0, ...squares];
    const share = knots.map((knot) => sum(squares.map((square, k) => Math.min(1, knot / square) * (met[k] / total))));
    const lengths = new Float64Array(RODS.number);
    for (let i = 0, k = knots.length - 2; i < RODS.number; i += 1) {
      const quantile = (RODS.number - i - 0.5) / RODS.number;
      while (k > 0 && share[k] > quantile) k -= 1;
      const within = (quantile - share[k]) / (share[k + 1] - share[k]);
      lengths[i] = Math.sqrt(knots[k] + Math.min(Math.max(within, 0), 1) * (knots[k + 1] - knots[k]));
    }
    return lengths;
  }

  // Solid fraction after each rod is placed into the largest gap, at the distance `factor` times its length.
  function solidFraction(lengths, factor) {
    const gaps = new Float64Array(lengths.length); // heap with the largest gap at its root
    gaps[0] = factor * lengths[0];
    for (let count = 1; count < lengths.length; count += 1) {
      const least = factor * lengths[count];
      const second = Math.max(gaps[0] - lengths[count] - least, least);
      let node = 0;
      for (;;) {
        let child = 2 * node + 1;
        if (child >= count) break;
        if (child + 1 < count && gaps[child + 1] > gaps[child]) child += 1;
        if (gaps[child] <= least) break;
        gaps[node] = gaps[child];
        node = child;
      }
      gaps[node] = least;
      node = count;
      while (node > 0) {
        const parent = (node - 1) >> 1;
        if (gaps[parent] >= second) break;
        gaps[node] = gaps[parent];
        node = parent;
      }
      gaps[node] = second;
    }
    const solid = lengths.reduce((total, value) => total + value, 0);
    return solid / (solid + gaps.reduce((total, value) => total + value, 0));
  }

  // Returns the factor at which rods of these lengths have this porosity.
  function factorOf(porosity, lengths) {
    const difference = (log) => 1 - solidFraction(lengths, Math.exp(log)) - porosity;
    let [low, high] = [Math.log(RODS.smallest), Math.log(RODS.largest)];
    const ends = [low, high].map((log) => 1 - solidFraction(lengths, Math.exp(log)));
    if (ends[0] > porosity || ends[1] < porosity) {
      throw new InputError(
        `rods on a line: no distance between rods gives the one-class porosity ${general(porosity, 4)}; give one from ` +
          `${ends[0].toFixed(2)} to ${ends[1].toFixed(2)}`
      );
    }
    // Illinois method: the secant, with the weight of an end halved that is kept twice.
    let [below, above, kept] = [ends[0] - porosity, ends[1] - porosity, 0];
    for (let i = 0; i < 200 && high - low > 1e-13; i += 1) {
      const middle = (low * above - high * below) / (above - below);
      const value = difference(middle);
      if (value === 0) return Math.exp(middle);
      if (value < 0) {
        if (middle === low) break;
        [low, below] = [middle, value];
        if (kept === 1) above /= 2;
        kept = 1;
      } else {
        if (middle === high) break;
        [high, above] = [middle, value];
        if (kept === -1) below /= 2;
        kept = -1;
      }
      if (Math.abs(value) < 1e-14) return Math.exp(middle);
    }
    return Math.exp(0.5 * (low + high));
  }

  let equalRods = null;
  let lastRods = [NaN, NaN]; // one-class porosity and its factor

  function rods(sizes, fractions, porosity) {
    equalRods ??= rodLengths([1], [1]);
    if (lastRods[0] !== porosity) lastRods = [porosity, factorOf(porosity, equalRods)];
    return 1 - solidFraction(rodLengths(sizes, fractions), lastRods[1]);
  }

  // Returns the sizes (geometric means) and fractions of the classes with mass.
  function classes({ bounds, mass_fractions: fractions }) {
    const held = fractions.flatMap((fraction, i) => (fraction > 0 ? [i] : []));
    return [held.map((i) => Math.sqrt(bounds[i] * bounds[i + 1])), held.map((i) => fractions[i])];
  }

  // Returns sizes, fractions and classes of the parts of the classes with mass. law: how mass is distributed in a class.
  function parts({ bounds, mass_fractions: fractions }, law) {
    const [sizes, shares, owners] = [[], [], []];
    fractions.forEach((mass, index) => {
      if (!(mass > 0)) return;
      const [low, high] = [Math.log(bounds[index]), Math.log(bounds[index + 1])];
      const number = Math.max(Math.ceil((high - low) / Math.log(WIDEST) - 1e-9), 1);
      const logs = [...Array(number + 1).keys()].map((i) => low + (i / number) * (high - low));
      // Under a density proportional to D³ d ln D in a part of the width h, the mean of ln D is that of its bounds by
      // their cubes, less 1/3.
      const cubes = logs.map((log) => Math.exp(3 * (log - high)));
      for (let i = 0; i < number; i += 1) {
        const step = cubes[i + 1] - cubes[i];
        const mean = (cubes[i + 1] * logs[i + 1] - cubes[i] * logs[i]) / step - 1 / 3;
        sizes.push(Math.exp(law === "mass" ? 0.5 * (logs[i] + logs[i + 1]) : mean));
        shares.push(mass * (law === "mass" ? 1 / number : step / (1 - cubes[0])));
        owners.push(index);
      }
    });
    return { sizes, fractions: shares, classes: owners };
  }

  return { LINEAR, linear, compressible, linearMixture, rods, rodLengths, solidFraction, classes, parts, sum };
})();
