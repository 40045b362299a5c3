// Sieve classes such as "8-11.2 mm", as simcore.grains.class_labels and sieve_classes read them. Sizes are in mm here.
const SieveClasses = (() => {
  const { InputError, general } = Numbers;
  const { OPENING, RETAINED } = SieveColumns;
  const rules = DATA.curve.reading;
  const whole = (pattern) => new RegExp(`^(?:${pattern})$`, "iu");
  const [CLASS_NAME, CLASS_LABEL] = ["name", "label"].map((key) => whole(DATA.curve.classes[key]));
  const [PAN, OPEN_END] = [rules.patterns.pan, rules.patterns.open_end].map(whole);

  const lengthOf = (unit) => (unit === "mm" ? 1 : rules.lengths[unit] * 1e3);

  // Returns {low, high}; where: file and row, for messages. unitOfColumn: that in the name of the column, or undefined.
  function boundsOf(where, column, label, unitOfColumn) {
    const match = CLASS_LABEL.exec(label);
    const is = `${where}: ${column} is '${label}'`;
    const inHeader = unitOfColumn ? "" : `, or put the unit in the header, \`${column} [mm]\``;
    if (!match) {
      const example = unitOfColumn ? "8-11.2" : "8-11.2 mm";
      throw new InputError(`${is}; give both sieves, such as '${example}'${inHeader}`);
    }
    const [, low, lowUnit, mark, high, given] = match;
    const highUnit = given || unitOfColumn;
    if (!highUnit) throw new InputError(`${is} without a unit; write it as '${label} mm'${inHeader}`);
    if (mark === "/" && SieveColumns.knownUnit(highUnit) === "in") {
      throw new InputError(`${is}, which may be a fraction of an inch; write a class as '${low}-${high}'`);
    }
    const [lower, upper] = [[low, lowUnit || highUnit], [high, highUnit]].map(([text, unit]) => {
      const value = Numbers.read(`${where}, ${column} '${label}'`, "size", text);
      const known = SieveColumns.knownUnit(unit);
      if (!SieveColumns.isLength(known)) {
        throw new InputError(`${is}; its unit '${unit}' is unknown, use ${Object.keys(rules.lengths).join(", ")}`);
      }
      return value * lengthOf(known);
    });
    if (!(lower < upper)) throw new InputError(`${is}; give the smaller size first`);
    return { low: lower, high: upper };
  }

  // Returns [table, whether it has classes], with each class replaced by the sieve on which it is retained, finest first.
  function withLowerSieves(name, table) {
    const found = columnOfClasses(name, table);
    if (!found) return [table, false];
    const { position, unit } = found;
    const title = table.header[position];
    const totals = new Set(Summaries.find(table.rows, [position]).map(([i]) => i));
    const [classes, others] = [[], []];
    table.rows.forEach((row, i) => {
      const label = row.cells[position];
      if (totals.has(i) || (PAN.test(label) && !OPEN_END.test(label))) others.push(row);
      else classes.push({ ...boundsOrEnd(`${name}, row ${row.row}`, title, label, unit), row });
    });
    classes.sort((a, b) => a.low - b.low || a.high - b.high || a.row.row - b.row.row);
    checkNeighbours(name, title, classes);
    const put = (cells, size) => cells.map((text, i) => (i === position ? `${general(size, 12)} mm` : text));
    const rows = [...others, ...classes.map(({ low, row }) => ({ ...row, cells: put(row.cells, low) }))];
    const { high, row } = classes.at(-1);
    if (high < Infinity) {
      const last = Math.max(...table.rows.map((entry) => entry.row)) + 1;
      rows.push({ ...row, row: last, cells: put(row.cells.map(() => "0"), high) });
    }
    const header = table.header.map((text, i) => (i === position ? rules.lower_sieve : text));
    return [{ ...table, header, rows }, true];
  }

  // Returns the columns with the amounts of the classes only.
  function retainedOnly(name, columns) {
    const amounts = columns.amounts.filter(({ meaning }) => meaning === RETAINED);
    if (amounts.length) return { ...columns, amounts };
    throw new InputError(
      `${name}: sieve classes need the mass or the percent of each class, such as \`mass [g]\` or \`retained [%]\`; if ` +
        "you have what passes, give the openings of the sieves instead of classes"
    );
  }

  // Returns {position, unit} of the column of classes, or null if the table has openings.
  function columnOfClasses(name, { header, rows }) {
    const found = [];
    for (const [position, title] of header.entries()) {
      const named = CLASS_NAME.exec(title);
      const { meaning, unit } = named ? { meaning: null, unit: named[1] } : SieveColumns.meaningOf(name, title);
      if (rows.some(({ cells }) => isClass(cells[position], unit))) {
        if (named || meaning === OPENING) found.push({ position, unit });
      } else if (meaning === OPENING) return null;
    }
    return found[0] ?? null;
  }

  // Whether a cell is a class; 3/8 is one only with a unit other than inches, of which it is a fraction.
  function isClass(label, unit) {
    const match = CLASS_LABEL.exec(label);
    return match !== null && (match[3] !== "/" || ![null, "in"].includes(SieveColumns.knownUnit(match[5] || unit || "")));
  }

  // Returns the bounds of a class, or of an end, which reaches from 0 or to infinity.
  function boundsOrEnd(where, title, label, unit) {
    const end = OPEN_END.exec(label);
    if (!end) return boundsOf(where, title, label, unit);
    const [, mark, text, ofSize] = end;
    const length = SieveColumns.knownUnit(ofSize || unit || "");
    if (!SieveColumns.isLength(length)) {
      const lengths = Object.keys(rules.lengths).join(", ");
      throw new InputError(`${where}: ${title} is '${label}' without a unit of length; use ${lengths}`);
    }
    const value = Numbers.read(`${where}, ${title} '${label}'`, "size", text) * lengthOf(length);
    return rules.below.includes(mark.toLowerCase()) ? { low: 0, high: value } : { low: value, high: Infinity };
  }

  function checkNeighbours(name, title, classes) {
    classes.slice(1).forEach((coarser, i) => {
      const finer = classes[i];
      if (coarser.low < finer.high * (1 - rules.same_sieve)) {
        throw new InputError(
          `${name}: the classes ${written(finer)} (row ${finer.row.row}) and ${written(coarser)} (row ` +
            `${coarser.row.row}) overlap; correct the column ${title}`
        );
      }
      if (coarser.low > finer.high * (1 + rules.same_sieve)) {
        throw new InputError(
          `${name}: no row has the class ${written({ low: finer.high, high: coarser.low })}, between rows ` +
            `${finer.row.row} and ${coarser.row.row}; add it, with 0 if it is empty`
        );
      }
    });
  }

  function written({ low, high }) {
    if (low === 0) return `below ${general(high)} mm`;
    return high < Infinity ? `${general(low)} to ${general(high)} mm` : `above ${general(low)} mm`;
  }

  return { CLASS_NAME, CLASS_LABEL, boundsOf, withLowerSieves, retainedOnly };
})();
