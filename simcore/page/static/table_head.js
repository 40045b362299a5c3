// Finds the names of the columns below a title, and joins a row of units with them, as simcore.grains.table_head does.
const TableHead = (() => {
  const { most_numbers: mostNumbers, patterns } = DATA.reading.head;
  const whole = (pattern) => new RegExp(`^(?:${pattern})$`, "iu");
  const [UNIT, WITHOUT_UNIT, NUMBER] = [patterns.unit, patterns.without_unit, patterns.number].map(whole);

  // Returns the number of cells up to the last one with text.
  const width = (texts) => texts.reduce((last, text, i) => (text ? i + 1 : last), 0);

  // Returns the text of a row that is a comment, such as "# end", without numbers in its other cells, or "".
  function commentOf(texts) {
    const text = texts.filter((cell) => cell).join(" ");
    const isValue = Numbers.SHEET_ERROR.test(texts[0]) || texts.slice(1).some((cell) => /^[-+]?[.,]?\d/.test(cell));
    return texts[0] && /^#\s*[^\d\s]/.test(text) && !isValue ? text : "";
  }

  // Returns how many of the first rows are comments; one above a row with numbers has the names of the columns.
  function commentsAbove(rows) {
    const isComment = (texts, i) => commentOf(texts) && i + 1 < rows.length && !rows[i + 1].some((text) => NUMBER.test(text));
    const other = rows.findIndex((texts, i) => !isComment(texts, i));
    return Math.max(other, 0);
  }

  // Returns how many rows are a title above the names of the columns; rows: texts of each row, without empty rows.
  function rowsAbove(rows) {
    let above = 0;
    for (const [i, texts] of rows.entries()) {
      const names = texts.filter((text) => text);
      const numbers = names.filter((text) => NUMBER.test(text)).length;
      if (numbers > mostNumbers) break;
      if (width(texts) > width(rows[above]) && !numbers && names.length > 1 && !joinUnits(names, names)) above = i;
    }
    return above;
  }

  // Returns whether the cells of a row may be names of columns: at least two, without numbers.
  const mayBeNames = (texts) => texts.filter((text) => text).length > 1 && !texts.some((text) => NUMBER.test(text));

  // Returns the names of columns with the units in the row below them, or null if it is not a row of units.
  function joinUnits(names, texts) {
    const units = names.map((_, i) => UNIT.exec(texts[i] ?? ""));
    const fits = (text, i) => units[i] || !text || WITHOUT_UNIT.test(text);
    if (!units.some((unit) => unit) || !texts.every(fits)) return null;
    const hasUnit = (name, unit) => name.toLowerCase().replace(/[)\] ]+$/, "").endsWith(unit.toLowerCase());
    return names.map((name, i) => {
      const unit = units[i]?.[1];
      return unit && name && !hasUnit(name, unit) ? `${name} [${unit}]` : name;
    });
  }

  return { commentOf, commentsAbove, joinUnits, mayBeNames, rowsAbove, width };
})();
