// Numbers: reading the cells of a table, and writing values as Python's format "g" does.
const Numbers = (() => {
  const NUMBER = /^(?:[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity))$/i;
  // A number at the beginning of a cell, before its unit; one that may have separators of thousands; one with decimals.
  const LEADING = /^[-+\u2212]?[\d.,]+(?:e[-+]?\d+)?/i;
  const IN_GROUPS = /^[-+\u2212]?[1-9]\d{0,2}(?:(?:\.\d{3})+|(?:,\d{3})+)$/;
  const SPLIT = /\d[ \u00a0\u202f'\u2019]\d/; // separators of thousands
  const WHOLE = /^[-+\u2212]?[1-9]\d+$/; // it may be beside a number with separators
  const LARGE = /^[-+\u2212]?[1-9]\d{2,}$/;
  const DECIMAL = /^[-+\u2212]?\d*[.,]\d+(?:e[-+]?\d+)?$/i;
  const MARKS = { ".": "a point", ",": "a comma" };
  const DATE = new RegExp(`^(?:${DATA.reading.date})$`, "iu");

  const SHEET_ERROR = /^#(?:[A-ZÜ\d/_]+[!?]|N\/A|NV)$/; // what a spreadsheet displays instead of the result of a formula

  class InputError extends Error {}

  // Returns the finite number in the text of a cell; `where` and `name` are for the message.
  function read(where, name, text) {
    const plain = text.replaceAll("\u2212", "-");
    if (plain.trimEnd().endsWith("%")) {
      throw new InputError(`${where}: ${name} is '${text}'; give a fraction, 0.65 instead of 65 %`);
    }
    checkSheetError(where, name, text);
    if (DATE.test(plain)) {
      throw new InputError(
        `${where}: ${name} is '${text}'; a spreadsheet took the number for a date: format the column as text, and enter it`
      );
    }
    if (/±|\+-|\+\/-/.test(plain)) {
      throw new InputError(
        `${where}: ${name} is '${text}'; a number is needed; write its error into a column of its own`
      );
    }
    const commas = plain.split(",").length - 1;
    const points = plain.split(".").length - 1;
    if (/\d/.test(plain) && ((commas && points) || commas > 1 || points > 1 || SPLIT.test(plain))) {
      throw new InputError(
        `${where}: ${name} is '${text}'; a number is needed, without separators of thousands; write its unit, if any, ` +
          "in the header"
      );
    }
    if (!NUMBER.test(plain)) {
      const remedy = /\d/.test(plain) ? "write its unit, if any, in the header" : "enter it, or remove the row";
      throw new InputError(`${where}: ${name} is '${text}'; a number is needed; ${remedy}`);
    }
    const value = Number(plain.replace(",", "."));
    if (!Number.isFinite(value)) {
      throw new InputError(
        `${where}: ${name} is ${text}; a finite number is needed; remove the row if it is unknown`
      );
    }
    return value;
  }

  function checkSheetError(where, name, text) {
    if (!SHEET_ERROR.test(text)) return;
    throw new InputError(`${where}: ${name} is '${text}', an error of the spreadsheet; correct its formula`);
  }

  // Refuses separators of thousands, which would be read as a decimal mark: 1.410 where all other decimals have a comma,
  // or where its column has whole numbers of three digits (in grams: of two) or more and no other decimals.
  // columns: [position, name] of the columns with numbers. inGrams: positions of those with masses in grams.
  function checkDecimalMarks(file, columns, rows, inGrams = []) {
    const [decimals, withDecimals, inGroups, whole] = [new Map(), new Set(), [], new Set()];
    for (const { row, cells } of rows) {
      for (const [position, name] of columns) {
        const text = cells[position];
        const number = LEADING.exec(text)?.[0] ?? "";
        const mark = Object.keys(MARKS).find((key) => number.includes(key));
        if (IN_GROUPS.test(number)) inGroups.push({ row, name, text, number, mark });
        else if (DECIMAL.test(number)) {
          withDecimals.add(name);
          if (!decimals.has(mark)) decimals.set(mark, number);
        } else if ((inGrams.includes(position) ? WHOLE : LARGE).test(number)) whole.add(name);
      }
    }
    for (const { row, name, text, number, mark } of inGroups) {
      const is = `${file}, row ${row}: ${name} is '${text}'`;
      if (decimals.size === 1 && !decimals.has(mark)) {
        const [[used, example]] = decimals;
        throw new InputError(
          `${is}, but this table writes decimals with ${MARKS[used]} (${example}); write numbers without separators of ` +
            "thousands"
        );
      }
      if (!withDecimals.has(name) && whole.has(name)) {
        throw new InputError(
          `${is}; if it is ${number.replaceAll(mark, "")}, write it so, without a separator of thousands; if not, write ` +
            `another number of decimals, such as ${number}0`
        );
      }
    }
  }

  // Writes a value with at most this number of digits, without zeros at the end.
  function general(value, digits = 6) {
    if (Number.isNaN(value)) return "nan";
    if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
    if (value === 0) return "0";
    if (isEvenTie(value, digits)) value *= 1 - 2 ** -40;
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    const exponent = Number(power);
    const trim = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
    if (exponent >= -4 && exponent < digits) return trim(value.toFixed(digits - 1 - exponent));
    return `${trim(mantissa)}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
  }

  // Whether a value is exactly between two numbers of so many digits, the smaller of which is even. Python rounds to the
  // even one, and JavaScript away from zero.
  function isEvenTie(value, digits) {
    const all = Math.abs(value).toExponential(100).replace(/e.*|\./g, "");
    return /^50*$/.test(all.slice(digits)) && Number(all[digits - 1]) % 2 === 0;
  }

  return { NUMBER, SHEET_ERROR, InputError, read, checkDecimalMarks, checkSheetError, general };
})();
