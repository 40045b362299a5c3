// Samples of measured grains from a table, as simcore.grains.measured_forms reads them.
const Grains = (() => {
  const { InputError, NUMBER, general } = Numbers;
  const { AXES, RATIOS, MEANS, TWO_AXES } = Columns;
  const { longest, slip, small_deviation: smallDeviation, max_grains: maxGrains, alike, needed } = DATA.reading;
  const AMBIGUOUS = /^[1-9]\d{0,2}[.,]\d{3}$/;
  const [PERCENT, WHOLE] = [/%|percent/i, /^[1-9]\d{0,11}$/];

  const { CLASS_NAME, CLASS_LABEL } = SieveClasses;
  const { joinFirst } = Rows;

  // Returns {samples, notices, kind, columns}. A sample has a name, its first row, its number of grains (0: only statistics), mu_FL,
  // sigma_FL, ..., sigma_EQ, and the forms [FL, EL] of its rows; with two axes only, it has no FL and no EQ.
  // forBed: whether a bed with a sieve curve is predicted, which needs three axes.
  function read(name, text, sample = "", notices = [], forBed = false) {
    const table = Table.read(name, text, notices);
    if (!table.header.length) throw new InputError(`${name}: the file is empty; ${needed}`);
    const columns = recognise(name, table, sample, forBed);
    const [rows, summaries] = leaveOutSummaries(name, table, columns);
    if (!rows.length) throw new InputError(`${name}: there are no rows below the header; ${needed}`);
    const readTheirs = columns.kind === MEANS ? readNumbers : readCounts;
    const [counts, countNotices] = readTheirs(name, table.header, rows, columns);
    Numbers.checkDecimalMarks(name, columns.forms.map((position, i) => [position, columns.kind[i]]), rows);
    const groups = new Map();
    const read = Rows.readEach(rows, ({ row, cells, fields }) => {
      const where = `${name}, row ${row}`;
      const values = readForms(where, table, cells, columns, fields);
      formOf(where, values, columns.kind);
      return [nameOf(where, table.header, cells, columns, row, name), { where, values, row }];
    });
    for (const [group, form] of read.values()) {
      if (!groups.has(group)) groups.set(group, []);
      groups.get(group).push(form);
    }
    const samples = [...groups].map(([group, entries]) => {
      const isMean = columns.kind === MEANS;
      const sample = isMean ? fromMeans(group, entries, counts, columns.noun) : fromGrains(name, group, entries, columns, counts);
      return { ...sample, row: entries[0].row };
    });
    const unused = describeUnused(table.header, rows, columns);
    const rare = columns.kind === MEANS
      ? describeSmallDeviations(samples, columns.noun)
      : describeRareRows(groups, columns, counts);
    const all = [...table.notices, ...summaries, ...countNotices, ...unused, ...rare].map((notice) => `${name}: ${notice}`);
    return { samples, notices: all, kind: columns.kind, header: table.header };
  }

  // An error also has the notices, such as a title that was left out.
  function recognise(name, { header, notices }, sample, forBed) {
    try {
      const columns = Columns.recognise(name, header, sample);
      if (forBed) checkForBed(name, header, columns);
      return { ...columns, noun: CLASS_NAME.test(header[columns.sample]) ? "class" : "sample" };
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      throw new InputError([error.message, ...notices].join("; "));
    }
  }

  function checkForBed(name, header, columns) {
    if (columns.kind === TWO_AXES) {
      throw new InputError(`${name}: the column S is missing beside ${header.join(", ")}; ${needed}`);
    }
  }

  function leaveOutSummaries(name, { header, rows }, columns) {
    const isLabel = (position) => !columns.forms.includes(position) && position !== columns.counts;
    const found = Summaries.find(rows, [...header.keys()].filter(isLabel));
    if (!found.length) return [rows, []];
    const listed = found.map(([i, label]) => `row ${rows[i].row} (${label})`).join(", ");
    if (found.length === rows.length) {
      throw new InputError(`${name}: all rows summarise others (${listed}); give the grains themselves, one row each`);
    }
    const places = new Set(found.map(([i]) => i));
    const verb = found.length > 1 ? "summarise others and are" : "summarises others and is";
    return [rows.filter((_, i) => !places.has(i)), [`${listed} ${verb} left out`]];
  }

  function readForms(where, { header, separator }, cells, columns, fields) {
    if (Math.max(...columns.forms) >= fields) {
      throw new InputError(
        `${where}: the row has ${fields} fields, but the header has ${header.length}; ${Table.adviceOnFields(separator)}`
      );
    }
    const empty = columns.forms.findIndex((position) => !cells[position]);
    if (empty >= 0) throw new InputError(`${where}: ${columns.kind[empty]} is empty; measure it, or remove the row`);
    return columns.forms.map((position, i) => Numbers.read(where, columns.kind[i], cells[position]));
  }

  function nameOf(where, header, cells, columns, row, name) {
    if (columns.sample < 0) return columns.kind === MEANS ? `row ${row}` : name.replace(/(?<=.)\.[^.]+$/, "");
    if (!cells[columns.sample]) {
      const title = header[columns.sample];
      const remedy = CLASS_NAME.test(title) ? "write it in every row" : "name the sample in every row";
      throw new InputError(`${where}: ${title} is empty; ${remedy} (merged cells of a workbook count as empty)`);
    }
    return cells[columns.sample];
  }

  // Returns [{weights, whole} or null, notices]; weights by the number of the row.
  function readCounts(name, header, rows, columns) {
    if (columns.counts < 0) return [null, []];
    const title = header[columns.counts];
    const marksOf = (text) => [".", ","].filter((mark) => text.includes(mark));
    const used = rows.flatMap(({ cells }) => [...columns.forms, columns.counts].map((position) => cells[position]));
    const marks = new Set(used.filter((text) => !AMBIGUOUS.test(text)).flatMap(marksOf));
    const weights = new Map();
    for (const { row, cells } of rows) {
      const [where, text] = [`${name}, row ${row}`, cells[columns.counts]];
      const own = marksOf(text);
      if (AMBIGUOUS.test(text) && !(marks.size === own.length && own.every((mark) => marks.has(mark)))) {
        throw new InputError(`${where}: ${title} is ${text}; write it without a separator of thousands`);
      }
      const value = Numbers.read(where, title, text);
      if (!(value >= 0 && value <= maxGrains)) {
        throw new InputError(`${where}: ${title} = ${general(value)}; a number of grains must be between 0 and 1e12`);
      }
      weights.set(row, value);
    }
    const values = [...weights.values()];
    if (numbersRows(title, values)) return [null, [describeRunning(title)]];
    const counted = values.every(Number.isInteger) && !PERCENT.test(title);
    if (counted) {
      refuseRising(name, title, values, "grains");
      const total = values.reduce((sum, value) => sum + value, 0).toFixed(0);
      return [{ weights, whole: true }, [`the column ${title} is the number of grains of each row, ${total} in all`]];
    }
    const notice = `the column ${title} is the weight of each row; the number of grains is unknown`;
    return [{ weights, whole: false }, [notice]];
  }

  // Returns the numbers of grains of samples of means in the same way; null if they are unknown.
  function readNumbers(name, header, rows, columns) {
    if (columns.counts < 0) return [null, []];
    const title = header[columns.counts];
    if (PERCENT.test(title)) return [null, [`the column ${title} is not used, because it is in percent`]];
    const texts = rows.map(({ row, cells }) => ({ row, text: cells[columns.counts] }));
    const other = texts.find(({ text }) => !WHOLE.test(text));
    if (other && AMBIGUOUS.test(other.text) && !Columns.mayNumberRows(title)) {
      throw new InputError(`${name}, row ${other.row}: ${title} is ${other.text}; write it without a separator of thousands`);
    }
    if (other) {
      const given = other.text ? `${other.text} in row ${other.row} is no` : `row ${other.row} has no`;
      return [null, [`the column ${title} is not used, because ${given} number of grains`]];
    }
    const weights = new Map(texts.map(({ row, text }) => [row, Number(text)]));
    if (numbersRows(title, [...weights.values()])) return [null, [describeRunning(title)]];
    const noun = columns.noun;
    refuseRising(name, title, [...weights.values()], noun.endsWith("s") ? `${noun}es` : `${noun}s`);
    const notice = `the column ${title} is the number of grains of each ${noun}; FL and EL are assumed to be independent`;
    return [{ weights, whole: true }, [notice]];
  }

  // Refuses whole numbers that rise from row to row in a column that may number them; rows: what they are.
  function refuseRising(name, title, values, rows) {
    const rise = values.length >= DATA.reading.fewest_ids && values.every((v, i) => !i || v > values[i - 1]);
    if (!rise || !Columns.mayNumberRows(title)) return;
    throw new InputError(
      `${name}: the numbers in the column ${title} rise from row to row; rename the column to \`id\` if they number ` +
        `the ${rows}, or to \`count\` if they are numbers of grains`
    );
  }

  // A column that can only be a number of grains needs many rows and a 1 to be taken for numbers of rows.
  function numbersRows(title, values) {
    const isMany = values.length >= DATA.reading.fewest_ids && values.includes(1) && !values.includes(0);
    return (Columns.mayNumberRows(title) || isMany) && areNumbers(values);
  }

  // Whether values rise by 1 from row to row; or are 1 to N in any order, or 1, 2, 3, ... anew for each sample, if there
  // are so many that numbers of grains would hardly be so by chance.
  function areNumbers(values) {
    const rises = values.slice(1).map((value, i) => value - values[i] === 1);
    if (values.length > 1 && rises.every(Boolean)) return true;
    if (values.length < DATA.reading.fewest_ids) return false;
    const starts = values.filter((value, i) => i === 0 || !rises[i - 1]);
    const anew = starts.every((value) => value === 1) && starts.length * DATA.reading.rows_by_sample <= values.length;
    return anew || [...values].sort((a, b) => a - b).every((value, i) => value === i + 1);
  }

  const describeRunning = (title) => `the column ${title} numbers the rows, so it is not used as a number of grains`;

  function describeUnused(header, rows, columns) {
    const used = new Set([...columns.forms, columns.counts, columns.sample]);
    const unused = new Map(header.flatMap((t, i) => (used.has(i) ? [] : [[i, t || `(column ${i + 1}, no name)`]])));
    const notices = [];
    for (const [position, title] of columns.sample < 0 ? [...unused] : []) {
      const values = [...new Set(rows.map(({ cells }) => cells[position]))].filter((text) => text);
      if (!header[position] || CLASS_NAME.test(title) || !lookLikeClasses(values)) continue;
      unused.delete(position);
      notices.push(
        `the column ${title} is not used; its values look like sieve classes (${joinFirst(values)}); to give forms by ` +
          "class beside a sieve curve, rename the column to `class`"
      );
    }
    if (columns.sample < 0 && columns.kind !== MEANS) {
      for (const [position, title] of [...unused]) {
        const values = [...new Set(rows.map(({ cells }) => cells[position]))].filter((text) => text);
        const names = values.length > 1 && values.length < rows.length && !values.every((text) => NUMBER.test(text));
        if (!names || !header[position]) continue;
        unused.delete(position);
        notices.push(
          `the column ${title} has repeated values (${joinFirst(values)}) and is not used, so all grains are one sample; if its ` +
            "values are samples, choose it below the table"
        );
      }
    }
    if (unused.size) notices.push(`columns that are not used: ${[...unused.values()].join(", ")}`);
    return notices;
  }

  // Returns a notice on grains so thin or long that a decimal mark may have slipped in one of their axes.
  function describeSlips(groups, kind) {
    const entries = [...groups.values()].flat().sort((a, b) => a.row - b.row);
    const rows = entries.filter(({ where, values }) => {
      return formOf(where, values, kind).some((ratio) => ratio !== null && ratio <= slip);
    });
    if (!rows.length) return [];
    const ratios = kind === TWO_AXES ? "I/L" : "S/I or I/L";
    return [
      `row${rows.length > 1 ? "s" : ""} ${joinFirst(rows.map(({ row }) => `${row}`))}: ${ratios} is ${general(slip)} or ` +
        "less, which is rare for gravel; check the decimal marks",
    ];
  }

  function describeRareRows(groups, { kind, noun }, counts) {
    const slips = describeSlips(groups, kind);
    if (kind === TWO_AXES) return slips;
    return [...slips, ...(counts ? [] : describeMeanRows(groups, noun)), ...describeSingleRows(groups, noun)];
  }

  // Returns a notice on rows with the means of the rows above them, without a label.
  function describeMeanRows(groups, noun) {
    const { last, fewest_above: fewestAbove, rounded, spread } = DATA.reading.mean_rows;
    const isMean = (above, value) => {
      const mean = sum(above) / above.length;
      const deviation = Math.sqrt(sum(above.map((other) => (other - mean) ** 2)) / above.length);
      return Math.abs(value - mean) <= rounded * mean && deviation > spread * mean;
    };
    const rows = [...groups.values()].flatMap((entries) =>
      entries.filter(({ values }, k) => {
        if (k < Math.max(fewestAbove, entries.length - last)) return false;
        return values.every((value, i) => isMean(entries.slice(0, k).map((entry) => entry.values[i]), value));
      })
    );
    if (!rows.length) return [];
    const [plural, have] = rows.length > 1 ? ["s", "have"] : ["", "has"];
    return [
      `row${plural} ${joinFirst(rows.map(({ row }) => `${row}`))} ${have} the means of the rows above of the same ${noun}; ` +
        "if this is no grain, remove it, and other statistics below it",
    ];
  }

  // Returns a notice on samples of one row, which may be a mean over grains.
  function describeSingleRows(groups, noun) {
    const names = [...groups].filter(([, entries]) => entries.length === 1).map(([name]) => name);
    if (!names.length) return [];
    const have = names.length > 1 ? "have one row each" : "has one row";
    return [
      `the ${plural(noun, names)} ${joinFirst(names)} ${have}, so that all grains have one form; if the row is a mean over grains, ` +
        "the porosity is too low: give a row per grain, or mean_FL, std_FL, mean_EL, std_EL",
    ];
  }

  const plural = (noun, names) => noun + (names.length === 1 ? "" : noun === "class" ? "es" : "s");

  // Returns a notice on samples whose deviation of FL or EL is small.
  function describeSmallDeviations(samples, noun) {
    const small = (deviation) => deviation > 0 && deviation < smallDeviation;
    const names = samples.filter(({ sigma_FL, sigma_EL }) => small(sigma_FL) || small(sigma_EL)).map(({ name }) => name);
    if (!names.length) return [];
    return [
      `the ${plural(noun, names)} ${joinFirst(names)}: std_FL or std_EL is below ${general(smallDeviation)}, ` +
        "which is rare for gravel; give the standard deviation over the grains, not the standard error of their mean or " +
        "the variance",
    ];
  }

  // Whether there are texts, and each of them is a range of sizes; 3/2021, without a unit, is a date.
  function lookLikeClasses(texts) {
    const number = (text) => Number(text.replaceAll(",", "."));
    return texts.length > 0 && texts.every((text) => {
      const match = CLASS_LABEL.exec(text);
      return match !== null && (match[3] !== "/" || match[5]) && number(match[1]) < number(match[4]);
    });
  }

  // Returns [FL, EL] of a row, of means their means; FL is null with two axes only.
  function formOf(where, values, kind) {
    if (kind === AXES) return ofAxes(where, values);
    if (kind === TWO_AXES) return [null, ofTwoAxes(where, values)];
    if (kind === MEANS) return ofMeans(where, values);
    RATIOS.forEach((title, i) => {
      if (!(values[i] > 0 && values[i] <= 1)) {
        throw new InputError(
          `${where}: ${title} = ${general(values[i])} is not in (0, 1]; FL is S/I and EL is I/L; do not give their ` +
            "inverses or percent"
        );
      }
    });
    if (values[0] * values[1] * longest < 1) {
      throw new InputError(
        `${where}: FL = ${general(values[0])}, EL = ${general(values[1])} give L/S above ${general(longest)}, more ` +
          "than for any gravel; correct or remove the row"
      );
    }
    return values;
  }

  function ofAxes(where, [L, I, S]) {
    const slack = 1 - 1e-12;
    const listed = `L = ${general(L)}, I = ${general(I)}, S = ${general(S)}`;
    if (S <= 0) throw new InputError(`${where}: S = ${general(S)} is not positive; L >= I >= S > 0 is needed`);
    if (I < S * slack || L < I * slack) {
      throw new InputError(`${where}: ${listed}; L >= I >= S is needed: sort the axes, and give all in one unit`);
    }
    if (L > longest * S) {
      throw new InputError(
        `${where}: L = ${general(L)} is ${general(L / S, 4)} times S = ${general(S)}, more than for any gravel; give ` +
          "all axes in one unit"
      );
    }
    return [Math.min(S / I, 1), Math.min(I / L, 1)];
  }

  function ofTwoAxes(where, [L, I]) {
    if (I <= 0) throw new InputError(`${where}: I = ${general(I)} is not positive; L >= I > 0 is needed`);
    if (L < I * (1 - 1e-12)) {
      throw new InputError(
        `${where}: L = ${general(L)}, I = ${general(I)}; L >= I is needed: sort the axes, and give both in one unit`
      );
    }
    if (L > longest * I) {
      throw new InputError(
        `${where}: L = ${general(L)} is ${general(L / I, 4)} times I = ${general(I)}, more than for any gravel; ` +
          "correct them"
      );
    }
    return Math.min(I / L, 1);
  }

  function ofMeans(where, [mu_FL, sigma_FL, mu_EL, sigma_EL]) {
    for (const [key, mu, sigma] of [["FL", mu_FL, sigma_FL], ["EL", mu_EL, sigma_EL]]) {
      if (!(mu > 0 && mu <= 1)) {
        throw new InputError(
          `${where}: mean_${key} = ${general(mu)} is not in (0, 1]; FL is S/I and EL is I/L, not percent`
        );
      }
      const widest = Math.sqrt(mu * (1 - mu));
      if (!(sigma >= 0 && sigma <= widest)) {
        throw new InputError(
          `${where}: std_${key} = ${general(sigma)}; with a mean of ${general(mu)} it is between 0 and ` +
            `${general(widest, 3)}; give the standard deviation, not the variance or a percentage`
        );
      }
    }
    return [mu_FL, mu_EL];
  }

  function fromGrains(name, group, entries, { kind, noun }, counts) {
    const forms = entries.map(({ where, values }) => formOf(where, values, kind));
    const weights = counts ? entries.map(({ row }) => counts.weights.get(row)) : forms.map(() => 1);
    const total = sum(weights);
    if (counts && !(total > 0)) {
      throw new InputError(`${name}: the numbers of grains of ${noun} ${group} are all 0; correct or remove its rows`);
    }
    const sample = { name: group, grains: counts ? (counts.whole ? total : Number(weights.filter((w) => w > 0).length === 1)) : forms.length, forms };
    const features = { FL: ([FL]) => FL, EL: ([, EL]) => EL, EQ: ([FL, EL]) => FL * EL };
    for (const key of kind === TWO_AXES ? ["EL"] : ["FL", "EL", "EQ"]) {
      const values = forms.map(features[key]);
      const mean = sum(values.map((value, i) => weights[i] * value)) / total;
      const std = Math.sqrt(sum(values.map((value, i) => weights[i] * (value - mean) ** 2)) / total);
      sample[`mu_${key}`] = mean;
      sample[`sigma_${key}`] = std > alike * mean ? std : 0;
    }
    const counted = kind !== TWO_AXES && sample.grains >= DATA.few_grains.fewest && (!counts || counts.whole) && !isOneForm(sample);
    return counted ? { ...sample, covariance: fewGrainsCovariance(forms, weights) } : sample;
  }

  // Returns the covariance of the errors of mu_EQ, sigma_EQ, mu_EL, sigma_EL as simcore.grains.statistics does.
  function fewGrainsCovariance(forms, counts) {
    const number = sum(counts);
    const changes = [([FL, EL]) => FL * EL, ([, EL]) => EL].flatMap((feature) => {
      const values = forms.map(feature);
      const mean = sum(values.map((value, i) => counts[i] * value)) / number;
      const deviations = values.map((value) => value - mean);
      const sigma = Math.sqrt(sum(deviations.map((d, i) => counts[i] * d ** 2)) / number);
      return [deviations, deviations.map((d) => (sigma > 0 ? (d ** 2 - sigma ** 2) / (2 * sigma) : 0))];
    });
    const covariance = (a, b) => sum(counts.map((count, i) => count * a[i] * b[i])) / (number * (number - 1));
    return changes.map((a) => changes.map((b) => covariance(a, b)));
  }

  function fromMeans(group, entries, counts, noun) {
    if (entries.length > 1) {
      throw new InputError(
        `${entries[1].where}: ${noun} ${group} occurs twice, but each row of means and deviations is one ${noun}; ` +
          "rename or remove one"
      );
    }
    const [{ values, row, where }] = entries;
    const [mu_FL, sigma_FL, mu_EL, sigma_EL] = values;
    const grains = counts ? counts.weights.get(row) : 0;
    if (grains === 1 && (sigma_FL || sigma_EL)) {
      throw new InputError(
        `${where}: a single grain has no standard deviation, but ${noun} ${group} has one; correct the number of grains or ` +
          "the deviations; if that column numbers the rows, rename it to `id`"
      );
    }
    const sample = { name: group, grains, forms: [], ...withEquancy(mu_FL, sigma_FL, mu_EL, sigma_EL) };
    return grains >= DATA.few_grains.fewest && !isOneForm(sample) ? { ...sample, covariance: meansCovariance(sample) } : sample;
  }

  // Returns the covariance of fewGrainsCovariance of grains of which only means and deviations are known, likewise.
  function meansCovariance({ mu_FL, sigma_FL, mu_EL, sigma_EL, sigma_EQ, grains }) {
    const variances = [sigma_FL ** 2, sigma_FL ** 2 / 2, sigma_EL ** 2, sigma_EL ** 2 / 2].map((v) => v / (grains - 1));
    const [squaresFL, squaresEL] = [mu_FL ** 2 + sigma_FL ** 2, mu_EL ** 2 + sigma_EL ** 2];
    const ofDeviation = [mu_FL * sigma_EL ** 2, sigma_FL * squaresEL, mu_EL * sigma_FL ** 2, sigma_EL * squaresFL];
    const derivatives = [[mu_EL, 0, mu_FL, 0], ofDeviation.map((v) => (sigma_EQ > 0 ? v / sigma_EQ : 0)), [0, 0, 1, 0], [0, 0, 0, 1]];
    return derivatives.map((a) => derivatives.map((b) => sum(variances.map((v, i) => a[i] * v * b[i]))));
  }

  // Returns the statistics with those of EQ = FL EL; FL and EL are assumed to be independent.
  function withEquancy(mu_FL, sigma_FL, mu_EL, sigma_EL) {
    const mu_EQ = mu_EL * mu_FL;
    const variance = (mu_EL ** 2 + sigma_EL ** 2) * (mu_FL ** 2 + sigma_FL ** 2) - mu_EQ ** 2;
    // If nothing varies, the difference of squares is rounding.
    return { mu_FL, sigma_FL, mu_EL, sigma_EL, mu_EQ, sigma_EQ: sigma_FL || sigma_EL ? Math.sqrt(variance) : 0 };
  }

  const isOneForm = (sample) =>
    sample.sigma_FL <= alike * sample.mu_FL && sample.sigma_EL <= alike * sample.mu_EL;

  const sum = (values) => values.reduce((total, value) => total + value, 0);

  return { read, isOneForm, meansCovariance, withEquancy };
})();
