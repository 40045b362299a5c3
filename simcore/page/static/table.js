// Reads a table from text, with any common encoding and separator, as simcore.grains.table_file does.
const Table = (() => {
  const { InputError } = Numbers;
  const DECLARED = /^"?sep=([!#-/:-@[-^`{-~\t]|\\t)"?[;,\t]*$/i;
  const SPACES = "spaces";
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
    const ofCommas = separator === "," ? ", and write decimals with a point, because commas separate the fields" : "";
    return `add or remove fields${ofCommas}`;
  }

  function leaveOutSettings(lines) {
    const bare = (line) => line.replace(/^[ ,]+|[ ,]+$/g, "");
    const first = Math.max(lines.findIndex((line) => line.trim()), 0);
    const start = lines.findIndex((line) => bare(line) === "Pebble Details");
    if (bare(lines[first]) !== "PebbleCounts Parameters" || start < 0) return lines;
    return lines.map((line, i) => (i <= start ? "" : line));
  }

  // Returns the separator of the columns, found in the header outside quoted fields.
  function findSeparator(text) {
    let header = "";
    for (const line of text.split("\n")) {
      header += line + "\n";
      if ((header.split('"').length - 1) % 2 === 0) break;
    }
    const bare = header.replace(/"[^"]*"/g, "");
    const found = [";", "\t", "|", ","].find((mark) => bare.includes(mark));
    return found ?? (bare.trim().split(/\s+/).length > 1 ? SPACES : ",");
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

  // The first row that is not empty is the header; rows and columns without any text are left out.
  function splitHeader(name, cells, notices, separator) {
    const clean = cells.map((row, i) => ({
      row: i + 1,
      cells: row.map((text) => text.trim().split(/\s+/).join(" ")),
    }));
    const filled = clean.filter(({ cells: texts }) => texts.some((text) => text));
    if (!filled.length) return { header: [], rows: [], notices };
    const width = (texts) => texts.reduce((most, text, i) => (text ? i + 1 : most), 0);
    const [{ cells: names }, ...rows] = filled;
    const columns = width(names);
    for (const { row, cells: texts } of rows) {
      if (width(texts) > columns) {
        const remedy =
          columns === 1 ? "remove the rows above the names of the columns" : adviceOnFields(separator);
        throw new InputError(
          `${name}, row ${row}: the row has ${width(texts)} fields, but the header has ${columns}; ${remedy}`
        );
      }
    }
    const kept = [...Array(columns).keys()].filter((i) => names[i] || rows.some(({ cells: texts }) => texts[i]));
    const pick = (texts) => kept.map((i) => texts[i] ?? "");
    const fieldsOf = (texts) => kept.filter((i) => i < texts.length).length;
    const picked = rows.map(({ row, cells: t }) => ({ row, cells: pick(t), fields: fieldsOf(t) }));
    return { header: pick(names), rows: picked, notices, separator };
  }

  return { adviceOnFields, decode, read };
})();
