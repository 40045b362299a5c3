// Packing models of the literature, as simcore.models.packing_models has them: porosity of a mixture of size classes.
const Packing = (() => {
  const ITERATIONS = 60;
  // Shares of the efficiency of filling and of occupying, by the ratio r of the smaller to the larger size.
  const LINEAR = {
    filling: (r) => (1 - r) ** 3.3 + 2.8 * r * (1 - r) ** 2.7,
    occupying: (r) => (1 - r) ** 2 + 0.4 * r * (1 - r) ** 3.7,
  };
  const COMPRESSIBLE = {
    filling: (r) => 1 - Math.sqrt(1 - (1 - r) ** 1.02),
    occupying: (r) => (1 - r) ** 1.5,
  };

  // sizes and volume fractions of the classes with mass, and the porosity of a bed of one class.
  function linear(sizes, fractions, oneClass) {
    return 1 - 1 / Math.max(...controlled(sizes, fractions, 1 / (1 - oneClass), LINEAR));
  }

  // K: compaction index. The harmonic mean is concave in P, so Newton's method from below is monotonic.
  function compressible(sizes, fractions, oneClass, K) {
    const W = (1 / (1 - oneClass)) * (K / (1 + K));
    const T = controlled(sizes, fractions, W, COMPRESSIBLE);
    const weights = fractions.map((fraction) => fraction * W);
    const top = T.indexOf(Math.max(...T));
    let P = T[top] + weights[top] / K;
    for (let i = 0; i < ITERATIONS; i += 1) {
      const shares = weights.map((weight, j) => weight / (P - T[j]));
      const total = shares.reduce((sum, share) => sum + share, 0);
      const slope = shares.reduce((sum, share, j) => sum + share / (P - T[j]), 0) / total ** 2;
      const step = (1 / K - 1 / total) / slope;
      P += step;
      if (Math.abs(step) <= 1e-14 * P) break;
    }
    return 1 - 1 / P;
  }

  // Specific volume of the mixture if each class controlled it; V: that of a bed of one class.
  function controlled(sizes, fractions, V, { filling, occupying }) {
    return sizes.map((own) =>
      sizes.reduce((sum, size, j) => {
        const r = Math.exp(-Math.abs(Math.log(size) - Math.log(own)));
        return sum + fractions[j] * (V - (size > own ? (V - 1) * occupying(r) : V * filling(r)));
      }, 0)
    );
  }

  // Returns the sizes (geometric means) and fractions of the classes with mass.
  function classes({ bounds, mass_fractions: fractions }) {
    const held = fractions.flatMap((fraction, i) => (fraction > 0 ? [i] : []));
    return [held.map((i) => Math.sqrt(bounds[i] * bounds[i + 1])), held.map((i) => fractions[i])];
  }

  return { linear, compressible, classes };
})();
