// Search of the manual: all sections lie in manual_sections as [place, title, text], so that nothing is fetched.
"use strict";
(function () {
  const most = 40;
  const query = document.getElementById("query");
  const results = document.getElementById("results");
  const chapters = document.getElementById("chapters");
  // title of the page of each section: that of the section without an anchor
  const pages = {};
  for (const [place, title] of manual_sections) if (!place.includes("#")) pages[place] = title.replace(/`/g, "");

  const escaped = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  const count = (text, word) => text.split(word).length - 1;

  // every word must be there, in the title or the text; titles and words that begin there weigh more
  function score(title, text, words) {
    let sum = 0;
    for (const word of words) {
      const inTitle = count(title, word), inText = count(text, word);
      if (!inTitle && !inText) return 0;
      sum += 20 * Math.min(inTitle, 2) + Math.min(inText, 5) + (new RegExp("(^|[^\\p{L}\\p{N}])" + word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"), "u").test(text) ? 3 : 0);
    }
    return sum;
  }

  function marked(text, words) {
    const pattern = words.map((w) => escaped(w).replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|");
    return escaped(text).replace(new RegExp(pattern, "gi"), "<mark>$&</mark>");
  }

  function around(text, words) {
    const at = Math.max(0, Math.min(...words.map((w) => text.toLowerCase().indexOf(w)).filter((k) => k >= 0).concat(text.length)) - 60);
    const start = at >= text.length - 60 || at === 0 ? 0 : text.indexOf(" ", at) + 1;
    return (start ? "... " : "") + text.substr(start, 180) + (start + 180 < text.length ? " ..." : "");
  }

  function search() {
    const words = query.value.toLowerCase().split(/\s+/).filter((w) => w.length > 1);
    results.hidden = !words.length;
    chapters.hidden = !!words.length;
    if (!words.length) return;
    const found = [];
    for (const [place, title, text] of manual_sections) {
      if (!place.includes("#")) {
        if (words.every((w) => title.toLowerCase().includes(w))) found.push([1000, place, title, text]);
        continue; // its text is that of its sections
      }
      const points = score(title.toLowerCase(), text.toLowerCase(), words);
      if (points) found.push([place.startsWith("CHANGELOG") ? points / 10 : points, place, title, text]);
    }
    found.sort((a, b) => b[0] - a[0]);
    results.innerHTML = found.length ? "" : "<p>No page has " + (words.length > 1 ? "all of these words" : "this word") + ".</p>";
    for (const [, place, title, text] of found.slice(0, most)) {
      const page = pages[place.split("#")[0]] || "";
      results.insertAdjacentHTML("beforeend", '<p><a href="' + base_url.replace(/\/$/, "") + "/" + place + '">' + marked(title.replace(/`/g, ""), words) + "</a>" +
        (page && page !== title.replace(/`/g, "") ? " <small>" + escaped(page) + "</small>" : "") + "<small>" + marked(around(text, words), words) + "</small></p>");
    }
    if (found.length > most) results.insertAdjacentHTML("beforeend", "<p><small>and " + (found.length - most) + " more; add a word</small></p>");
  }

  query.addEventListener("input", search);
  document.addEventListener("keydown", (event) => {
    if (event.key === "/" && document.activeElement !== query) { event.preventDefault(); query.focus(); }
    if (event.key === "Escape") { query.value = ""; search(); }
  });
  const asked = new URLSearchParams(location.search).get("q");
  if (asked) { query.value = asked; search(); }
  // wide tables scroll by themselves
  for (const table of document.querySelectorAll("main table")) {
    const box = document.createElement("div");
    box.className = "wide";
    table.replaceWith(box);
    box.append(table);
  }
  for (const code of document.querySelectorAll("main :not(pre) > code")) if (code.textContent.length < 26) code.className = "short";
  const here = document.querySelector("nav a.here");
  if (here) here.scrollIntoView({ block: "center" });
})();
