// Lists in messages, and errors in rows of a table, as simcore.grains.text_lists and simcore.grains.row_errors.
const Rows = (() => {
  const { InputError } = Numbers;
  const { shown } = DATA.reading;

  function joinFirst(texts) {
    const some = texts.slice(0, shown).join(", ");
    return texts.length <= shown ? some : `${some} and ${texts.length - shown} more`;
  }

  // Returns a map from the number of each row to read(row). An error is the first one, with the other rows that have one.
  function readEach(rows, read) {
    const [values, errors] = [new Map(), []];
    for (const row of rows) {
      try {
        values.set(row.row, read(row));
      } catch (error) {
        if (!(error instanceof InputError)) throw error;
        errors.push([`${row.row}`, error.message]);
      }
    }
    if (errors.length) throw new InputError(describe(errors));
    return values;
  }

  function describe([[, message], ...others]) {
    if (!others.length) return message;
    const [rows, verb] = others.length > 1 ? ["rows", "have errors"] : ["row", "has an error"];
    return `${message}; ${rows} ${joinFirst(others.map(([row]) => row))} ${verb} too`;
  }

  return { joinFirst, readEach };
})();
