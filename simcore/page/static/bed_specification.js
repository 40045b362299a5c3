// The specification of a packing of a sieve curve, as simcore.packing.sieve_specification writes it without drawing grains.
const BedSpecification = (() => {
  const { InputError, general } = Numbers;
  const rule = DATA.curve.specification;
  const { sum } = Packing;

  // Returns { text, notices }, the text in YAML. curve: with bounds in mm. source: what it is called. sample: null for
  // synthetic pebbles.
  function write(curve, source, sample) {
    const bounds = curve.bounds.map((bound) => bound / 1e3); // [m]
    const shares = curve.mass_fractions;
    const largest = bounds.at(-1);
    const { width, solid, mass, grains } = amounts(bounds, shares);
    if (grains > rule.too_many) {
      throw new InputError(
        `a packing of this curve with ${rule.largest_grains} grains of its coarsest class has ${about(grains)} grains, ` +
          `more than can be packed; ${leaveOut(bounds, shares)}`
      );
    }
    const bed = mass / (rule.density * solid * width ** 2);
    const stem = source.replace(/(?<=.)\.[^.]+$/, "").replace(/[^A-Za-z0-9_.+-]+/g, "_").replace(/^[_.+-]+|[_.+-]+$/g, "");
    const height = Math.max(Math.ceil(rule.domain * bed * 100) / 100, rule.least_domain);
    const notices = [];
    if (grains > rule.many) {
      notices.push(
        `the packing has ${about(grains)} grains, most of them fine, and takes days on one core; \`explain\` prints its ` +
          `cost. If that is too much, ${leaveOut(bounds, shares)}`
      );
    }
    const text = `# Packs the sieve curve of ${source}. See what it costs:  scree explain THIS_FILE
name: "${stem || "sieve"}"
seed: 1
sizes:
  bounds: [${bounds.map((bound) => `${general(bound * 1e3, 6)} mm`).join(", ")}]
  mass_fractions: [${rounded(shares).map((share) => share.toFixed(6)).join(", ")}]
  draw: ${shares.length > 1 ? "quota" : "random"}
${shapes(sample)}
faces: ${rule.faces}
# Width and height of the bed are ${general(rule.width)} and ${(bed / largest).toFixed(0)} times the largest sieve opening.
domain: {type: periodic, width: ${general(width * 1e3)} mm, height: ${general(height)} m}
amount: {mass: ${general(mass, 3)} kg}
accuracy: standard
${rule.process}
# Contacts of so short a time are stiff enough that falling grains do not sink into the finest ones.
numerics: {contact_time: ${general(contactTime(bounds[0], height) * 1e3, 3)} ms}
`;
    return { text, notices };
  }

  // Width [m], solid fraction, mass [kg] and expected number of grains of the bed. bounds in metres.
  function amounts(bounds, shares) {
    const largest = bounds.at(-1);
    const width = Math.ceil(rule.width * largest * 1e3) / 1e3;
    const volumes = shares.map((_, i) => classMean(bounds[i], bounds[i + 1], 3));
    const numbers = shares.map((share, i) => share / volumes[i]);
    const total = sum(numbers);
    const centres = shares.map((_, i) => Math.log2(Math.sqrt(bounds[i] * bounds[i + 1])));
    const mean = sum(shares.map((share, i) => share * centres[i]));
    const spread = Math.sqrt(sum(shares.map((share, i) => share * (centres[i] - mean) ** 2)));
    const solid = Math.min(rule.solid + rule.by_spread * spread, rule.largest_solid);
    const grain = rule.density * (Math.PI / 6) * sum(numbers.map((number, i) => (number / total) * volumes[i]));
    const mass = Math.max(
      rule.density * solid * width ** 2 * rule.height * largest, (rule.largest_grains * grain) / (numbers.at(-1) / total)
    );
    return { width, solid, mass, grains: mass / grain };
  }

  // What to leave out so that at most `many` grains remain; the coarsest class has fewer.
  function leaveOut(bounds, shares) {
    const from = (k) => shares.slice(k).map((share) => share / sum(shares.slice(k)));
    const grainsFrom = (k) => amounts(bounds.slice(k), from(k)).grains;
    let k = 1;
    while (k < shares.length - 1 && grainsFrom(k) > rule.many) k += 1;
    const share = 100 * (1 - sum(shares.slice(k)) / sum(shares));
    return (
      `leave out the grains below ${general(bounds[k] * 1e3, 6)} mm, which are ${general(share, 3)}% of the mass; then ` +
      `the packing has ${about(grainsFrom(k))} grains`
    );
  }

  // A number rounded to two digits, such as "2 900 000".
  function about(number) {
    return Number(number.toPrecision(2)).toFixed(0).replace(/\B(?=(\d{3})+$)/g, " ");
  }

  function shapes(sample) {
    if (sample === null) {
      return `# A sieve curve says nothing about form: these are synthetic pebbles. If you have measured flatness
# S/I and elongation I/L, write their means and deviations here, as in examples/sieve_and_form.yaml.
shapes: {kind: polyhedron, choice: random}`;
    }
    const normal = (key) => `{mean: ${sample[`mu_${key}`].toFixed(4)}, std: ${sample[`sigma_${key}`].toFixed(4)}}`;
    return `# Flatness S/I and elongation I/L as measured.
shapes:
  kind: polyhedron
  choice: form_distribution
  flatness: ${normal("FL")}
  elongation: ${normal("EL")}`;
  }

  // Mean of D^power over sizes that are uniform in log D.
  function classMean(low, high, power) {
    const half = 0.5 * power * Math.log(high / low);
    return (Math.sqrt(low * high) ** power * Math.sinh(half)) / half;
  }

  // A contact time [s] at which no impact is deeper than a quarter of the thinnest of the finest grains.
  function contactTime(finest, height) {
    const longest = (0.25 * 0.4 * finest) / (0.14 * Math.sqrt(rule.speed ** 2 + 2 * 9.81 * height));
    const digit = 10 ** (Math.floor(Math.log10(longest)) - 1);
    return Math.min(2e-3, Math.floor(longest / digit) * digit);
  }

  // Shares rounded to 1e-6 whose sum is 1; the largest takes up the difference.
  function rounded(shares) {
    const values = shares.map((share) => Math.round(share * 1e6) / 1e6);
    const top = values.indexOf(Math.max(...values));
    values[top] += 1 - sum(values);
    return values;
  }

  return { write };
})();
