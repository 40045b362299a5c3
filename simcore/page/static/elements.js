// Elements of the page, and numbers with the decimal mark that is chosen.
const Elements = (() => {
  const byId = (id) => document.getElementById(id);
  const number = (value, digits = 3) => value.toFixed(digits).replace(".", byId("mark").value);
  const marked = (text) => text.replace(/(\d)\.(\d)/g, `$1${byId("mark").value}$2`); // numbers in a text

  function node(name, text, kind) {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (kind) made.className = kind;
    return made;
  }

  // Returns a row of a table: its heading, and its cells.
  function row(title, cells, kind) {
    const line = node("tr", undefined, kind);
    const heading = node("th", title);
    heading.scope = "row";
    line.append(heading, ...cells.map((text) => node("td", text)));
    return line;
  }

  function download(name, text, type) {
    const link = node("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  return { byId, number, marked, node, row, download };
})();
