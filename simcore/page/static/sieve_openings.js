// Reads the openings of the sieves in a table, in mm, as simcore.grains.sieve_openings does.
const SieveOpenings = (() => {
  const { InputError, general } = Numbers;
  const { PHI, PSI, OPENING_UNITS } = SieveColumns;
  const rules = DATA.curve.reading;
  const PAN = new RegExp(`^(?:${rules.patterns.pan})$`, "iu");
  const [BELOW, ABOVE] = ["below", "above"].map((key) => new RegExp(`^(?:${rules.patterns[key]})$`, "u"));
  const WITH_UNIT = new RegExp(`^(?:${rules.patterns.with_unit})$`, "u");
  const COMMON_FRACTION = new RegExp(`^(?:${rules.patterns.fraction})$`, "u");

  // Returns {rows, openings, pan}: from fine to coarse; pan: the row of the pan, or null.
  function read(name, header, rows, columns) {
    const title = header[columns.opening];
    const textOf = ({ cells }) => cells[columns.opening];
    const named = rows.filter((row) => !PAN.test(textOf(row)));
    if (columns.unit === null && named.length && !named.some((row) => WITH_UNIT.test(textOf(row)))) {
      throw new InputError(
        `${name}: the unit of the column ${title} is missing, and units are never guessed; write it in the header, ` +
          `such as \`${title} [mm]\` or \`${title} [phi]\``
      );
    }
    const sizes = Rows.readEach(named, (row) => opening(`${name}, row ${row.row}`, title, textOf(row), columns.unit));
    const sieves = [...sizes].filter(([, size]) => size > 0).map(([row, size]) => ({ row, size }));
    const pans = rows.map(({ row }) => row).filter((row) => !(sizes.get(row) > 0));
    if (pans.length > 1) {
      throw new InputError(`${name}, row ${pans[1]}: this is a second pan, after row ${pans[0]}; remove one`);
    }
    if (sieves.length < 2) {
      const number = sieves.length ? "1 sieve" : "no sieves";
      throw new InputError(`${name}: the table has ${number}; at least two are needed`);
    }
    if (pans.length) {
      const pan = rows.find(({ row }) => row === pans[0]);
      checkPan(`${name}, row ${pan.row}`, title, textOf(pan), columns.unit, Math.min(...sieves.map(({ size }) => size)));
    }
    const largest = Math.max(...sieves.map(({ size }) => size));
    if (largest < rules.least_coarsest * 1e3) {
      throw new InputError(
        `${name}: the coarsest sieve is ${general(largest)} mm, finer than sand; correct the unit of ${title}, and write ` +
          "sizes without separators of thousands"
      );
    }
    checkOrder(name, sieves, columns.unit);
    if (sieves[0].size > sieves[1].size) sieves.reverse();
    return { rows: sieves.map(({ row }) => row), openings: sieves.map(({ size }) => size), pan: pans[0] ?? null };
  }

  // Refuses a row of the pan with another size, such as "< 2", than the finest sieve [mm].
  function checkPan(where, title, text, unit, finest) {
    const below = BELOW.exec(text);
    const own = below?.[2] ? SieveColumns.knownUnit(below[2]) : unit; // another word, such as `< 2 pan`, is no unit
    if (below === null || !SieveColumns.isLength(own)) return;
    const size = opening(where, title, below[1], own);
    if (Math.abs(size / finest - 1) <= rules.same_size) return;
    throw new InputError(
      `${where}: ${title} is '${text}', but the finest sieve is ${general(finest)} mm; add the sieve of ${general(size)} mm, ` +
        "or write `pan` if the row has all that passes the finest sieve"
    );
  }

  // Openings rise or fall. A single one without which the others do is wrong, or else the first unlike most of the steps.
  function checkOrder(name, sieves, unit) {
    const sizes = sieves.map(({ size }) => size);
    const signs = (values) => values.slice(1).map((value, i) => Math.sign(value - values[i]));
    const inOrder = (values) => signs(values).every((sign, _, all) => sign && sign === all[0]);
    if (inOrder(sizes)) return;
    const repeats = sizes.every((size, i) => sizes.some((other, k) => other === size && k !== i)) && new Set(sizes).size > 1;
    const advice = repeats
      ? "a table has one sieve curve, so that each sample needs its own file"
      : "order the sieves from coarse to fine or from fine to coarse, each once";
    const alone = sizes.flatMap((_, i) => (inOrder(sizes.filter((_, k) => k !== i)) ? [i] : []));
    let [i] = alone;
    let fault = "is out of the order of the other sieves; ";
    if (alone.length === 1) {
      const divided = sizes.map((size, k) => (k === i ? size / 1e3 : size));
      if (unit === "mm" && inOrder(divided)) fault += `it may be in µm, which is ${general(divided[i])} mm; if not, `;
    } else {
      const steps = signs(sizes);
      const direction = Math.sign(steps.reduce((a, b) => a + b)) || Math.sign(sizes.at(-1) - sizes[0]);
      i = steps.findIndex((sign) => sign !== direction || !sign) + 1;
      fault = `follows ${general(sizes[i - 1])} mm; `;
    }
    throw new InputError(
      `${name}, row ${sieves[i].row}: the opening ${general(sizes[i])} mm ${fault}${advice}`
    );
  }

  function noticesOfSize(title, unit, openings, passing) {
    if (SieveColumns.isLogarithm(unit) && openings.at(-1) < 1) {
      const [sign, ofGravel, other] = unit === PHI ? ["positive", "negative", PSI] : ["negative", "positive", PHI];
      return [
        `all sieves are finer than 1 mm, because ${title} is ${sign}; for gravel ${unit} is ${ofGravel}: if its sign was ` +
          `left out, name the column \`${other}\``,
      ];
    }
    const largest = openings.find((_, i) => !(passing[i] < 1)) ?? openings.at(-1);
    if (largest <= 1e3 * rules.most_coarsest) return [];
    return [
      `there are grains of about ${general(largest)} mm, which are too large for a sieve; the unit of ${title} may be µm`,
    ];
  }

  // Returns the opening in a cell [mm]; 0 only for a length of 0, which is the pan.
  function opening(where, title, text, unitOfColumn) {
    Numbers.checkSheetError(where, title, text);
    if (!/\d/.test(text)) {
      const is = text ? `${title} is '${text}', which is no size` : `${title} is empty`;
      throw new InputError(
        `${where}: ${is}; if the row has what passes the finest sieve, name it \`pan\`; if it is no sieve, remove the row`
      );
    }
    const above = ABOVE.exec(text);
    if (above) {
      const what =
        unitOfColumn === PHI
          ? "a larger phi is a finer size: name the row `pan` if it has what passes the finest sieve"
          : `write ${above[1]}: the row of a sieve has what stays on it`;
      throw new InputError(`${where}: ${title} is '${text}'; ${what}`);
    }
    let unit = unitOfColumn;
    const match = WITH_UNIT.exec(text);
    const own = match ? SieveColumns.knownUnit(match[2]) : null;
    if (unit === null && match && own === null) {
      throw new InputError(`${where}: ${title} is '${text}'; its unit is unknown; use ${OPENING_UNITS}`);
    }
    if (unit === null && own === null) {
      throw new InputError(
        `${where}: ${title} is '${text}', without a unit; write it as in the other rows, or for all rows in the ` +
          `header, such as \`${title} [mm]\``
      );
    }
    if (match && (unit === null || SieveColumns.isLogarithm(own) || SieveColumns.isLength(own))) [unit, text] = [own, match[1]];
    if (/^(?:no|nr|#)/i.test(text)) {
      throw new InputError(`${where}: ${title} is '${text}', a number of a sieve; give its opening instead, in mm`);
    }
    const plain = [...text].map((sign) => (sign in rules.single_signs ? ` ${rules.single_signs[sign]}` : sign)).join("");
    const fraction = COMMON_FRACTION.exec(plain.trim());
    if (fraction) {
      const [whole, numerator, denominator] = fraction.slice(1).map((part) => Number(part ?? 0));
      throw new InputError(
        `${where}: ${title} is '${text}'; write a fraction as a decimal number, ${general(whole + numerator / denominator)}`
      );
    }
    const value = Numbers.read(where, title, text);
    if (SieveColumns.isLogarithm(unit)) {
      if (Math.abs(value) > 20) {
        throw new InputError(
          `${where}: ${title} = ${general(value)} ${unit} is no sieve; ${unit} is ${unit === PHI ? "-" : ""}log2 of the ` +
            "opening in mm"
        );
      }
      return 2 ** (unit === PHI ? -value : value);
    }
    if (!SieveColumns.isLength(unit)) {
      throw new InputError(`${where}: ${title} is in ${unit}, which is not a length; use ${OPENING_UNITS}`);
    }
    if (value < 0) {
      throw new InputError(
        `${where}: the opening ${title} = ${general(value)} ${unit} is negative; write [phi] if it is in phi, or \`pan\` ` +
          `if the row has what passes ${general(-value)} ${unit}`
      );
    }
    return unit === "mm" ? value : value * rules.lengths[unit] * 1e3;
  }

  return { noticesOfSize, read };
})();
