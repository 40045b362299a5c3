// Reads a table from text, with any common encoding and separator, as simcore.grains.table_file does.
const Table = (() => {
  const { InputError } = Numbers;
  const DECLARED = /^"?sep=([!#-/:-@[-^\x60{-~\t]|\\t)"?[;,\t]*$/i;
  const SPACES = "spaces";
  const samples = DATA.reading.sample_names;
  const SAVE_AS = "save it as CSV (UTF-8)";

  // Returns {text, notices} of the bytes of a file.
  function decode(name, bytes) {
    const notices = [];
    const starts = (...mark) => mark.every((value, i) => bytes[i] === value);
    if (starts(0x50, 0x4b, 3, 4) || starts(0xd0, 0xcf, 0x11, 0xe0)) {
      throw new InputError(
        `${name}: the page reads no workbooks; copy the cells and paste them here, or ${SAVE_AS}`
      );
    }
    let encoding = starts(0xef, 0xbb, 0xbf) ? "utf-8" : starts(0xff, 0xfe) ? "utf-16le" : null;
    if (starts(0xfe, 0xff)) encoding = "utf-16be";
    if (encoding === null && bytes.includes(0)) {
      let [even, odd] = [0, 0];
      bytes.forEach((value, i) => {
        if (value === 0) i % 2 ? (odd += 1) : (even += 1);
      });
      encoding = even > odd ? "utf-16be" : "utf-16le";
    }
    let text;
    try {
      text = new TextDecoder(encoding ?? "utf-8", { fatal: true }).decode(bytes);
    } catch {
      if (encoding !== null) throw new InputError(`${name}: the file is not the text of a table; ${SAVE_AS}`);
      text = new TextDecoder("windows-1252").decode(bytes);
      notices.push("the text is not UTF-8; it is read as Windows-1252 (Latin-1)");
    }
    return { text, notices };
  }

  // Returns {header, rows, notices, separator}: rows are {row, cells, fields}, with the number of the row as a spreadsheet
  // counts it, and the number of columns for which the row has fields.
  function read(name, text, notices = []) {
    text = text.replace(/\r\n?|[\u2028\u2029\x0b\x0c\x85]/g, "\n").replaceAll("\ufeff", "").replace(/\x1a+$/, "");
    if (/[\x00-\x08\x0e-\x1f]/.test(text)) {
      throw new InputError(`${name}: the file is not the text of a table; ${SAVE_AS}`);
    }
    const lines = leaveOutSettings(text.split("\n"));
    const start = lines.findIndex((line) => line.trim());
    const declared = start >= 0 ? DECLARED.exec(lines[start].replace(/^ +| +$/g, "")) : null;
    let separator;
    if (declared) {
      separator = declared[1] === "\\t" ? "\t" : declared[1];
      lines.fill("", 0, start + 1);
    } else {
      separator = findSeparator(lines.slice(Math.max(start, 0)).join("\n"));
    }
    if (!lines.some((line) => line.trim())) return { header: [], rows: [], notices };
    return splitHeader(name, splitCells(name, lines.join("\n"), separator), notices, separator);
  }

  // Returns what to do about a row with another number of fields than the header.
  function adviceOnFields(separator) {
    if (separator === SPACES) return `add or remove fields; ${adviceOnNames(separator).join("")}`;
    const ofCommas = separator === "," ? ", and write decimals with a point, because commas separate the fields" : "";
    return `add or remove fields${ofCommas}`;
  }

  // Returns what to do about columns that were not recognised, if blanks separate them.
  function adviceOnNames(separator) {
    if (separator !== SPACES) return [];
    return ["blanks separate the columns, also inside their names: separate the columns with semicolons or tabs"];
  }

  function leaveOutSettings(lines) {
    const bare = (line) => line.replace(/^[ ,]+|[ ,]+$/g, "");
    const first = Math.max(lines.findIndex((line) => line.trim()), 0);
    const start = lines.findIndex((line) => bare(line) === "Pebble Details");
    if (bare(lines[first]) !== "PebbleCounts Parameters" || start < 0) return lines;
    return lines.map((line, i) => (i <= start ? "" : line));
  }

  // Returns the separator of the columns, outside quoted fields: that of the first row or, if it is a title, that of most
  // rows below it.
  function findSeparator(text) {
    let header = "";
    for (const line of text.split("\n")) {
      header += line + "\n";
      if ((header.split('"').length - 1) % 2 === 0) break;
    }
    const withoutQuoted = (part) => part.replace(/"[^"]*"/g, "");
    const words = (part) => part.trim().split(/\s+/).length;
    const bare = withoutQuoted(header);
    const marks = [";", "\t", "|", ","];
    const own = marks.find((mark) => bare.includes(mark)) ?? (words(bare) > 1 ? SPACES : ",");
    if (own !== "," && own !== SPACES) return own;
    const rows = withoutQuoted(text.slice(header.length)).split("\n").filter((line) => line.trim());
    // A row of names has no digits, unlike a row with a mark in a note. Beside spaces, the comma of a number is decimal.
    const isNames = (row) => !/\p{Nd}/u.test(row);
    const found = marks.filter((mark) => mark !== own).find((mark) => {
      const having = rows.filter((row) => row.includes(mark));
      const separated = having.filter((row) => isNames(row) || mark !== "," || words(row) === 1);
      return having.some(isNames) && separated.length > 0.5 * rows.length;
    });
    return found ?? own;
  }

  // Returns the rows of cells; a quotation mark counts at the beginning of a field only.
  function splitCells(name, text, separator) {
    const isMark = separator === SPACES ? (c) => c === " " || c === "\t" : (c) => c === separator;
    const rows = [];
    let [row, field, started, quoted] = [[], "", false, false];
    const endField = () => {
      row.push(field);
      [field, started] = ["", false];
    };
    for (let i = 0; i < text.length; i += 1) {
      const c = text[i];
      if (quoted) {
        if (c !== '"') field += c;
        else if (text[i + 1] === '"') {
          field += c;
          i += 1;
        } else quoted = false;
      } else if (c === "\n") {
        if (separator !== SPACES || started || !row.length) endField();
        rows.push(row);
        row = [];
      } else if (isMark(c)) {
        if (separator !== SPACES || started) endField();
      } else if (!started && c === '"') {
        [started, quoted] = [true, true];
      } else if (started || c !== " ") {
        field += c;
        started = true;
      }
    }
    if (quoted) {
      throw new InputError(`${name}: a quotation mark (") is not closed; close it or remove it`);
    }
    if (started || row.length) {
      if (separator !== SPACES || started) endField();
      rows.push(row);
    }
    return rows;
  }

  // The header is the first row that is not empty, or the row below a title; a row of units is joined with it. Rows and
  // columns without any text are left out.
  function splitHeader(name, cells, notices, separator) {
    const clean = cells.map((row, i) => ({
      row: i + 1,
      cells: row.map((text) => text.trim().split(/\s+/).join(" ")),
    }));
    const withText = clean.filter(({ cells: texts }) => texts.some((text) => text));
    if (!withText.length) return { header: [], rows: [], notices };
    const filled = withText.slice(TableHead.commentsAbove(withText.map(({ cells: texts }) => texts)));
    const { width } = TableHead;
    const above = TableHead.rowsAbove(filled.map(({ cells: texts }) => texts));
    if (above) {
      const listed = filled.slice(0, above).map(({ row }) => `row ${row}`).join(", ");
      const verb = above > 1 ? "are" : "is";
      notices = [...notices, `${listed} ${verb} above the names of the columns and ${verb} left out`];
    }
    let [{ cells: names }, ...rows] = filled.slice(above);
    const columns = width(names);
    names.slice(0, columns).forEach((own, i) => {
      const over = filled.slice(0, above).filter(({ cells: texts }) => texts[i]).at(-1);
      const values = rows.flatMap(({ cells: texts }) => texts[i] || []);
      const isName = new Set(values).size < values.length || samples.includes(over?.cells[i].toLowerCase());
      if (own || !over || !values.length || !isName) return;
      throw new InputError(
        `${name}: column ${i + 1} has values but no name in row ${filled[above].row}; write its name there (row ` +
          `${over.row} has ${over.cells[i]})`
      );
    });
    for (const { row, cells: texts } of rows) {
      const comment = TableHead.commentOf(texts);
      if (comment) throw new InputError(`${name}, row ${row}: the line is a comment, '${comment}'; remove it`);
      if (width(texts) > columns) {
        throw new InputError(
          `${name}, row ${row}: the row has ${width(texts)} fields, but the header has ${columns}; ` +
            `${adviceOnFields(separator)}; if there is a title above the names of the columns, remove it`
        );
      }
    }
    const joined = rows.length ? TableHead.joinUnits(names, rows[0].cells) : null;
    if (joined) {
      notices = [...notices, `row ${rows[0].row} has the units of the columns`];
      [names, rows] = [joined, rows.slice(1)];
    } else if (!above && rows.length && TableHead.mayBeNames(rows[0].cells)) {
      notices = [
        ...notices, `row ${rows[0].row} has no numbers; if row ${filled[0].row} is a title above the columns, remove it`,
      ];
    }
    const kept = [...Array(columns).keys()].filter((i) => names[i] || rows.some(({ cells: texts }) => texts[i]));
    const pick = (texts) => kept.map((i) => texts[i] ?? "");
    const fieldsOf = (texts) => kept.filter((i) => i < texts.length).length;
    const picked = rows.map(({ row, cells: t }) => ({ row, cells: pick(t), fields: fieldsOf(t) }));
    return { header: pick(names), rows: picked, notices, separator };
  }

  return { adviceOnFields, adviceOnNames, decode, read };
})();
