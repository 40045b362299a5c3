// Finds the rows of a table that summarise others, such as Mean or Total, as simcore.grains.summary_rows does.
const Summaries = (() => {
  const { labels } = DATA.reading;
  const STRONG = new RegExp(`^(?:${labels.strong})$`, "iu");
  const WEAK = new RegExp(`^(?:${labels.weak})$`, "iu");
  const TOTAL = new RegExp(`^(?:${labels.total})$`, "iu");

  // rows: of a table. positions: of the columns that may contain labels. Returns [index, label] pairs, in order.
  function find(rows, positions) {
    const found = new Map();
    for (const position of positions) {
      const words = rows.map(({ cells }) => cells[position].toLowerCase());
      const isStrong = (word, i) => STRONG.test(word) && word !== words[i - 1] && word !== words[i + 1];
      const places = new Set(words.flatMap((word, i) => (isStrong(word, i) ? [i] : [])));
      const weak = places.size ? words.flatMap((word, i) => (WEAK.test(word) ? [i] : [])) : [];
      for (let before = -1; before !== places.size; ) {
        before = places.size;
        const joined = weak.filter((i) => !places.has(i) && (places.has(i - 1) || places.has(i + 1)));
        joined.forEach((i) => places.add(i));
      }
      places.forEach((i) => found.has(i) || found.set(i, rows[i].cells[position]));
    }
    return [...found].sort(([a], [b]) => a - b);
  }

  return { find, isTotal: (label) => TOTAL.test(label) };
})();
