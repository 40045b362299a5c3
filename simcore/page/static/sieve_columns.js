// Recognises the columns of a table of a sieve curve by their names, as simcore.grains.sieve_columns does.
const SieveColumns = (() => {
  const { InputError } = Numbers;
  const { words: lists, spellings, lengths, masses, patterns, needed } = DATA.curve.reading;
  const WORDS = Object.fromEntries(Object.entries(lists).map(([key, values]) => [key, new Set(values)]));
  const BRACKETS = new RegExp(patterns.brackets, "u");
  const TRAILING = new RegExp(patterns.trailing, "iu");
  const [PHI, PSI, PERCENT, FRACTION] = ["phi", "psi", "%", "1"];
  const OPENING = "opening";
  const [RETAINED, PASSING, CUMULATIVE] = ["retained", "passing", "cumulative retained"];
  const UNITS = new Set([...Object.keys(lengths), ...Object.keys(masses), PHI, PSI, PERCENT, FRACTION]);
  const OPENING_UNITS = [...Object.keys(lengths), PHI, PSI].join(", ");

  const isLength = (unit) => unit !== null && unit in lengths;
  const isLogarithm = (unit) => unit === PHI || unit === PSI;
  const isMass = (unit) => unit !== null && unit in masses;
  const have = (words, key) => [...words].some((word) => WORDS[key].has(word));

  // classes: position of a column of classes whose cells have been replaced by openings with their unit, or null.
  // Returns {opening, unit, amounts}: position and unit (null: the cells have it) of the openings, and the columns of
  // amounts as {position, meaning, unit}.
  function recognise(name, { header, rows }, classes) {
    const [openings, amounts] = [[], []];
    const gross = header.find(hasMassOfSieve);
    header.forEach((title, position) => {
      if (gross !== undefined && mayBeMassOfSieve(title)) return;
      const { meaning, unit } = position === classes ? { meaning: OPENING, unit: null } : meaningOf(name, title);
      if (meaning === OPENING) openings.push({ position, unit });
      else if (meaning !== null) amounts.push({ position, meaning, unit });
    });
    const titles = header.map((title) => title || "(no name)");
    if (!openings.length) throw new InputError(`${name}: none of the columns (${titles.join(", ")}) has sieve openings; ${needed}`);
    if (!amounts.length && gross !== undefined) {
      throw new InputError(
        `${name}: the column ${gross} has the mass of the sieve in it; give the mass of the grains, which is the ` +
          "difference, in a column `mass [g]`"
      );
    }
    if (!amounts.length) throw new InputError(`${name}: ${withoutAmounts(titles, rows, openings[0].position)}`);
    if (openings.length > 1) {
      const both = openings.slice(0, 2).map(({ position }) => header[position]).join(" and ");
      throw new InputError(`${name}: the columns ${both} are both sieve openings; remove one`);
    }
    if (openings[0].position !== classes) checkLowerSize(name, header[openings[0].position], amounts);
    const kinds = amounts.map(({ meaning, unit }) => `${meaning} ${isMass(unit)}`);
    kinds.forEach((kind, i) => {
      const before = kinds.indexOf(kind);
      if (before === i) return;
      const both = [before, i].map((k) => header[amounts[k].position]).join(" and ");
      throw new InputError(`${name}: the columns ${both} are both the amount ${amounts[i].meaning}; remove one`);
    });
    return { opening: openings[0].position, unit: openings[0].unit, amounts };
  }

  // Refuses the upper or mean sizes of classes if an amount is of the sieve below them.
  function checkLowerSize(name, title, amounts) {
    const [text] = splitUnit(title);
    const words = plainWords(text);
    const kind = have(words, "upper") || text.includes("<") ? "upper" : have(words, "mean_size") ? "mean" : null;
    if (kind === null || amounts.some(({ meaning }) => meaning === PASSING)) return;
    throw new InputError(
      `${name}: the column ${title} seems to have the ${kind} sizes of classes, but the sieve is needed that retains a ` +
        "class; give that sieve, such as `opening [mm]`, or both bounds as `from [mm]` and `to [mm]`; if the table has them, remove " +
        "this column"
    );
  }

  // Returns what is wrong with a table without amounts: a column for each of several samples, counts of grains, or no numbers.
  function withoutAmounts(titles, rows, opening) {
    const counts = titles.filter(countsGrains);
    const numeric = titles.filter((title, i) => {
      const texts = rows.map(({ cells }) => cells[i]).filter((text) => text);
      return i !== opening && !counts.includes(title) && texts.length && texts.every((text) => Numbers.NUMBER.test(text));
    });
    if (numeric.length > 1) {
      return `the columns ${numeric.join(", ")} are not named as amounts; a table has one sieve curve, so that each sample ` +
        "needs its own file with a column such as `mass [g]`";
    }
    if (!counts.length) return `none of the columns (${titles.join(", ")}) has amounts; ${needed}`;
    return `the column ${counts[0]} has counts of grains; a sieve curve needs masses, such as \`mass [g]\`. Counts on a ` +
      "grid on the surface (Wolman) may be named `retained`";
  }

  const countsGrains = (title) => have(plainWords(title), "count");

  // Returns whether a column with this title has masses of sieves, with or without the grains on them.
  function hasMassOfSieve(title) {
    const [text] = splitUnit(title);
    const words = plainWords(text);
    const both = (text.includes("+") || have(words, "joining")) && have(words, "sieve") && have(words, "grains");
    const only = [...words].every((word) => WORDS.sieve.has(word) || WORDS.of.has(word));
    const alone = only && have(words, "sieve") && ["of", "des", "du"].some((word) => words.has(word));
    return have(words, "gross") || both || alone;
  }

  // Returns whether a title, such as "sieve mass [g]", means the mass of the sieves beside one with grains on them.
  function mayBeMassOfSieve(title) {
    const [text, unit] = splitUnit(title);
    const words = plainWords(text);
    const only = [...words].every((word) => WORDS.sieve.has(word) || WORDS.mass.has(word));
    return (have(words, "mass") || isMass(knownUnit(unit ?? ""))) && only && have(words, "sieve");
  }

  // Returns the title without its unit, and the text of the unit or undefined.
  function splitUnit(title) {
    const match = BRACKETS.exec(title) ?? TRAILING.exec(title);
    return match ? [title.slice(0, match.index), match[1]] : [title, undefined];
  }

  const unitInName = (title) => splitUnit(title)[1];

  // Returns a unit in one spelling, or null if it is unknown.
  function knownUnit(text) {
    const lower = text.toLowerCase();
    const unit = spellings[text] ?? spellings[lower] ?? lower;
    return UNITS.has(unit) ? unit : null;
  }

  const plainWords = (text) => new Set(text.toLowerCase().match(/[\p{L}\p{Nl}\p{No}]+/gu) ?? []);

  function split(name, title) {
    const text = title.toLowerCase();
    const bare = knownUnit(text);
    if (isLogarithm(bare)) return [new Set([bare]), bare];
    if (isLength(bare)) return [new Set([OPENING]), bare];
    if (isMass(bare) || bare === PERCENT) return [new Set(["retained"]), bare];
    const match = BRACKETS.exec(title) ?? TRAILING.exec(title);
    let unit = match ? knownUnit(match[1]) : null;
    const words = plainWords(match ? text.slice(0, match.index) : text);
    if (match && unit === null && match[1] && ["opening", "retained", "passing"].some((key) => have(words, key))) {
      throw new InputError(
        `${name}: the column ${title} has the unknown unit '${match[1]}'; sieve openings are in ${OPENING_UNITS}, ` +
          `amounts in ${Object.keys(masses).join(", ")} or %`
      );
    }
    if (unit === null && (words.has("percent") || words.has("pct") || text.includes("%"))) unit = PERCENT;
    if (unit === null && (words.has("fraction") || words.has("fractions"))) unit = FRACTION;
    return [words, unit];
  }

  // Returns {meaning, unit} of a column with this title: OPENING, RETAINED, PASSING, CUMULATIVE or null.
  function meaningOf(name, title) {
    const [words, unit] = split(name, title);
    const summed = have(words, "summed");
    const retained = have(words, "retained");
    let meaning;
    if (hasMassOfSieve(title)) return { meaning: null, unit };
    if (have(words, "passing")) meaning = PASSING;
    else if (have(words, "coarser")) meaning = CUMULATIVE;
    else if (summed && have([...words].filter((word) => word !== "percent"), "retained")) meaning = CUMULATIVE;
    else if (summed) {
      throw new InputError(
        `${name}: the column ${title} may be passing or retained; name it \`passing [%]\` or \`cumulative retained [%]\``
      );
    } else if (retained) meaning = RETAINED;
    else if (have(words, "opening")) meaning = OPENING;
    else return { meaning: null, unit };
    const ofLength = isLength(unit) || isLogarithm(unit);
    if (meaning === OPENING && unit !== null && !ofLength) {
      throw new InputError(
        `${name}: the column ${title} is in ${unit}, but sieve openings are a length; correct its name`
      );
    }
    if (meaning !== OPENING && ofLength) {
      throw new InputError(
        `${name}: the column ${title} is in ${unit}, but amounts are masses or percent; correct its name`
      );
    }
    return { meaning, unit };
  }

  return {
    PHI, PSI, PERCENT, FRACTION, OPENING, RETAINED, PASSING, CUMULATIVE, OPENING_UNITS,
    countsGrains, isLength, isLogarithm, isMass, knownUnit, meaningOf, recognise, splitUnit, unitInName,
  };
})();
