// Reads a sieve curve from a table, as simcore.grains.sieve_table does. Openings are in mm here.
const SieveTable = (() => {
  const { InputError, general } = Numbers;
  const { PERCENT, FRACTION, RETAINED, PASSING, CUMULATIVE } = SieveColumns;
  const rules = DATA.curve.reading;
  const WHOLE = { [PERCENT]: 100, [FRACTION]: 1 };

  const percent = (share) => `${(100 * share).toFixed(1)}%`;
  const sum = (values) => values.reduce((total, value) => total + value, 0);

  // An error also has the notices, such as a title that was left out.
  function recognise(name, file) {
    try {
      const given = SieveClasses.withJoinedBounds(name, file);
      const [table, classes] = SieveClasses.withLowerSieves(name, given);
      return { given, table, classes, recognised: SieveColumns.recognise(name, table, classes) };
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      throw new InputError([error.message, ...Table.adviceOnNames(file.separator), ...file.notices].join("; "));
    }
  }

  // Returns {openings, passing, notices}: ascending openings [mm] and the share of the mass that passes each. coarsest:
  // size of the coarsest grains [mm] or null.
  function read(name, text, coarsest = null, notes = []) {
    const file = Table.read(name, text, [...notes]);
    if (!file.header.length) throw new InputError(`${name}: the file is empty; ${rules.needed}`);
    const { given, table, classes, recognised } = recognise(name, file);
    const columns = classes === null ? recognised : SieveClasses.retainedOnly(name, recognised);
    const notices = [...table.notices];
    const [rows, labels] = leaveOutTotals(table.rows, columns, notices);
    if (!rows.length) throw new InputError(`${name}: there are no rows below the header; ${rules.needed}`);
    const used = [columns.opening, ...columns.amounts.map(({ position }) => position)];
    const inGrams = columns.amounts.filter(({ unit }) => unit === "g").map(({ position }) => position);
    const kept = new Set(rows.map(({ row }) => row));
    const written = given.rows.filter(({ row }) => kept.has(row)); // classes as they were before withLowerSieves
    Numbers.checkDecimalMarks(name, used.map((position) => [position, given.header[position]]), written, inGrams);
    checkSamples(name, table, used);
    const sieves = SieveOpenings.read(name, table.header, rows, columns);
    let doubts = [];
    const results = columns.amounts.map((column) => {
      const title = table.header[column.position];
      const values = Rows.readEach(rows, ({ row, cells }) =>
        readAmount(`${name}, row ${row}`, title, cells[column.position], row === sieves.pan)
      );
      const passing = passingOf({ name, title, column, sieves, values, coarsest, notices });
      if (column.meaning === RETAINED) {
        const total = sum([...values.values()].map((value) => value || 0));
        notices.push(...noticesOfTotal(title, total, labels, (i) => table.rows[i], column.position));
      }
      if (columns.amounts.length === 1 && isMassRetained(column)) {
        const listed = sieves.rows.filter((row) => row !== table.added).reverse(); // without the sieve above all classes
        const inPan = sieves.pan === null ? null : values.get(sieves.pan) || 0;
        doubts = noticesOfSums(title, column.unit ?? "g", listed.map((row) => values.get(row)), inPan);
        notices.push(...doubts);
      }
      return { title, passing };
    });
    if (sieves.pan === null && columns.amounts.every(isMassRetained)) {
      notices.push(
        `there is no row \`pan\`: nothing is taken to pass ${general(sieves.openings[0])} mm; if finer grains were ` +
          "weighed, add them in a row `pan`"
      );
    }
    const [{ title, passing }, ...others] = results;
    for (const other of others) {
      const difference = Math.max(...other.passing.map((share, i) => Math.abs(share - passing[i])));
      if (difference > rules.agreement) {
        throw new InputError(
          `${name}: the columns ${title} and ${other.title} give shares passing that differ by ` +
            `${(100 * difference).toFixed(1)} % of the mass; correct or remove one`
        );
      }
      notices.push(`the columns ${title} and ${other.title} agree; ${title} is used`);
    }
    checkClasses(name, sieves.openings, passing);
    const ofSize = SieveOpenings.noticesOfSize(table.header[columns.opening], columns.unit, sieves.openings, passing);
    notices.push(...ofSize);
    const unused = table.header.flatMap((t, i) => (used.includes(i) ? [] : [t || `(column ${i + 1}, no name)`]));
    if (unused.length) notices.push(`columns that are not used: ${unused.join(", ")}`);
    const counts = unused.find(SieveColumns.countsGrains);
    if (counts && columns.amounts.every(({ unit }) => [PERCENT, FRACTION].includes(unit))) {
      notices.push(
        `the column ${counts} has counts of grains; ${title} must be shares of the mass, or of counts on a grid ` +
          "(Wolman), not of the number of all grains"
      );
    }
    const all = notices.map((notice) => `${name}: ${notice}`);
    return { openings: sieves.openings, passing, doubts: [...doubts, ...ofSize], notices: all };
  }

  // Refuses a column with the names of several samples. used: positions of the columns that are read.
  function checkSamples(name, { header, rows }, used) {
    header.forEach((title, i) => {
      if (used.includes(i) || !DATA.reading.sample_names.includes(title.toLowerCase())) return;
      const names = [...new Set(rows.map(({ cells }) => cells[i]).filter((text) => text))];
      if (names.length < 2) return;
      throw new InputError(
        `${name}: the column ${title} has several samples (${Rows.joinFirst(names)}); a table has one sieve curve, so ` +
          "that each sample needs its own file"
      );
    });
  }

  // A column without a unit is taken as masses.
  const isMassRetained = ({ meaning, unit }) => meaning === RETAINED && ![PERCENT, FRACTION].includes(unit);

  // Returns a notice if masses on the sieves, from the coarsest to the finest, look like sums over sieves.
  function noticesOfSums(title, unit, masses, inPan) {
    const rows = masses.concat(inPan ?? []);
    const little = rules.small_step * Math.max(...rows);
    const onlyRise = (values) => {
      const steps = values.slice(1).map((value, i) => value - values[i]);
      return values.length >= rules.fewest_sums && steps.every((step) => step >= 0) && steps.filter((step) => step).length >= 2;
    };
    if (onlyRise(masses) || (inPan !== null && onlyRise(rows) && inPan - masses.at(-1) < little)) {
      return [
        `${title} rises from the coarsest sieve to the finest; if these are sums, name the column ` +
          `\`cumulative retained [${unit}]\``,
      ];
    }
    if (onlyRise(rows.map((mass) => -mass)) && rows.at(-1) < little) {
      return [
        `${title} falls from the coarsest sieve to the finest; if these masses pass the sieves, name the column ` +
          `\`passing [${unit}]\``,
      ];
    }
    return [];
  }

  // Returns a notice if the sum of the amounts differs from all totals. labels: [index, label] of rows. A total is often
  // the only large number of a table, so that a separator of thousands is allowed.
  function noticesOfTotal(title, total, labels, rowAt, position) {
    const differing = [];
    for (const [i, label] of labels.filter(([, text]) => Summaries.isTotal(text))) {
      const { row, cells } = rowAt(i);
      const text = cells[position];
      const plain = text.replace(/[% ]+$/, "");
      const readings = [plain, plain.replace(/[.,' \u00a0\u202f\u2019]/g, "")].flatMap((written) => {
        try {
          const value = Numbers.read(`row ${row}`, title, written);
          return value > 0 ? [value] : [];
        } catch {
          return [];
        }
      });
      if (readings.some((value) => Math.abs(total / value - 1) <= rules.loss)) return [];
      if (readings.length) differing.push({ row, label, text });
    }
    return differing.slice(0, 1).map(
      ({ row, label, text }) =>
        `row ${row} (${label}): ${title} is ${text}, but the other rows sum to ${general(total, 10)}; if a sieve or class is ` +
        "missing, add it, or else correct the row that is wrong"
    );
  }

  // Returns the rows without those that summarise others, and the [index, label] of these.
  function leaveOutTotals(rows, columns, notices) {
    const found = Summaries.find(rows, [columns.opening]);
    if (!found.length) return [rows, found];
    const listed = found.map(([i, label]) => `row ${rows[i].row} (${label})`).join(", ");
    const verb = found.length > 1 ? "are no sieves and are" : "is no sieve and is";
    notices.push(`${listed} ${verb} left out`);
    const places = new Set(found.map(([i]) => i));
    return [rows.filter((_, i) => !places.has(i)), found];
  }

  // Returns the amount in a cell; NaN if it is the empty cell of a pan.
  function readAmount(where, title, text, ofPan) {
    if (!text && ofPan) return NaN;
    if (!text) {
      throw new InputError(
        `${where}: ${title} is empty; give the amount of every sieve, 0 if there is nothing on it`
      );
    }
    const value = Numbers.read(where, title, text.replace(/[% ]+$/, ""));
    if (value < 0) throw new InputError(`${where}: ${title} = ${general(value)} is negative; correct it`);
    return value;
  }

  // Returns the shares passing of one column of amounts.
  function passingOf(input) {
    const { name, title, column, sieves, values, coarsest, notices } = input;
    const { rows, pan } = sieves;
    const amounts = rows.map((row) => values.get(row));
    const inPan = pan === null ? NaN : values.get(pan);
    const largest = Math.max(...amounts, Number.isNaN(inPan) ? 0 : inPan);
    if (column.unit === PERCENT && largest > 0 && largest <= 1) {
      throw new InputError(
        `${name}: ${title} has no value above 1, so that its values look like fractions; write percent, such as 85 ` +
          "instead of 0.85, or leave the % out of the name"
      );
    }
    const [first, second] = [...amounts].sort((a, b) => b - a);
    if (column.unit === PERCENT && column.meaning !== RETAINED && amounts.length > 3 && second <= 1 && first > 1) {
      throw new InputError(
        `${name}: ${title} has one value above 1, ${general(first)}, and the others look like fractions; write percent, ` +
          "such as 85 instead of 0.85"
      );
    }
    if (column.meaning === RETAINED) return fromRetained(input, amounts, Number.isNaN(inPan) ? 0 : inPan);
    let whole = WHOLE[column.unit] ?? null;
    if (SieveColumns.isMass(column.unit)) {
      if (column.meaning === CUMULATIVE && Number.isFinite(inPan)) whole = inPan;
      else if (column.meaning === PASSING) {
        whole = amounts.at(-1);
        if (coarsest !== null) {
          throw new InputError(
            `${name}: ${title} is a mass, so that what stays on the coarsest sieve is unknown; give it in percent, ` +
              "or leave the field Coarsest grains empty"
          );
        }
        notices.push(`${title}: all grains are taken to pass the coarsest sieve`);
      }
      if (!whole) {
        throw new InputError(
          `${name}: ${title} is a mass, but its total is unknown; give it in percent, or add the pan`
        );
      }
    }
    if (whole === null) {
      whole = Math.max(...amounts) <= 1 ? 1 : 100;
      notices.push(`the column ${title} is taken as ${whole === 1 ? "a fraction" : "percent"}`);
    }
    const shares = amounts.map((amount) => amount / whole);
    const over = shares.findIndex((share) => share > 1 + rules.rounding);
    if (over >= 0) {
      throw new InputError(
        `${name}, row ${rows[over]}: ${title} = ${general(amounts[over])} is more than the whole; correct it`
      );
    }
    const end = inPan / whole;
    if (column.meaning === CUMULATIVE && Number.isFinite(end) && Math.abs(end - 1) > rules.rounding) {
      throw new InputError(
        `${name}, row ${pan}: ${title} of the pan is ${general(inPan)}; it must end at the whole; correct it`
      );
    }
    if (column.meaning === PASSING && Number.isFinite(end) && end > rules.rounding) {
      throw new InputError(
        `${name}, row ${pan}: ${title} of the pan is ${general(inPan)}, but nothing passes it; give 0`
      );
    }
    checkDirection(name, title, rows, amounts, column.meaning);
    let passing = column.meaning === PASSING ? shares : shares.map((share) => 1 - share);
    const last = passing.at(-1);
    if (Math.abs(last - 1) > 0 && Math.abs(last - 1) <= rules.rounding && coarsest === null) {
      const part = general(100 * last, 4);
      notices.push(`${title}: ${part} % pass the coarsest sieve instead of 100 %; the shares are divided by it`);
      passing = passing.map((share) => share / last);
    } else if (last < 1 && coarsest === null) {
      throw new InputError(
        `${name}, row ${rows.at(-1)}: only ${general(100 * last, 4)} % pass the coarsest sieve, not 100 %; add the ` +
          "sieve that all grains pass, or give their largest size in the field Coarsest grains"
      );
    }
    return passing.map((share) => Math.min(Math.max(share, 0), 1));
  }

  function fromRetained({ name, title, column, sieves, notices }, retained, inPan) {
    const total = sum(retained) + inPan;
    if (!(total > 0)) {
      throw new InputError(
        `${name}: all amounts in ${title} are 0; give those of the sieves that retained grains`
      );
    }
    const whole = WHOLE[column.unit];
    if (whole !== undefined && Math.abs(total / whole - 1) > rules.rounding) {
      throw new InputError(
        `${name}: ${title} sums to ${general(total, 4)}, not to ${general(whole)}; ` +
          (total < whole ? "add what is missing, such as a row `pan`, or " : "") +
          "correct the values; cumulative values need a name such as `passing [%]` or `cumulative retained [%]`"
      );
    }
    if (whole !== undefined && Math.abs(total / whole - 1) > 1e-9) {
      const pan =
        total < whole && sieves.pan === null
          ? `; there is no row \`pan\`: if the missing part passed ${general(sieves.openings[0])} mm, give it in a row ` +
            "`pan`"
          : "";
      notices.push(`${title} sums to ${general(total)} instead of ${general(whole)}; it is divided by its sum${pan}`);
    }
    if (column.unit === null) {
      notices.push(`the column ${title} has no unit; its values are taken relative to their sum, ${general(total)}`);
    }
    let below = 0;
    const passing = retained.map((amount) => {
      const share = (inPan + below) / total;
      below += amount;
      return share;
    });
    // Without the round-off of the sum, which would be a class of its own.
    for (let i = retained.length - 1; i >= 0 && retained[i] === 0; i -= 1) passing[i] = 1;
    return passing;
  }

  // Amounts, from fine to coarse, rise (passing) or fall (cumulative retained).
  function checkDirection(name, title, rows, amounts, meaning) {
    const sign = meaning === PASSING ? 1 : -1;
    const steps = amounts.slice(1).map((amount, i) => sign * (amount - amounts[i]));
    if (steps.every((step) => step >= 0)) return;
    if (steps.every((step) => step <= 0)) {
      const other = meaning === PASSING ? CUMULATIVE : PASSING;
      throw new InputError(
        `${name}: ${title} ${meaning === PASSING ? "falls" : "rises"} from fine to coarse sieves, the wrong way; is it ` +
          `\`${other}\`?`
      );
    }
    const wrong = steps.findIndex((step) => step < 0);
    throw new InputError(
      `${name}, row ${rows[wrong + 1]}: ${title} = ${general(amounts[wrong + 1])} beside ${general(amounts[wrong])} on ` +
        `the next finer sieve (row ${rows[wrong]}); what is ${meaning} cannot ` +
        `${meaning === PASSING ? "fall" : "rise"} from fine to coarse; correct it`
    );
  }

  // At least two classes have mass, or all would follow from the interpolation.
  function checkClasses(name, openings, passing) {
    const shares = [...passing, 1].map((share, i) => share - (i ? passing[i - 1] : 0));
    if (shares.filter((share) => share > 0).length >= 2) return;
    const sieves = openings.map((size) => `${general(size)} mm`);
    const used = shares.indexOf(Math.max(...shares));
    if (used === 0 || used === sieves.length) {
      const place = used === 0 ? `passes ${sieves[0]}` : `stays on ${sieves.at(-1)}`;
      throw new InputError(
        `${name}: all of the mass ${place}; at least two size classes with mass are needed, so add sieves there`
      );
    }
    const [low, high] = [sieves[used - 1], sieves[used]];
    throw new InputError(
      `${name}: all of the mass is between ${low} and ${high}; at least two size classes with mass are needed. The ` +
        "porosity of a single class is that of the sieve curve “any single sieve class”. To " +
        `pack it, write \`sizes: {bounds: [${low}, ${high}], mass_fractions: [1]}\` in a specification`
    );
  }

  // Returns {name, bounds [mm], mass_fractions, notices} of the classes with mass. finest, coarsest [mm]: sizes of the
  // grains that pass the finest, or stay on the coarsest sieve, or null.
  function curve(name, table, finest = null, coarsest = null) {
    const closed = close(name, table, finest, coarsest);
    const { openings, passing, notices: assumed } = closeSmallEnds(name, closed);
    const notices = [...endsWithoutEffect(name, table, finest, coarsest), ...assumed];
    const [below, above, faults] = [passing[0], 1 - passing.at(-1), []];
    if (below > 0) {
      faults.push(
        `${percent(below)} of the mass pass the finest sieve, ${general(openings[0])} mm; give the size of the finest of ` +
          "these grains in the field Finest grains"
      );
    }
    if (above > 0) {
      faults.push(
        `${percent(above)} of the mass stay on the coarsest sieve, ${general(openings.at(-1))} mm; give the size of the ` +
          "coarsest of these grains in the field Coarsest grains"
      );
    }
    if (faults.length) {
      const doubts = table.doubts.map((doubt) => `before that, check: ${doubt}`);
      throw new InputError(`${name}: ${[...faults, ...doubts].join("; ")}`);
    }
    const shares = passing.slice(1).map((share, i) => share - passing[i]);
    const used = shares.flatMap((share, i) => (share > 0 ? [i] : []));
    const [first, last] = [used[0], used.at(-1) + 1];
    const kept = shares.slice(first, last);
    const total = sum(kept);
    return {
      name: name.replace(/^.*[/\\]/, "").replace(/(?<=.)\.[^.]+$/, ""),
      bounds: openings.slice(first, last + 1),
      mass_fractions: kept.map((share) => share / total),
      notices,
    };
  }

  // Returns notices on sizes of ends that have no grains.
  function endsWithoutEffect(name, { openings, passing }, finest, coarsest) {
    const notices = [];
    const add = (end, why, size) => notices.push(`${name}: the size of the ${end} grains has no effect, because ${why} ${general(size)} mm`);
    if (finest !== null && !(passing[0] > 0)) add("finest", "nothing passes", openings[0]);
    if (coarsest !== null && !(1 - passing.at(-1) > 0)) add("coarsest", "all grains pass", openings.at(-1));
    return notices;
  }

  function close(name, { openings, passing }, finest, coarsest) {
    if (finest !== null && passing[0] > 0) {
      if (!(finest > 0 && finest < openings[0])) {
        throw new InputError(
          `${name}: the size of the finest grains, ${general(finest)} mm, is not below the finest sieve, ` +
            `${general(openings[0])} mm; give a smaller one`
        );
      }
      [openings, passing] = [[finest, ...openings], [0, ...passing]];
    }
    if (coarsest !== null && passing.at(-1) < 1) {
      if (!(coarsest > openings.at(-1))) {
        throw new InputError(
          `${name}: the size of the coarsest grains, ${general(coarsest)} mm, is not above the coarsest sieve, ` +
            `${general(openings.at(-1))} mm; give a larger one`
        );
      }
      [openings, passing] = [[...openings, coarsest], [...passing, 1]];
    }
    return { openings, passing };
  }

  // An open class with little mass is as wide, in phi, as its neighbour.
  function closeSmallEnds(name, { openings, passing }) {
    const [below, above, notices] = [passing[0], 1 - passing.at(-1), []];
    const assume = (text) => notices.push(`${name}: it is assumed that ${text}`);
    if (below > 0 && below <= rules.small_end) {
      [openings, passing] = [[openings[0] ** 2 / openings[1], ...openings], [0, ...passing]];
      assume(`the ${percent(below)} in the pan are coarser than ${general(openings[0], 3)} mm`);
    }
    if (above > 0 && above <= rules.small_end) {
      [openings, passing] = [[...openings, openings.at(-1) ** 2 / openings.at(-2)], [...passing, 1]];
      assume(`the ${percent(above)} on the coarsest sieve are finer than ${general(openings.at(-1), 3)} mm`);
    }
    return { openings, passing, notices };
  }

  return { read, curve };
})();
