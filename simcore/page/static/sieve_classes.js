// Sieve classes such as "8-11.2 mm", as simcore.grains.class_labels and sieve_classes read them. Sizes are in mm here.
const SieveClasses = (() => {
  const { InputError, general } = Numbers;
  const { OPENING, PHI, RETAINED } = SieveColumns;
  const rules = DATA.curve.reading;
  const whole = (pattern) => new RegExp(`^(?:${pattern})$`, "iu");
  const { no_phi: NO_PHI, phi } = DATA.curve.classes;
  const IN_PHI = new RegExp(phi, "iu");
  const isPhi = (unit) => SieveColumns.knownUnit(unit ?? "") === PHI;
  const [CLASS_NAME, CLASS_LABEL, OPEN_END, DATE, LOWER_NAME, UPPER_NAME, LOWER_SIEVE, UPPER_SIEVE, SIZE, NO_SIZE] = [
    "name", "label", "end", "date", "lower", "upper", "lower_sieve", "upper_sieve", "size", "no_size",
  ].map((key) => whole(DATA.curve.classes[key]));
  const PAN = whole(rules.patterns.pan);

  // Returns {low, high}, from 0 or to Infinity at an open end. where: file and row, for messages. unitOfColumn: that in the
  // name of the column, or undefined.
  function boundsOf(where, column, label, unitOfColumn) {
    const is = `${where}: ${column} is '${label}'`;
    // φ in the name of a column is the sign of a diameter if the label has a unit of length.
    const own = CLASS_LABEL.exec(label)?.[5] || OPEN_END.exec(label)?.slice(3).find((text, i) => text && i !== 1);
    const inPhi = isPhi(unitOfColumn) && !SieveColumns.isLength(SieveColumns.knownUnit(own ?? ""));
    if (inPhi || IN_PHI.test(label)) throw new InputError(`${is}; ${NO_PHI}`);
    const inHeader = unitOfColumn ? "" : `, or put the unit in the header, \`${column} [mm]\``;
    const sizeOf = (text, unit) => {
      if (!unit) throw new InputError(`${is} without a unit; write it as '${label} mm'${inHeader}`);
      const known = SieveColumns.knownUnit(unit);
      if (!SieveColumns.isLength(known)) {
        throw new InputError(`${is}; its unit '${unit}' is unknown, use ${Object.keys(rules.lengths).join(", ")}`);
      }
      const factor = known === "mm" ? 1 : rules.lengths[known] * 1e3;
      return Numbers.read(`${where}, ${column} '${label}'`, "size", text) * factor;
    };
    const end = OPEN_END.exec(label);
    if (end) {
      const [mark, text, unit] = end[1] ? end.slice(1, 4) : ["+", end[4], end[5]];
      const size = sizeOf(text, unit || unitOfColumn);
      return DATA.curve.classes.below.includes(mark.toLowerCase()) ? { low: 0, high: size } : { low: size, high: Infinity };
    }
    const match = CLASS_LABEL.exec(label);
    if (!match && DATE.test(label)) {
      throw new InputError(`${is}; a spreadsheet took the class for a date: format the column as text, and enter it`);
    }
    if (!match && PAN.test(label)) {
      throw new InputError(`${is}; write it with the finest sieve, such as '${unitOfColumn ? "< 2" : "< 2 mm"}'`);
    }
    if (!match) {
      const [both, open] = unitOfColumn ? ["8-11.2", "> 63"] : ["8-11.2 mm", "> 63 mm"];
      throw new InputError(
        `${is}; give both sieves, such as '${both}', or an end such as '${open}'${inHeader}; remove rows that are no class`
      );
    }
    const [, first, firstUnit, mark, second, given] = match;
    const unit = given || unitOfColumn;
    if (mark === "/" && SieveColumns.knownUnit(unit ?? "") === "in") {
      throw new InputError(`${is}, which may be a fraction of an inch; write a class as '${first}-${second}'`);
    }
    const [low, high] = [sizeOf(first, firstUnit || unit), sizeOf(second, unit)];
    if (!(low < high)) throw new InputError(`${is}; give the smaller size first`);
    return { low, high };
  }

  function written({ low, high }) {
    if (low === 0) return `below ${general(high)} mm`;
    return high < Infinity ? `${general(low)} to ${general(high)} mm` : `above ${general(low)} mm`;
  }

  // The name and unit of a column; the name is that of a bound if the column has the lower or upper sieves, such as
  // `passing [mm]`.
  function asBound([title, unit]) {
    if (!SieveColumns.isLength(SieveColumns.knownUnit(unit ?? ""))) return [title, unit];
    return [LOWER_SIEVE.test(title) ? "from" : UPPER_SIEVE.test(title) ? "to" : title, unit];
  }

  // Returns the table with a column of the lower and one of the upper sieves, such as `von [mm]` and `bis [mm]`, as one
  // column of classes; other tables as they are, also if a third column has the classes or the openings.
  function withJoinedBounds(name, table) {
    const parts = table.header.map(SieveColumns.splitUnit).map(asBound);
    const used = [LOWER_NAME, UPPER_NAME].flatMap((pattern) => {
      const named = parts.flatMap(([title], i) => (pattern.test(title) ? [i] : []));
      const withUnit = named.filter((i) => parts[i][1]);
      const positions = withUnit.length ? withUnit : named;
      return positions.length === 1 ? positions : [];
    });
    if (used.length < 2 || table.header.some((_, i) => !used.includes(i) && hasSizes(name, table, i))) return table;
    const [lower, upper] = used;
    const [[lowTitle, unit], [highTitle, other]] = [parts[lower], parts[upper]];
    const known = SieveColumns.knownUnit(unit ?? "");
    const columns = `${name}: the columns ${table.header[lower]} and ${table.header[upper]}`;
    if (isPhi(unit) || isPhi(other)) throw new InputError(`${columns} are the bounds of classes; ${NO_PHI}`);
    if (!SieveColumns.isLength(known) || SieveColumns.knownUnit(other ?? "") !== known) {
      throw new InputError(
        `${columns} need the same unit of length; write it in both names, such as \`${lowTitle} [mm]\` and ` +
          `\`${highTitle} [mm]\``
      );
    }
    Numbers.checkDecimalMarks(name, used.map((position) => [position, table.header[position]]), table.rows);
    const put = (texts, text) => texts.map((old, i) => (i === lower ? text : old)).filter((_, i) => i !== upper);
    const rows = table.rows.map((row) => ({ ...row, cells: put(row.cells, joined(row.cells[lower], row.cells[upper])) }));
    return { ...table, header: put(table.header, `${lowTitle} and ${highTitle} [${unit}]`), rows };
  }

  // Whether a column has the openings of the sieves, or classes.
  function hasSizes(name, { header, rows }, position) {
    const title = header[position];
    const [named, unit] = namedClass(title);
    if (named || rows.some(({ cells }) => isClass(cells[position], unit, named))) return true;
    return SieveColumns.meaningOf(name, title).meaning === OPENING;
  }

  // Returns the class of two cells; a text that is no size, such as `pan` or a total, is returned as it is.
  function joined(...texts) {
    const [low, high] = texts.map((text) => (NO_SIZE.test(text) ? "" : text));
    const text = [low, high].find((cell) => cell && !SIZE.test(cell));
    if (text) return text;
    if (low && high) return `${low}-${high}`;
    if (low) return `> ${low}`;
    return high ? `< ${high}` : "";
  }

  // Returns [table, position of the column of classes or null], with each class replaced by the sieve that retains it,
  // finest first. The sieve above all classes has the number `added` of the table as its row.
  function withLowerSieves(name, table) {
    const { position, unit } = columnOfClasses(name, table);
    if (position === null) return [table, null];
    const title = table.header[position];
    const totals = new Set(Summaries.find(table.rows, [position]).map(([i]) => i));
    const [classes, others] = [[], []];
    table.rows.forEach((row, i) => {
      const label = row.cells[position];
      if (totals.has(i) || (PAN.test(label) && !OPEN_END.test(label))) others.push(row);
      else classes.push({ ...boundsOf(`${name}, row ${row.row}`, title, label, unit), row });
    });
    classes.sort((a, b) => a.low - b.low || a.high - b.high || a.row.row - b.row.row);
    checkNeighbours(name, title, classes);
    const put = (cells, size) => cells.map((text, i) => (i === position ? `${general(size, 12)} mm` : text));
    const rows = [...others, ...classes.map(({ low, row }) => ({ ...row, cells: put(row.cells, low) }))];
    const added = Math.max(...table.rows.map((entry) => entry.row)) + 1;
    const { high, row } = classes.at(-1);
    if (high < Infinity) rows.push({ ...row, row: added, cells: put(row.cells.map(() => "0"), high) });
    return [{ ...table, rows, added }, position];
  }

  // Returns the columns with the amounts of the classes only.
  function retainedOnly(name, columns) {
    const amounts = columns.amounts.filter(({ meaning }) => meaning === RETAINED);
    if (amounts.length) return { ...columns, amounts };
    throw new InputError(
      `${name}: sieve classes need the mass or the percent of each class, such as \`mass [g]\` or \`retained [%]\`; if ` +
        "you have sums, give the openings of the sieves instead: what passes belongs to the upper sieve of a class, and " +
        "what is retained in sum to its lower one"
    );
  }

  // Returns {position, unit} of the column of classes; the position is null if the table has openings.
  function columnOfClasses(name, { header, rows }) {
    const [found, namedOnly] = [[], []];
    for (const [position, title] of header.entries()) {
      const [named, unit] = namedClass(title);
      if (rows.some(({ cells }) => isClass(cells[position], unit, named))) found.push({ position, unit });
      else if (named) namedOnly.push({ position, unit });
      else if (SieveColumns.meaningOf(name, title).meaning === OPENING) return { position: null };
    }
    return [...found, ...namedOnly, { position: null }][0];
  }

  // Returns the match of a title with CLASS_NAME or null, and the text of its unit or undefined.
  function namedClass(title) {
    const named = CLASS_NAME.exec(title);
    const unit = named ? named[1] : SieveColumns.unitInName(title);
    return [named, unit === undefined && IN_PHI.test(title) ? PHI : unit];
  }

  // Whether a cell is a class, in phi too, which is refused later. 3/8 inches are a fraction. In a column that is not named for classes, a class has a unit of
  // length: 2021-03 is a date.
  function isClass(label, unit, named) {
    if (isPhi(unit) && CLASS_LABEL.test(label.replace(/(?<!\d)[-+−](?=\d)/g, ""))) return true;
    const match = CLASS_LABEL.exec(label);
    if (!match) return false;
    const length = SieveColumns.knownUnit(match[5] || unit || "");
    return (SieveColumns.isLength(length) && (match[3] !== "/" || length !== "in")) || (named !== null && match[3] !== "/");
  }

  function checkNeighbours(name, title, classes) {
    classes.slice(1).forEach((coarser, i) => {
      const finer = classes[i];
      const [row, next] = [finer.row.row, coarser.row.row];
      if (coarser.low < finer.high * (1 - rules.same_sieve)) {
        throw new InputError(
          `${name}: the classes ${written(finer)} (row ${row}) and ${written(coarser)} (row ${next}) overlap; correct the ` +
            `column ${title}`
        );
      }
      if (coarser.low > finer.high * (1 + rules.nearly)) {
        throw new InputError(
          `${name}: no row has the class ${written({ low: finer.high, high: coarser.low })}, between rows ${row} and ` +
            `${next}; add it, with 0 if it is empty`
        );
      }
      if (coarser.low > finer.high * (1 + rules.same_sieve)) {
        throw new InputError(
          `${name}: the classes of rows ${row} and ${next} end and begin at ${general(finer.high)} and ` +
            `${general(coarser.low)} mm; write the same sieve in both`
        );
      }
    });
  }

  return { CLASS_NAME, CLASS_LABEL, boundsOf, written, withJoinedBounds, withLowerSieves, retainedOnly };
})();
