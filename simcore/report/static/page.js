(() => {
  const contents = document.getElementById("contents");
  // Beside the text there is space for the contents; on a phone they would fill the screen.
  contents.open = window.matchMedia("(min-width: 72rem)").matches;
  contents.addEventListener("click", (event) => {
    if (event.target.closest("a") && !window.matchMedia("(min-width: 72rem)").matches) contents.open = false;
  });

  // The meaning of a column appears above its heading, for the mouse and for the keyboard.
  const tip = document.getElementById("tip");
  const meanings = new Map();
  const show = (heading) => {
    tip.textContent = meanings.get(heading);
    tip.hidden = false;
    const box = heading.getBoundingClientRect();
    const left = Math.min(box.left, window.innerWidth - tip.offsetWidth - 8);
    const above = box.top - tip.offsetHeight - 6;
    tip.style.left = `${Math.max(8, left)}px`;
    tip.style.top = `${above > 0 ? above : box.bottom + 6}px`;
  };
  const hide = () => {
    tip.hidden = true;
  };
  for (const heading of document.querySelectorAll("th[title]")) {
    meanings.set(heading, heading.title);
    heading.removeAttribute("title");
    heading.addEventListener("mouseenter", () => show(heading));
    heading.addEventListener("mouseleave", hide);
    heading.addEventListener("focus", () => show(heading));
    heading.addEventListener("blur", hide);
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") hide();
  });
  document.addEventListener("scroll", hide, { passive: true, capture: true });

  const large = document.getElementById("large");
  const image = large.querySelector("img");
  for (const button of document.querySelectorAll(".enlarge")) {
    button.addEventListener("click", () => {
      const small = button.querySelector("img");
      image.src = small.src;
      image.alt = small.alt;
      large.querySelector("p").textContent = button.closest("figure").querySelector("figcaption").textContent;
      large.showModal();
    });
  }
  image.addEventListener("click", () => large.close());
})();
