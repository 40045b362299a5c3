// Recognises the columns of a table of grains by their names, as simcore.grains.form_columns does.
const Columns = (() => {
  const { InputError } = Numbers;
  const AXES = ["L", "I", "S"];
  const RATIOS = ["FL", "EL"];
  const MEANS = ["mean_FL", "std_FL", "mean_EL", "std_EL"];
  const TWO_AXES = ["L", "I"];
  const { patterns, needed, no_deviations: noDeviations, sample_names: sampleNames } = DATA.reading;
  const whole = (pattern) => new RegExp(`^(?:${pattern})$`, "iu");
  const compiled = (table) => Object.entries(table).map(([name, pattern]) => [name, whole(pattern)]);
  const FORMS = compiled(patterns.forms);
  const AXIS_NAMES = Object.values(patterns.axes).map(whole);
  const PERCENT = Object.fromEntries(compiled(patterns.percent));
  const [MINOR, COUNTS, RUNNING] = [whole(patterns.minor), whole(patterns.counts), whole(patterns.running)];

  // Returns {kind, forms, counts, sample}: positions in the header, -1 where there is no such column.
  function recognise(name, header, sample) {
    const names = recogniseForms(name, header);
    const kind = [AXES, RATIOS, MEANS, TWO_AXES].find((all) => all.every((meaning) => names[meaning]));
    if (!kind) throw new InputError(`${name}: ${whatIsMissing(header, names)}; ${needed}`);
    const forms = kind.map((meaning) => only(name, header, names[meaning], meaning));
    if (kind === AXES || kind === TWO_AXES) checkUnits(name, kind, forms.map((position) => unit(header[position])));
    const by = findSample(name, header, sample, forms);
    const counts = header.flatMap((text, i) => (i !== by && !forms.includes(i) && COUNTS.test(text) ? [i] : []));
    // Beside means, `n` may be a porosity.
    const likely = kind === MEANS && counts.length > 1 ? counts.filter((i) => !RUNNING.test(header[i])) : counts;
    const count = likely.length ? only(name, header, likely, "the number of grains") : -1;
    return { kind, forms, counts: count, sample: by };
  }

  function recogniseForms(name, header) {
    const names = {};
    header.forEach((text, position) => {
      for (const [meaning, pattern] of FORMS) {
        if (pattern.test(text)) (names[meaning] ??= []).push(position);
        else if (PERCENT[meaning]?.test(text)) {
          throw new InputError(
            `${name}: the column ${text} is in percent; give ${meaning} as a fraction, 0.65 not 65`
          );
        }
      }
    });
    if (names.S && !names.I && names.S.every((i) => MINOR.test(header[i]))) {
      names.I = names.S; // without a middle axis, major and minor are those of an ellipse in a photo
      delete names.S;
    }
    for (const axis of AXES.filter((key) => names[key])) {
      const units = names[axis].map((i) => unit(header[i]));
      const ofLength = names[axis].filter((_, k) => !["px", "pi"].includes((units[k] ?? "px").slice(0, 2)));
      if (ofLength.length === 1 && units.every((value) => value)) names[axis] = ofLength;
    }
    return names;
  }

  function whatIsMissing(header, names) {
    const columns = header.map((text) => text || "(no name)").join(", ");
    for (const kind of [MEANS, RATIOS, AXES]) {
      const missing = kind.filter((meaning) => !names[meaning]);
      if (missing.length < kind.length) {
        const are = missing.length === 1 ? `column ${missing[0]} is` : `columns ${missing.join(", ")} are`;
        const hint = missing.join() === "std_FL,std_EL" ? ` (${noDeviations})` : "";
        return `the ${are} missing beside ${columns}${hint}`;
      }
    }
    const named = header.filter((text) => /^(?:flatness|elongation)/i.test(text));
    if (named.length) {
      return (
        `${named.join(" and ")} may be defined in several ways; if FL = S/I and EL = I/L are meant, name the columns ` +
        "FL and EL"
      );
    }
    for (const text of header) {
      const [, axis, given] = /^(.*?)\s*[[(]\s*(.*?)\s*[\])]$/.exec(text) ?? [];
      if (axis !== undefined && AXIS_NAMES.some((names) => names.test(axis))) {
        return `the column ${text} has the unknown unit '${given}'; axes are in m, cm, mm, µm, in, ft or pixels`;
      }
    }
    if (header.some((text) => /^[-+.]?\d/.test(text))) {
      return `the first row (${columns}) contains numbers where the names of the columns are needed`;
    }
    return `none of its columns (${columns}) is an axis or a form`;
  }

  function only(name, header, positions, meaning) {
    if (positions.length === 1) return positions[0];
    const [first, second] = positions.map((position) => header[position]);
    if (first === second) throw new InputError(`${name}: two columns are named ${first}; remove or rename one`);
    throw new InputError(`${name}: the columns ${first} and ${second} are both ${meaning}; remove one`);
  }

  function findSample(name, header, sample, forms) {
    const given = sample ? [sample.trim().split(/\s+/).join(" ")] : sampleNames;
    for (const [wanted, normalise] of given.flatMap((one) => [[one, (t) => t], [one, (t) => t.toLowerCase()]])) {
      const positions = header.flatMap((text, i) => (normalise(text) === normalise(wanted) ? [i] : []));
      if (!positions.length) continue;
      const position = only(name, header, positions, "the sample");
      if (forms.includes(position)) {
        throw new InputError(`${name}: ${wanted} is a form, not the name of a sample; name another column`);
      }
      return position;
    }
    if (!sample) return -1;
    throw new InputError(
      `${name}: there is no column ${sample} to distinguish the samples; the columns are ${header.join(", ")}`
    );
  }

  function checkUnits(name, kind, units) {
    if (new Set(units).size < 2) return;
    const mixed = kind.map((axis, i) => `${axis} in ${units[i] ?? "no unit"}`).join(", ");
    const axes = kind === AXES ? "all three axes" : "both axes";
    throw new InputError(`${name}: the header mixes units (${mixed}); give ${axes} in one unit`);
  }

  // Returns the unit in the name of a column of axes, in one spelling, or null.
  function unit(text) {
    for (const [meaning, pattern] of FORMS.filter(([key]) => AXES.includes(key))) {
      const match = meaning && pattern.exec(text);
      if (match) {
        const found = match.slice(1).find((group) => group);
        return found ? found.toLowerCase().replace(/^(?:[uμ]m|microns?)$/, "µm") : null;
      }
    }
    return null;
  }

  return { AXES, RATIOS, MEANS, TWO_AXES, recognise, mayNumberRows: (text) => RUNNING.test(text), findSample };
})();
